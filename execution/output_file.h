// Where a command may write its one file.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <string>

namespace meshhier::execution {

/// Throws Error(usage) if the path has no name, Error(io) if there is no such directory: unlike a
/// work directory, it is not made, as a mistyped path should be told.
void require_place(storage::FileSystem& files, const std::filesystem::path& output);

/// Throws Error(usage) if the output lies in the directory that is read, `what` it is: "the
/// hierarchy". It would overwrite or litter it.
void require_apart(storage::FileSystem& files, const std::filesystem::path& output,
                   const std::filesystem::path& directory, const std::string& what);

}  // namespace meshhier::execution
