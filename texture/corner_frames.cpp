#include "texture/corner_frames.h"

namespace meshhier::texture {

CornerFrames::CornerFrames(std::size_t vertex_count, std::span<const TileTriangle> triangles,
                           std::span<const CornerNormals> normals)
    : triangles_(triangles), normals_(normals), last_(vertex_count), numbers_(triangles.size()) {
  frames_.reserve(vertex_count);
  tangents_.reserve(vertex_count);
}

void CornerFrames::add_chart(const ChartPlane& plane, std::span<const std::uint32_t> chart) {
  ++chart_;
  for (const std::uint32_t t : chart) {
    for (std::size_t k = 0; k < 3; ++k)
      numbers_[t][k] = frame_of_corner(plane, raw(triangles_[t][k]), normals_[t][k]);
  }
}

std::uint32_t CornerFrames::frame_of_corner(const ChartPlane& plane, std::uint32_t vertex,
                                            const Vec3f& normal) {
  Last& last = last_[vertex];
  if (last.chart != chart_ || last.normal != normal) {
    last = {chart_, static_cast<std::uint32_t>(frames_.size()), normal};
    tangents_.push_back(tangent_of(plane, normal));
    frames_.push_back(frame_of(normal, tangents_.back()));
  }
  return last.number;
}

std::vector<CornerTangents> CornerFrames::tangents() const {
  std::vector<CornerTangents> tangents;
  tangents.reserve(numbers_.size());
  for (const auto& [a, b, c] : numbers_)
    tangents.push_back({tangents_[a], tangents_[b], tangents_[c]});
  return tangents;
}

}  // namespace meshhier::texture
