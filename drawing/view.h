// How a drawing looks at a model: from above, from a side, or at the plane that cuts it.
//
// Idea. A view is a turned map frame: u to the right, v up, w towards who looks. So whatever draws
// maps from above (windows, light, heights that hide) draws elevations and sections as well, and a
// plane that cuts is a height, w.
//
//          v                     plan: u east,  v north, w up
//          |                    front: u east,  v up,    w south
//          |                  section: u along the line from its first point, v up
//          +------ u
//         /
//        w
#pragma once

#include "export/map_frame.h"
#include "export/plan_region.h"
#include "storage/format/manifest.h"

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

namespace meshhier::drawing {

struct PlanFromAbove {};

enum class Side { front, right, back, left };
inline constexpr std::array<std::pair<std::string_view, Side>, 4> kSides{
    {{"front", Side::front}, {"right", Side::right}, {"back", Side::back}, {"left", Side::left}}};

/// An upright plane through two places of the map, looked at with the first one on the left.
struct SectionLine {
  exporting::PlanPoint from{}, to{};
};

/// The plane where dot(normal, p) + offset is 0, in the input's coordinates; what is kept lies
/// where it is more, and is looked at from the other side.
struct SectionPlane {
  Vec3d normal{};
  double offset = 0;
};

using View = std::variant<PlanFromAbove, Side, SectionLine, SectionPlane>;

/// A view of a hierarchy.
struct Sheet {
  exporting::MapFrame map;   ///< east, north, height
  exporting::MapFrame view;  ///< u, v, w, as long as those of the map
  /// w of the plane that the view cuts at; none: it cuts nothing by itself.
  std::optional<double> plane{};
  bool is_plan = false;  ///< u and v are east and north
};

/// Throws Error(usage) if a plane has no direction, or the line of a section no length; and as
/// map_frame().
Sheet sheet_of(const storage::Manifest& manifest, const View& view);

}  // namespace meshhier::drawing
