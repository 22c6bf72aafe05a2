#include "export/named_cut.h"

#include "export/cut_by_error.h"
#include "export/cut_file.h"

#include <variant>

#include <fmt/format.h>

namespace meshhier::exporting {

std::optional<NamedCut> cut_of(storage::FileSystem& files, const storage::HierarchyReader& reader,
                               const ExportSelection& selection) {
  const Tree& tree = reader.tree();
  if (const auto* level = std::get_if<Level>(&selection)) {
    require_level(tree, *level);
    return NamedCut{Cut::of_level(tree, *level), fmt::format("level {}", raw(*level))};
  }
  if (const auto* path = std::get_if<std::filesystem::path>(&selection))
    return NamedCut{read_cut(files, tree, *path), "cut"};
  if (const auto* largest = std::get_if<LargestError>(&selection))
    return NamedCut{cut_by_error(reader, *largest), fmt::format("error {}", largest->error)};
  return std::nullopt;
}

}  // namespace meshhier::exporting
