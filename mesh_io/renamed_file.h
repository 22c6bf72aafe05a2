// A file under another name: messages name a temporary file by the file that it was made of.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <memory>

namespace meshhier::mesh_io {

/// Returns `file` with `name` for its path(). It can only be read.
std::unique_ptr<storage::File> renamed(std::unique_ptr<storage::File> file,
                                       std::filesystem::path name);

}  // namespace meshhier::mesh_io
