// Cuts that people write down.
#pragma once

#include "hierarchy/cut.h"
#include "hierarchy/tree.h"
#include "storage/io/file.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::exporting {

/// Reads a list of nodes: either lines "L/I" (blank lines, and the rest of a line behind a #, are
/// skipped), or a JSON array of such strings. `name` starts the messages. Throws Error(usage)
/// naming the line or entry.
std::vector<NodeId> parse_nodes(std::string_view text, const std::string& name);

/// Reads the cut that a text file lists (parse_nodes()). Throws Error(io), and Error(usage) naming
/// the file for text that is no list or nodes that are no cut.
Cut read_cut(storage::FileSystem& files, const Tree& tree, const std::filesystem::path& path);

}  // namespace meshhier::exporting
