// Who else may read a file.
#pragma once

#include <filesystem>

namespace meshhier::storage {

/// Returns whether a file's mode lets other users than its owner read or change it. The rights of
/// its group count only if this user owns it: another's file is open to this user by them. False if
/// the file cannot be looked at.
bool is_open_to_others(const std::filesystem::path& file);

}  // namespace meshhier::storage
