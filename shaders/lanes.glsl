// Invocations that run side by side: a subgroup, where the device has them; else each counts as alone. Only those that are
// active where a function is called take part.

uint lanesWhere(bool condition) {
#if RT_SUBGROUPS
    return subgroupBallotBitCount(subgroupBallot(condition));
#else
    return condition ? 1u : 0u;
#endif
}
