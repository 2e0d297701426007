// Which sample of which pixel is the n-th of a batch, and its first ray.

// The pixels of a batch in blocks of 8x4, so that lanes see the same things; one sample of all of them after the other.
struct Place {
    uvec2 pixel;
    uint index; // of the sample
};

uint blocksAcross() {
    return (picture.region.z - picture.region.x + 7u) / 8u;
}
uint pixelSlots() { // with those of blocks that are not full
    return blocksAcross() * ((picture.region.w - picture.region.y + 3u) / 4u) * 32u;
}
Place placeOf(uint s) {
    uint inPicture = s % pixelSlots(), inBlock = inPicture % 32u, block = inPicture / 32u;
    uvec2 at = uvec2(block % blocksAcross(), block / blocksAcross()) * uvec2(8u, 4u) + uvec2(inBlock % 8u, inBlock / 8u);
    return Place(picture.region.xy + at, picture.samples.x + s / pixelSlots());
}
bool isBegun(uint s, uint samples) { // blocks at the border are not full
    return s < pixelSlots() * samples && all(lessThan(placeOf(s).pixel, picture.region.zw));
}

Flight primaryFlight(Place place) {
    return Flight(pixelRay(place.pixel, samplerOf(place.pixel, place.index)), false, false, kNoTriangle);
}
