// Invocations that run side by side: a subgroup, where the device has them; else each counts as alone. Only those that are
// active where a function is called take part. Included after the work group's size, which some compilers want to know first.
// The functions of a group belong together: they expect the lanes that called one to be the lanes that call the next, as
// they are in straight-line code on every device tried.

#if RT_SUBGROUPS
uint lanesWhere(bool condition) {
    return subgroupBallotBitCount(subgroupBallot(condition));
}
uint rankWhere(bool condition) { // among the active ones where it holds
    return subgroupBallotExclusiveBitCount(subgroupBallot(condition));
}
bool isFirstLane() {
    return subgroupElect();
}
uint fromFirstLane(uint value) {
    return subgroupBroadcastFirst(value);
}
#else
uint lanesWhere(bool condition) {
    return condition ? 1u : 0u;
}
uint rankWhere(bool condition) {
    return 0u;
}
bool isFirstLane() {
    return true;
}
uint fromFirstLane(uint value) {
    return value;
}
#endif
