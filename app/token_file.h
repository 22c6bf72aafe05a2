// The secret that those must know who ask a server for more than to look.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace meshhier::app {

/// Returns the one word in a file, `path`, that `option` names. Throws Error(usage) if there is not
/// one word, or if it is so short that it can be guessed.
std::string read_token(storage::FileSystem& files, std::string_view option,
                       const std::filesystem::path& path);

}  // namespace meshhier::app
