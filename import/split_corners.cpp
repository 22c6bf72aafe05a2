#include "import/split_corners.h"

#include "hierarchy/error.h"

#include <span>

namespace meshhier::importing {

void SplitVertices::add(const CornerParts& vertex) {
  if (positions.size() + 1 >= UINT32_MAX)
    throw Error(ErrorCode::input, "the input has 2^32 vertices or more; split it");
  positions.append(vertex.position);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].append(vertex.parts[i]);
    without[i] += vertex.parts[i] == 0 ? 1 : 0;
  }
}

void CornerSplitter::add(const CornerParts& corner) {
  uses_.add(
      {corner, static_cast<std::uint32_t>(corners_ >> 32), static_cast<std::uint32_t>(corners_)});
  ++corners_;
}

void CornerSplitter::split(std::uint64_t positions, SplitVertices& vertices, RawMesh& mesh,
                           const std::function<bool(std::uint32_t)>& hides_material) {
  CornerSort corners(room_.scratch, room_.sort_bytes);
  number(positions, hides_material, vertices, corners);
  append_triangles(corners, mesh.vertex_count(), mesh);
}

void CornerSplitter::number(std::uint64_t positions,
                            const std::function<bool(std::uint32_t)>& hides_material,
                            SplitVertices& vertices, CornerSort& corners) {
  uses_.sort();
  std::uint32_t next = 0;  // position
  CornerParts last{};
  uses_.for_each_block([&](std::span<const Use> block) {
    room_.cancel.check();
    for (const Use& use : block) {
      const bool is_first = next <= use.shown.position;
      while (next < use.shown.position)
        vertices.add({next++});
      CornerParts shown = use.shown;
      // The material is the last part, so that equal ones stay together without it.
      if (hides_material && hides_material(shown.position))
        shown.parts[CornerParts::kMaterial] = 0;
      if (is_first || shown != last)
        vertices.add(shown);
      next = shown.position + 1;
      last = shown;
      corners.add({use.corner(), vertices.count() - 1});
    }
  });
  while (next < positions)
    vertices.add({next++});
}

void CornerSplitter::append_triangles(CornerSort& corners, std::uint64_t base, RawMesh& mesh) {
  corners.sort();
  Triangle<std::uint32_t> triangle{};
  corners.for_each_block([&](std::span<const CornerVertex> block) {
    room_.cancel.check();
    for (const auto& [corner, vertex] : block) {
      triangle[corner % 3] = static_cast<std::uint32_t>(base + vertex);
      if (corner % 3 == 2)
        mesh.triangles.append(triangle);
    }
  });
}

}  // namespace meshhier::importing
