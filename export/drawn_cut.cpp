#include "export/drawn_cut.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "export/clip_part.h"
#include "export/common_box.h"
#include "export/raster_detail.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

using storage::HierarchyReader;

bool mixes_levels(const HierarchyReader& reader, const Cut& cut) {
  const auto level = [&](NodeId node) { return reader.record(node).node.level; };
  return std::ranges::any_of(cut.nodes(),
                             [&](NodeId node) { return level(node) != level(cut[0]); });
}

/// Returns the part of space over the box around the polygons.
BoundsD column_over(const PlanRegion& plan, UpAxis up) {
  const auto& [least, most] = plan.corners();
  const double any = std::numeric_limits<double>::infinity();
  if (up == UpAxis::z)
    return {{least.x, least.y, -any}, {most.x, most.y, any}};
  return {{least.x, -any, -most.y}, {most.x, any, -least.y}};  // the north is -z
}

}  // namespace

CutPart DrawnCut::load(CutParts& parts, std::size_t tile) const {
  cancel.check();
  CutPart part = parts.load(tile);
  return region ? clip_part(part, reader.tile_format().attributes, *region, Clipping::at_border)
                : std::move(part);
}

Benches::Benches(const DrawnCut& shown, std::size_t count, std::uint64_t cache_bytes) {
  for (std::size_t i = 0; i < count; ++i)
    parts_.push_back(std::make_unique<CutParts>(shown.reader, shown.cut, cache_bytes / count));
}

void require_surface(const HierarchyReader& reader, const char* what) {
  if (reader.manifest().source.triangles == 0) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: it has points alone; {} needs a surface, which triangles make",
                            reader.directory().string(), what));
  }
}

std::vector<BoundsD> boxes_of(const DrawnCut& shown, Benches& benches,
                              execution::Progress& progress) {
  const Cut& cut = shown.cut;
  std::vector<BoundsD> boxes(cut.size());
  const bool is_read = mixes_levels(shown.reader, cut);
  for (std::size_t i = 0; i < cut.size() && !is_read; ++i) {
    const Bounds& box = shown.reader.record(cut[i]).bounds;
    if (!box.empty())
      boxes[i] = {to_double(box.min), to_double(box.max)};
  }
  if (is_read) {
    progress.stage("measure", cut.size(), "tiles");
    shown.reader.will_read(cut.nodes());
    execution::ordered_for(
        cut.size(), benches.size(), shown.cancel,
        [&](std::size_t i) {
          BoundsD box;
          for (const Vec3f& position : benches.of(i).load(i).vertices.positions)
            box.add(to_double(position));
          return box;
        },
        [&](std::size_t i, const BoundsD& box) {
          boxes[i] = box;
          progress.advance(1);
        });
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty() && shown.region && !shown.region->may_show(cut[i], boxes[i]))
      boxes[i] = {};
  }
  return boxes;
}

BoundsD drawn_box(const HierarchyReader& reader, const MapFrame& frame,
                  const RegionRequest& request, const std::optional<Region>& region,
                  const ConvexRegion* kept) {
  const storage::Manifest& manifest = reader.manifest();
  const double any = std::numeric_limits<double>::infinity();
  BoundsD limits{{-any, -any, -any}, {any, any, any}};
  if (request.box && request.crs.empty())
    limits = {request.box->min - manifest.origin, request.box->max - manifest.origin};
  if (region && region->plan)
    limits = common_part(limits, column_over(*region->plan, manifest.up));
  if (region && region->objects)
    limits = common_part(limits, region->objects->box());
  BoundsD all;
  for (const TileRecord& record : reader.records()) {
    if (!is_of_input(reader, record) || record.bounds.empty())
      continue;
    const BoundsD box =
        common_part({to_double(record.bounds.min), to_double(record.bounds.max)}, limits);
    if (!box.empty() && (kept == nullptr || kept->may_meet(box)))
      all.add(frame.around(box));
  }
  return all;
}

}  // namespace meshhier::exporting
