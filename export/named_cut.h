// The cut that a selection stands for.
#pragma once

#include "export/export.h"
#include "hierarchy/cut.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/file.h"

#include <optional>
#include <string>

namespace meshhier::exporting {

struct NamedCut {
  Cut cut;
  std::string name;  ///< for people: "level 3"
};

/// Returns nothing for a node and the outline, which are no cuts. `files` has the cut's file.
/// Throws as require_level(), read_cut().
std::optional<NamedCut> cut_of(storage::FileSystem& files, const storage::HierarchyReader& reader,
                               const ExportSelection& selection);

}  // namespace meshhier::exporting
