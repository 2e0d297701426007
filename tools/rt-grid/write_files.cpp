#include "tools/rt-grid/write_files.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/stop_request.h"

#include <fmt/format.h>

#include <filesystem>

namespace rt {
namespace {

namespace fs = std::filesystem;

// Removes what was made, unless it is kept.
class NewFiles {
public:
    ~NewFiles() {
        std::error_code ignored;
        for (auto path = made_.rbegin(); path != made_.rend(); ++path) fs::remove(*path, ignored);
    }
    void add(const fs::path& path) { made_.push_back(path); }
    void keep() { made_.clear(); }

private:
    std::vector<fs::path> made_;
};

void makeFolder(const fs::path& folder, NewFiles& made) {
    std::error_code failed;
    if (fs::create_directory(folder, failed)) made.add(folder);
    if (failed)
        throw Error(ErrorKind::FileAccess,
                    fmt::format("{}: cannot make this folder: {}", folder.string(), failed.message()));
}

} // namespace

void requireFolderWritable(const std::string& folder) {
    std::error_code failed;
    if (fs::exists(folder, failed) && !fs::is_directory(folder, failed))
        throw Error(ErrorKind::FileAccess, fmt::format("{}: is a file; name a folder", folder));
    requireWritable(fs::is_directory(folder, failed) ? (fs::path(folder) / "picture.png").string() : folder);
}

void writeFolder(const std::string& folder, const std::vector<NamedBytes>& files) {
    const StopRequest stop;
    {
        NewFiles made;
        makeFolder(folder, made);
        for (const NamedBytes& file : files) {
            if (stop.made()) break;
            const fs::path path = fs::path(folder) / file.name;
            const bool isNew = !fs::exists(path);
            writeFile(path.string(), file.bytes);
            if (isNew) made.add(path);
        }
        if (!stop.made()) made.keep();
    }
    if (stop.made()) stop.obey();
}

} // namespace rt
