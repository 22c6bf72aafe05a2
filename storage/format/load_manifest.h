// The manifest of a hierarchy that lies somewhere.
#pragma once

#include "storage/format/manifest.h"

#include <filesystem>

namespace meshhier::storage {

class FileSystem;

/// Throws Error(io) if there is no manifest in `hierarchy`, a directory or, in ArchiveFiles, an
/// archive: so all say it in the same words.
void require_manifest(FileSystem& files, const std::filesystem::path& hierarchy);

/// Returns the manifest of a hierarchy. Throws as require_manifest() and parse_manifest(), and
/// Error(io).
Manifest load_manifest(FileSystem& files, const std::filesystem::path& hierarchy);

}  // namespace meshhier::storage
