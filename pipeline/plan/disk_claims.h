// The disk that builds at work on one file system will take together: each notes its own need where
// the others find it, in the file of its lock, which goes with the build.
//
// Builds of one machine note theirs one after the other, and look at those that were there before:
// of two that do not fit together, one goes on. Of other users, containers and machines those in
// the same folder are seen if their files may be read, but perhaps at the same moment: then both
// may be refused, never both go on.
#pragma once

#include "storage/io/file.h"
#include "storage/io/scratch_use.h"

#include <cstdint>
#include <filesystem>
#include <functional>

namespace meshhier::pipeline {

/// Notes that the build in the work directory `work`, which it has locked, will take so many bytes
/// of disk at most, and calls `check`; takes that back if it throws. The note itself counts in
/// `use`. Throws Error(io), and what `check` throws.
void claim_disk(const std::filesystem::path& work, std::uint64_t bytes, storage::FileSystem& files,
                storage::ScratchUse& use, const std::function<void()>& check);

/// Returns how many bytes other builds will yet take on the file system of `output`: what they
/// claimed without what they have written. 0 for those that have not claimed, or have just ended.
/// Those in other folders are seen if `files` is a storage::SharedFileSystem.
/// Throws Error(io) if the folder cannot be listed.
std::uint64_t claimed_beside(const std::filesystem::path& output, storage::FileSystem& files);

}  // namespace meshhier::pipeline
