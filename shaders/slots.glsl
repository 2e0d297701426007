// The words of samples on their way, all of them in one buffer.
void storeWords(uint plane, uvec4 words) {
    slots[placeIn(plane)] = words;
}
uvec4 loadWords(uint plane) {
    return slots[placeIn(plane)];
}
