// The view that a picture shows: the hierarchy's own or a link's, and what options say instead.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/model_view.h"
#include "inspection/preview.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::inspection {

struct DrawnView {
  ModelView view{};
  bool has_pose = false;  ///< it is seen from where the page sees it, else from a side, by options
  bool is_plain = true;   ///< nobody said how it is shown: as the file stands, its colours
};

/// Warns of what the picture does not show of the view. Throws Error(usage) if the link is none.
DrawnView drawn_view(const storage::HierarchyReader& reader, const PreviewOptions& options,
                     execution::Progress& progress);

/// Returns the objects that a view shows, ascending; nothing if it shows all. Of two texts that fit
/// a name the longer one holds, as the page has it (viewer/src/tools/object_choice.ts). Reads the
/// table once. Throws Error(usage) if it shows none, or there are no objects.
std::optional<std::vector<std::uint32_t>> shown_objects(const storage::HierarchyReader& reader,
                                                        const ModelView& view,
                                                        const execution::CancelToken& cancel);

}  // namespace meshhier::inspection
