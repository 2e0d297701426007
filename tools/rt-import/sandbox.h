#pragma once

namespace rt {

/// From here on, the process may read files, use memory, start threads, and write to what it has open
/// already. Opening a file for writing fails; any other call, for a network, another program, a process or a
/// change of the file system, kills it by SIGSYS (seccomp). Throws Error{Internal} if the kernel refuses the
/// filter.
void enterSandbox();

} // namespace rt
