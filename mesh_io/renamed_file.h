// A file under another name: a temporary one that messages are to tell by what it was made of.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <memory>

namespace meshhier::mesh_io {

/// `file` with `name` for its path(). To be read only.
std::unique_ptr<storage::File> renamed(std::unique_ptr<storage::File> file,
                                       std::filesystem::path name);

}  // namespace meshhier::mesh_io
