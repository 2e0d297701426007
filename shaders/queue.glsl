// Which samples have a ray for the next round.

// For a sample whose first ray has met something; all such call this together. The others need none, so slots in use are close together.
uint takeSlot() {
    uint asking = lanesWhere(true), rank = rankWhere(true), first = 0u;
    if (isFirstLane()) first = atomicAdd(rounds[0].counts.x, asking);
    return fromFirstLane(first) + rank;
}

// Work groups whose first place is among `count` from `first` on.
uint groupsBegun(uint first, uint count) {
    const uint kSize = uint(RT_GROUP_X);
    return (first + count + kSize - 1u) / kSize - (first + kSize - 1u) / kSize;
}

// The queue of the next round takes this slot: paths from its front, shadow rays from its end. All that go on call this together.
void enqueue() {
    uint next = roundInGroup + 1u, queueStart = (next & 1u) * picture.slots.x;
    uint paths = lanesWhere(!flight.shadow), shadows = lanesWhere(flight.shadow);
    uvec2 rank = uvec2(rankWhere(!flight.shadow), rankWhere(flight.shadow));
    uvec2 first = uvec2(0u);
    if (isFirstLane()) {
        first.x = paths > 0u ? atomicAdd(rounds[next].counts.x, paths) : 0u;
        first.y = shadows > 0u ? atomicAdd(rounds[next].counts.y, shadows) : 0u;
        uint groups = groupsBegun(first.x, paths) + groupsBegun(first.y, shadows);
        if (groups > 0u) atomicAdd(rounds[next].groups.x, groups);
    }
    first = uvec2(fromFirstLane(first.x), fromFirstLane(first.y));
    uint place = flight.shadow ? picture.slots.x - 1u - (first.y + rank.y) : first.x + rank.x;
    queue[queueStart + place] = slot;
}

// False where the round has no sample for this invocation.
bool takeFromQueue() {
    uvec4 counts = rounds[roundInGroup].counts;
    uint pathGroups = (counts.x + RT_GROUP_X - 1u) / RT_GROUP_X;
    bool ofPath = gl_WorkGroupID.x < pathGroups;
    uint i = (gl_WorkGroupID.x - (ofPath ? 0u : pathGroups)) * RT_GROUP_X + gl_LocalInvocationID.x;
    if (i >= (ofPath ? counts.x : counts.y)) return false;
    slot = queue[(roundInGroup & 1u) * picture.slots.x + (ofPath ? i : picture.slots.x - 1u - i)];
    return true;
}
