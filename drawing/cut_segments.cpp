#include "drawing/cut_segments.h"

namespace meshhier::drawing {

SlicedPart::SlicedPart(const exporting::CutPart& part, const exporting::MapFrame& view)
    : part_(part), origin_(view.origin) {
  heights_.reserve(part.vertices.size());
  for (const Vec3f& position : part.vertices.positions)
    heights_.push_back(view(position).z);
}

std::uint64_t SlicedPart::count_segments(const CutLevels& levels) const {
  std::uint64_t count = 0;
  for (const auto& t : part_.triangles) {
    const auto [low, high] = std::minmax({heights_[t[0]], heights_[t[1]], heights_[t[2]]});
    const LevelRange range = levels.between(low, high);
    count += range.end - range.begin;
  }
  return count;
}

Vec3d SlicedPart::point_at(const PassedEdge& edge, double height) const {
  const double under = height - heights_[edge.below], over = heights_[edge.above] - height;
  const Vec3d below = to_double(part_.vertices.positions[edge.below]) + origin_;
  const Vec3d above = to_double(part_.vertices.positions[edge.above]) + origin_;
  return over <= under ? above + (below - above) * (over / (under + over))
                       : below + (above - below) * (under / (under + over));
}

}  // namespace meshhier::drawing
