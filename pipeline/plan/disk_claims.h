// The disk that builds at work in one folder will take together: each notes its own need where the
// others find it, in the file of its lock, which goes with the build.
#pragma once

#include "storage/io/file.h"
#include "storage/io/scratch_use.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::pipeline {

/// Notes that the build in the work directory `work`, which it has locked, will take so many bytes
/// of disk at most. The note itself counts in `use`. Throws Error(io).
void claim_disk(const std::filesystem::path& work, std::uint64_t bytes, storage::FileSystem& files,
                storage::ScratchUse& use);

/// Returns how many bytes other builds will yet take that are at work beside `output`: what they
/// claimed without what they have written. 0 for those that have not claimed, or have just ended.
/// Throws Error(io) if the folder cannot be listed.
std::uint64_t claimed_beside(const std::filesystem::path& output, storage::FileSystem& files);

}  // namespace meshhier::pipeline
