// The files that `meshhier build` is given: one config, or meshes.
#pragma once

#include "config/config.h"
#include "storage/io/file.h"

#include <filesystem>
#include <vector>

namespace meshhier::config {

/// Whether there is a hierarchy: a directory, or the archive of one.
bool is_hierarchy(storage::FileSystem& files, const std::filesystem::path& path);

/// Returns the config of a build that is given these files; without any, `words` must say all.
/// Requires words.meshes to be empty.
///
/// A mesh is known by its content, a config by its content or the ending ".json". Throws
/// Error(usage) for a config beside other files and for a file that is neither, and as
/// load_config().
Config load_named(storage::FileSystem& files, const std::vector<std::filesystem::path>& named,
                  CommandLine words);

/// Does the same, but for what only the meshes tell, of which no more is read than shows what they
/// are.
Config read_named(storage::FileSystem& files, const std::vector<std::filesystem::path>& named,
                  CommandLine words);

}  // namespace meshhier::config
