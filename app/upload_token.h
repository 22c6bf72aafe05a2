// The secret that who sends meshes from another machine must know.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <string>

namespace meshhier::app {

/// The one word in that file. Throws Error(usage) if it is none, or so short that it can be
/// guessed.
std::string read_upload_token(storage::FileSystem& files, const std::filesystem::path& path);

}  // namespace meshhier::app
