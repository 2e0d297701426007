#pragma once
#include "common/memory_limit.h"
#include "formats/mesh.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rt {

/// How much reading files of that many bytes in all may take: 2 GiB or kMemoryPerByte times as much,
/// whichever is more, but not over what is left to any program here.
MemoryLimit readingMemoryLimit(std::uint64_t fileBytes);
inline constexpr std::uint64_t kLeastMemory = std::uint64_t(2) << 30;
inline constexpr std::uint64_t kMemoryPerByte = 100;

struct GuardLimits {
    MemoryLimit memory = readingMemoryLimit(0); ///< of the address space, and of what is handed over
    double seconds = 300.0;
    std::vector<std::string> readable = {}; ///< files and folders that may be read, and what is below them
};

/// What a child handed over, checked.
struct ReceivedMesh {
    Mesh mesh;
    std::string message; ///< not checked
};

/// Damaged models crash Assimp's loaders, send them round for ever, or worse. So the work is done in a child
/// process with limits on time and memory, which can read files and hand over a mesh and a message, and
/// nothing else (sandbox.h). The constructor forks; isChild() tells the two apart, and each goes on with its
/// own half of the calls below. To be made before any thread is started. Under sanitizers the child has
/// neither sandbox nor memory limit, for they take more than those allow.
class GuardProcess {
public:
    /// `name` stands at the start of messages. Throws Error{LimitExceeded} if there can be no more processes.
    GuardProcess(const std::string& name, const GuardLimits& limits);
    ~GuardProcess(); ///< the parent's kills the child if it still runs
    GuardProcess(const GuardProcess&) = delete;
    GuardProcess& operator=(const GuardProcess&) = delete;

    bool isChild() const;

    /// Child: which part of the work is done, 0 to 1, for the parent to show.
    void setProgress(double part);
    /// Child: hands over its results, last of all.
    void send(const Mesh& mesh, const std::string& message);

    /// Parent: waits for the child's end, passes on what it wrote to standard error, and returns its exit
    /// code. Throws Error{InvalidContent} if the child crashed, and Error{LimitExceeded} if it used up its
    /// time or memory or was killed from outside; nothing that it printed is shown then. No more than 1 MiB
    /// is, in any case.
    int wait();
    /// Parent, after wait() returned 0. Throws Error{InvalidContent} if that is no valid mesh, or the message
    /// longer than 64 MiB.
    ReceivedMesh receive() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace rt
