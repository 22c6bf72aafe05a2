// Cuts that people write down.
#pragma once

#include "hierarchy/tree.h"
#include "pipeline/cut.h"
#include "storage/file.h"

#include <filesystem>

namespace meshhier::pipeline {

/// The cut that a text file lists (parse_nodes()). Throws Error(io), and Error(usage) naming the
/// file for text that is no list or nodes that are no cut.
Cut read_cut(storage::FileSystem& files, const Tree& tree, const std::filesystem::path& path);

}  // namespace meshhier::pipeline
