#pragma once

namespace rt {

/// rt-trace merge: shards of a picture to the picture. Needs no GPU. argv[0] is "merge". Returns the exit
/// code; throws Error.
int mergeCommand(int argc, const char* const* argv);

} // namespace rt
