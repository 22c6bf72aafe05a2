// Who else may read a file.
#pragma once

#include <filesystem>

namespace meshhier::storage {

/// Whether a file's mode lets other users than its owner read or change it. What its group may
/// counts only if this user owns it: of another's file, that is how this user was let in. False if
/// it cannot be looked at.
bool is_open_to_others(const std::filesystem::path& file);

}  // namespace meshhier::storage
