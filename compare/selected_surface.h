// The surface of a hierarchy that is measured: the original, a level, or tiles by their error.
#pragma once

#include "compare/cut_surface.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/cut_by_error.h"
#include "export/region.h"
#include "hierarchy/cut.h"
#include "hierarchy/ids.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <variant>

namespace meshhier::comparing {

/// Selects the original surface.
struct Originals {};

using SurfaceSelection = std::variant<Originals, Level, exporting::LargestError>;

/// Returns the cut that shows it; of a tree that is less deep than a level, the finest one.
Cut selected_cut(const storage::HierarchyReader& reader, const SurfaceSelection& selection);

/// Returns a distance: the original surface is nowhere farther from that of the cut, nor this one
/// from that. What positions are rounded to is among it.
double error_bound(const storage::HierarchyReader& reader, const Cut& cut);

/// Opens the surface of the selected cut, or a piece of it. Tiles that are chosen by their error
/// are of several levels, so that only they tell their boxes: they are read, and so are those of a
/// piece, in the stage "read" of `progress`. Throws as CutSurface.
CutSurface selected_surface(const storage::HierarchyReader& reader,
                            const SurfaceSelection& selection, std::uint64_t cache_bytes,
                            execution::Progress& progress, const execution::CancelToken& cancel,
                            exporting::Region piece = {});

}  // namespace meshhier::comparing
