#include "import/split_corners.h"

#include "base/error.h"
#include "execution/spool_cursor.h"

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

/// Gives vertices their numbers, position by position, of each in the order of their parts.
class CornerSplitter::Numbering {
 public:
  Numbering(const std::function<bool(std::uint32_t)>& hides_material, SplitVertices& vertices)
      : hides_material_(hides_material), vertices_(vertices) {}

  /// Returns the number of the vertex of corners with these parts. Parts ascend from call to call.
  std::uint64_t number(CornerParts shown) {
    // The material is the last part, so that equal ones stay together without it.
    if (hides_material_ && hides_material_(shown.position))
      shown.parts[CornerParts::kMaterial] = 0;
    if (vertices_.count() == 0 || shown != last_)
      vertices_.add(shown);
    last_ = shown;
    return vertices_.count() - 1;
  }
  /// Adds the vertex of a position that no corner uses.
  void add_unused(std::uint32_t position) {
    last_ = {position};
    vertices_.add(last_);
  }

 private:
  const std::function<bool(std::uint32_t)>& hides_material_;
  SplitVertices& vertices_;
  CornerParts last_{};
};

CornerSplitter::CornerSplitter(std::uint64_t positions, const ImportRoom& room)
    : positions_(positions),
      room_(room),
      firsts_(positions <= room.sort_bytes / kTableBytes ? positions : 0),
      vertices_(firsts_.size(), kUnused),
      shown_(room.scratch, kImportSpoolBytes),
      sort_bytes_(has_table() ? room.sort_bytes / 2 : room.sort_bytes),
      uses_(room.scratch, sort_bytes_) {}

void CornerSplitter::add(const CornerParts& corner) {
  const std::uint64_t number = corners_++;
  const Use use{corner, static_cast<std::uint32_t>(number >> 32),
                static_cast<std::uint32_t>(number)};
  if (!has_table())
    return uses_.add(use);
  shown_.append(corner);
  if (vertices_[corner.position] == kUnused) {
    vertices_[corner.position] = 0;  // some number: it is used
    firsts_[corner.position] = corner.parts;
  } else if (firsts_[corner.position] != corner.parts) {
    uses_.add(use);
  }
}

void CornerSplitter::split(SplitVertices& vertices, RawMesh& mesh,
                           const std::function<bool(std::uint32_t)>& hides_material) {
  CornerSort corners(room_.scratch, sort_bytes_);
  Numbering numbering(hides_material, vertices);
  number(numbering, corners);
  if (has_table())
    append_looked_up(corners, mesh.vertex_count(), mesh);
  else
    append_triangles(corners, mesh.vertex_count(), mesh);
}

void CornerSplitter::number(Numbering& numbering, CornerSort& corners) {
  uses_.sort();
  std::uint32_t at = 0;
  bool is_done = false;  // this position has a vertex: the table's, or that of a use
  const auto take_first = [&] {
    vertices_[at] = static_cast<std::uint32_t>(numbering.number({at, firsts_[at]}));
    is_done = true;
  };
  const auto leave = [&] {
    if (!is_done && has_table() && vertices_[at] != kUnused)
      take_first();
    else if (!is_done)
      numbering.add_unused(at);
    is_done = false;
    ++at;
  };
  uses_.for_each_block([&](std::span<const Use> block) {
    room_.cancel.check();
    for (const Use& use : block) {
      // Positions without another use have the table's vertex, or one that no corner uses.
      while (at < use.shown.position)
        leave();
      // The table's parts are not among the uses; their vertex has its place in the order of parts.
      if (has_table() && !is_done && firsts_[at] < use.shown.parts)
        take_first();
      corners.add({use.corner(), numbering.number(use.shown)});
      is_done = is_done || !has_table();
    }
  });
  while (at < positions_)
    leave();
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

/// `corners`: those that show something else than the table has.
void CornerSplitter::append_looked_up(CornerSort& corners, std::uint64_t base, RawMesh& mesh) {
  corners.sort();
  std::span<const CornerVertex> others = corners.next_block();
  execution::SpoolCursor shown(shown_, room_.cancel);
  Triangle<std::uint32_t> triangle{};
  for (std::uint64_t i = 0; i < corners_; ++i) {
    const CornerParts& corner = shown.at(i);
    std::uint64_t vertex = vertices_[corner.position];
    if (!others.empty() && others.front().corner == i) {
      vertex = others.front().vertex;
      others = others.size() > 1 ? others.subspan(1) : corners.next_block();
    }
    triangle[i % 3] = static_cast<std::uint32_t>(base + vertex);
    if (i % 3 == 2)
      mesh.triangles.append(triangle);
  }
}

}  // namespace meshhier::importing
