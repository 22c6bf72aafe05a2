#include "export/raster_detail.h"

#include "export/cut_by_error.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

using storage::HierarchyReader;

/// The area that vertices take, seen from above.
struct Spread {
  double area = 0, vertices = 0;

  double spacing() const { return std::sqrt(area / std::max(vertices, 1.0)); }
};

Spread spread_of(const MapFrame& frame, const TileRecord& record) {
  const BoundsD box = frame.around({to_double(record.bounds.min), to_double(record.bounds.max)});
  return {(box.max.x - box.min.x) * (box.max.y - box.min.y), double(record.own_count)};
}

/// Returns the number 1, 2 or 5 times a power of 10 that is nearest to a length, as ratios go.
double round_length(double length) {
  constexpr double kLargest = 1e15;
  const auto ratio = [&](double round) { return std::max(round / length, length / round); };
  double best = 1;
  for (double power = 1; length > 0 && power <= kLargest; power *= 10) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      for (const double round : {digit * power, digit / power}) {
        if (ratio(round) < ratio(best))
          best = round;
      }
    }
  }
  return best;
}

}  // namespace

bool is_of_input(const HierarchyReader& reader, const TileRecord& record) {
  return reader.tree().is_partition(record.node) || reader.tree().is_early(record.node);
}

double finest_detail(const HierarchyReader& reader, const MapFrame& frame) {
  double texels = 0, textured = 0;
  Spread all;
  for (const TileRecord& record : reader.records()) {
    if (!is_of_input(reader, record) || record.bounds.empty())
      continue;
    const Spread one = spread_of(frame, record);
    all = {all.area + one.area, all.vertices + one.vertices};
    if (record.texel > 0 && record.image_width > 0) {
      texels += double{record.texel} * record.own_count;
      textured += record.own_count;
    }
  }
  return round_length(textured > 0 ? texels / textured * frame.scale() : all.spacing());
}

NamedCut cut_for_pixels(const HierarchyReader& reader, const MapFrame& frame, double pixel,
                        VertexUse use) {
  constexpr double kErrorPart = 0.5;
  const double error = kErrorPart * pixel / frame.scale();
  const bool needs_vertices = use == VertexUse::picture_and_heights || !reader.manifest().textures;
  const auto is_fine_enough = [&](const TileRecord& record) {
    return record.error <= error &&
           (!needs_vertices || spread_of(frame, record).spacing() <= pixel);
  };
  return {coarsest_cut(reader, is_fine_enough), fmt::format("error {:.3g}", error)};
}

}  // namespace meshhier::exporting
