#include "compare/selected_surface.h"

#include <algorithm>
#include <utility>

namespace meshhier::comparing {

Cut selected_cut(const storage::HierarchyReader& reader, const SurfaceSelection& selection) {
  const Tree& tree = reader.tree();
  if (const auto* error = std::get_if<exporting::LargestError>(&selection))
    return cut_by_error(reader, *error);
  const auto* level = std::get_if<Level>(&selection);
  return Cut::of_level(tree, level != nullptr ? std::min(*level, tree.depth()) : tree.depth());
}

double error_bound(const storage::HierarchyReader& reader, const Cut& cut) {
  double bound = 0;
  for (const NodeId node : cut.nodes())
    bound = std::max(bound, double{reader.record(node).bound});
  const auto& quantization = reader.manifest().quantization;
  return bound + (quantization ? quantization->worst_rounding : 0);
}

CutSurface selected_surface(const storage::HierarchyReader& reader,
                            const SurfaceSelection& selection, std::uint64_t cache_bytes,
                            execution::Progress& progress, const execution::CancelToken& cancel,
                            exporting::Region piece) {
  Cut cut = selected_cut(reader, selection);
  if (piece.is_all() && !std::holds_alternative<exporting::LargestError>(selection))
    return {reader, std::move(cut), cache_bytes};
  progress.stage("read", cut.size(), "tiles");
  return {reader, std::move(cut), cache_bytes, progress, cancel, std::move(piece)};
}

}  // namespace meshhier::comparing
