// Whether a server can do now what it is for: show a folder, take meshes, build.
#pragma once

#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::server {

struct ReadinessOptions {
  std::shared_ptr<const storage::Folder> folder{};  ///< the hierarchies', as they are shown
  std::filesystem::path inbox{};  ///< watched; empty: none is, and nothing is written
  bool takes_uploads = false;     ///< into the inbox
  std::uint64_t disk_floor = std::uint64_t{1} << 30;  ///< bytes that stay free where it is written
};

/// Returns why less than `floor` bytes would be free in `folder` when `more` are written there, in
/// words for clients; empty if that is not so. Throws Error(io).
std::string why_below_floor(const std::filesystem::path& folder, std::uint64_t floor,
                            std::uint64_t more, storage::FileSystem& files);

/// One thing that must be so.
struct Check {
  std::string name;      ///< "folder", "inbox", "disk"
  std::string reason{};  ///< why it is not, without paths of this machine; empty: it is so
};

/// Returns all checks; takes some system calls. Thread-safe if `files` is. Never throws for what is
/// wrong.
std::vector<Check> check_readiness(const ReadinessOptions& options, storage::FileSystem& files);

}  // namespace meshhier::server
