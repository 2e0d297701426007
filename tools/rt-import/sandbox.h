#pragma once

#include <string>
#include <vector>

namespace rt {

/// From here on, the process may read what lies in or below the `readable` files and folders (Landlock; any
/// file where the kernel has none, which a line for -v says), use memory, start threads, and write to what it
/// has open already. Opening a file for writing fails; any other call, for a network, another program, a
/// process or a change of the file system, kills it by SIGSYS (seccomp). Throws Error{Internal} if the kernel
/// refuses the filter.
void enterSandbox(const std::vector<std::string>& readable);

} // namespace rt
