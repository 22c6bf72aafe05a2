// The secret that those must know who send meshes from another machine.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <string>

namespace meshhier::app {

/// Returns the one word in that file. Throws Error(usage) if there is not one word, or if it is so
/// short that it can be guessed.
std::string read_upload_token(storage::FileSystem& files, const std::filesystem::path& path);

}  // namespace meshhier::app
