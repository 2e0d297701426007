#pragma once
#include <optional>
#include <string>

namespace rt {

/// Damaged models crash Assimp's loaders, or send them round for ever. So the work is done in a child process
/// with limits on processor time and memory: forks, and returns nothing in the child, which goes on. In the
/// parent waits for the child, passes on what it wrote to standard error, and returns its exit code. Throws
/// Error{InvalidContent}, message prefixed by `name`, if the child was killed by a signal, and
/// Error{LimitExceeded} if it used up its time; nothing that the child printed is shown then.
/// To be called before any thread is started.
std::optional<int> forkGuarded(const std::string& name);

} // namespace rt
