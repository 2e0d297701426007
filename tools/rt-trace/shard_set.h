#pragma once
#include "common/binary_io.h"
#include "formats/shard_record.h"

#include <string>
#include <vector>

namespace rt {

/// The file of a shard. Its pixels have not been looked at.
struct ShardFile {
    std::string path;
    SharedSpan<std::byte> bytes;
    Image header; ///< without values, and without the attributes of the record
    ShardRecord record;
};

/// Opens all shards of one picture; they come back in their order. Throws Error{FileAccess}, or
/// Error{InvalidContent} naming what is no shard, damaged, named twice, of another picture than most are (and
/// in what they differ), or missing.
std::vector<ShardFile> openShards(const std::vector<std::string>& paths);

} // namespace rt
