// Where a hierarchy lies that a command reads: on the disk, or on the web.
#pragma once

#include "app/command.h"
#include "storage/io/remote_files.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace meshhier::app {

struct WebOptions {
  std::vector<std::string> headers;  ///< "NAME: VALUE", or "@FILE" with a line each
  std::uint64_t bytes_per_second = 0;
};

/// Of a temporary file or folder, in TMPDIR, else /tmp. Nothing but names depends on chance.
std::filesystem::path temporary_path(std::string_view prefix);

/// --header and --limit-rate
void add_web_options(CLI::App& command, WebOptions& web);
/// HIERARCHY, and these
void add_hierarchy_options(
    CLI::App& command, std::string& hierarchy, WebOptions& web,
    const char* help = "A directory, a 3tz archive, or the address of one of them");

/// Throws Error(usage) for a header that is none, Error(io) for a file of some that cannot be read.
class HierarchyPlace {
 public:
  /// All must outlive it.
  HierarchyPlace(Environment& environment, const std::string& hierarchy, const WebOptions& web);

  storage::FileSystem& files() const { return remote_ ? *remote_ : files_; }
  bool is_remote() const { return remote_ != nullptr; }
  /// Of the hierarchy, without secrets.
  const std::filesystem::path& path() const { return path_; }
  /// What was fetched: a line, "fetched 1.2 MiB in 14 requests"; nothing of a disk.
  std::string account() const;

 private:
  storage::FileSystem& files_;
  std::filesystem::path path_;
  std::unique_ptr<storage::RemoteFiles> remote_;
};

}  // namespace meshhier::app
