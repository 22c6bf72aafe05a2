// The place of a hierarchy that a command reads: on the disk, or on the web.
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
  /// "NAME: VALUE", "HOST NAME: VALUE", or "@FILE" with such a line each. NAME is a token of RFC
  /// 9110; HOST is a word with a scheme, a dot or a port ("localhost:80"). Each line goes to one
  /// host: the one that it names, else that of the first address.
  std::vector<std::string> headers;
  std::uint64_t bytes_per_second = 0;
  std::vector<std::string> addresses{};  ///< all that a command reads; empty: only the hierarchy
};

/// Returns a path for a temporary file or folder, in TMPDIR, else /tmp. Only names depend on
/// chance.
std::filesystem::path temporary_path(std::string_view prefix);

/// Adds --header and --limit-rate.
void add_web_options(CLI::App& command, WebOptions& web);
/// Adds HIERARCHY, and these.
void add_hierarchy_options(
    CLI::App& command, std::string& hierarchy, WebOptions& web,
    const char* help = "A directory, a 3tz archive, or the address of one of them");

/// A hierarchy's path and the file system to read it with.
class HierarchyPlace {
 public:
  /// All must outlive it. Throws Error(usage) for a header that is none, or is for no host that is
  /// asked, Error(io) for a file of headers that cannot be read.
  HierarchyPlace(Environment& environment, const std::string& hierarchy, const WebOptions& web);

  storage::FileSystem& files() const { return remote_ ? *remote_ : files_; }
  bool is_remote() const { return remote_ != nullptr; }
  /// The hierarchy's path, without secrets.
  const std::filesystem::path& path() const { return path_; }
  /// Returns a line, "fetched 1.2 MiB in 14 requests"; empty for a disk.
  std::string account() const;

 private:
  storage::FileSystem& files_;
  std::filesystem::path path_;
  std::unique_ptr<storage::RemoteFiles> remote_;
};

}  // namespace meshhier::app
