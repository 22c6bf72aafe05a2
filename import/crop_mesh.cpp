#include "import/crop_mesh.h"

#include "base/half_space.h"
#include "execution/spool_cursor.h"
#include "import/renumber_triangles.h"
#include "import/used_vertices.h"

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

using Triangles = storage::RecordSpool<Triangle<std::uint32_t>>;

/// A bit for each side of the box that a point is beyond (Cohen & Sutherland). One that is not
/// finite is beyond none.
std::uint8_t sides_beyond(const BoundsD& box, Vec3d p) {
  std::uint8_t sides = 0;
  for (int axis = 0; axis < 3; ++axis) {
    sides |= static_cast<std::uint8_t>((p[axis] < box.min[axis] ? 1 : 0) << (2 * axis));
    sides |= static_cast<std::uint8_t>((p[axis] > box.max[axis] ? 2 : 0) << (2 * axis));
  }
  return sides;
}

/// A corner of a triangle with what decides.
struct SidedCorner {
  std::uint32_t vertex;
  std::uint32_t sides;
};
struct PlacedCorner {
  Vec3d position;
  std::uint64_t vertex;
};

template <class Value>
Triangle<std::uint32_t> vertices_of(const Triangle<Value>& corners) {
  return {static_cast<std::uint32_t>(corners[0].vertex),
          static_cast<std::uint32_t>(corners[1].vertex),
          static_cast<std::uint32_t>(corners[2].vertex)};
}

/// Positions and attributes of vertices whose numbers ascend.
void copy_vertices(const RawMesh& from, const storage::RecordSpool<std::uint32_t>& used,
                   RawMesh& to, const ImportRoom& room) {
  execution::SpoolCursor vertices(used, room.cancel);
  execution::SpoolCursor positions(from.positions, room.cancel);
  execution::SpoolCursor attributes(from.attributes, room.cancel);
  const std::size_t channels = from.channels();
  for (std::uint64_t i = 0; i < used.size(); ++i) {
    const std::uint64_t vertex = vertices.at(i);
    to.positions.append(positions.at(vertex));
    for (std::size_t c = 0; c < channels; ++c)
      to.attributes.append(attributes.at(vertex * channels + c));
  }
}

void keep_points(const RawMesh& mesh, RawMesh& cropped, const BoundsD& box,
                 const ImportRoom& room) {
  storage::RecordSpool<std::uint32_t> inside(room.scratch, kImportSpoolBytes);
  execution::SpoolCursor positions(mesh.positions, room.cancel);
  for (std::uint64_t i = 0; i < mesh.vertex_count(); ++i) {
    if (sides_beyond(box, positions.at(i)) == 0)
      inside.append(static_cast<std::uint32_t>(i));
  }
  copy_vertices(mesh, inside, cropped, room);
}

/// The vertices of the source that are used; their numbers ascend.
class UsedVertices {
 public:
  UsedVertices(const storage::RecordSpool<std::uint32_t>& used, std::size_t channels, RawMesh& mesh,
               const ImportRoom& room)
      : used_(used), vertices_(used, room.cancel), channels_(channels), mesh_(mesh) {}

  void take(const mesh_io::VertexBlock& block) {
    const std::uint64_t end = block.first + block.positions.size() + block.exact.size();
    for (; next_ < used_.size() && vertices_.at(next_) < end; ++next_) {
      const std::size_t i = vertices_.at(next_) - block.first;
      mesh_.positions.append(block.exact.empty() ? to_double(block.positions[i]) : block.exact[i]);
      mesh_.attributes.append(block.attributes.subspan(i * channels_, channels_));
    }
  }

 private:
  const storage::RecordSpool<std::uint32_t>& used_;
  execution::SpoolCursor<std::uint32_t> vertices_;
  std::size_t channels_;
  RawMesh& mesh_;
  std::uint64_t next_ = 0;
};

/// The sides that each vertex is beyond, in memory.
class SideTable {
 public:
  explicit SideTable(std::uint64_t vertices) : sides_(vertices) {}
  void set(std::uint64_t vertex, std::uint8_t sides) { sides_[vertex] = sides; }
  mesh_io::FaceCounts near(mesh_io::MeshSource& source, Triangles& found,
                           const ImportRoom& room) const {
    return source.read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
      room.cancel.check();
      for (const Triangle<VertexId>& t : triangles) {
        if ((sides_[raw(t[0])] & sides_[raw(t[1])] & sides_[raw(t[2])]) == 0)
          found.append(Triangle<std::uint32_t>{raw(t[0]), raw(t[1]), raw(t[2])});
      }
    });
  }

 private:
  std::vector<std::uint8_t> sides_;
};

/// The same on disk, where triangles wait for their part of it.
class SideSpool {
 public:
  explicit SideSpool(const ImportRoom& room) : sides_(room.scratch, kImportSpoolBytes) {}
  void set(std::uint64_t /*vertex*/, std::uint8_t sides) { sides_.append(sides); }
  mesh_io::FaceCounts near(mesh_io::MeshSource& source, Triangles& found,
                           const ImportRoom& room) const {
    const auto read = [&](std::uint64_t first, std::span<SidedCorner> corners) {
      std::vector<std::uint8_t> block(corners.size());
      sides_.read(first, block);
      for (std::size_t i = 0; i < corners.size(); ++i)
        corners[i] = {static_cast<std::uint32_t>(first + i), block[i]};
    };
    const auto take = [&](const Triangle<SidedCorner>& t) {
      if ((t[0].sides & t[1].sides & t[2].sides) == 0)
        found.append(vertices_of(t));
    };
    TriangleTranslator<SidedCorner, decltype(take)> table({0, sides_.size(), read, false}, take,
                                                          room);
    const mesh_io::FaceCounts counts = source.read_triangles(
        [&](std::span<const Triangle<VertexId>> triangles) { table.add(triangles); });
    table.finish();
    return counts;
  }

 private:
  storage::RecordSpool<std::uint8_t> sides_;
};

template <class Sides>
mesh_io::FaceCounts find_near(mesh_io::MeshSource& source, const BoundsD& box, Sides sides,
                              const mesh_io::VertexVisitor& visit, Triangles& found,
                              const ImportRoom& room) {
  source.read_vertices([&](const mesh_io::VertexBlock& block) {
    room.cancel.check();
    visit(block);
    std::uint64_t vertex = block.first;
    for (const Vec3f& p : block.positions)
      sides.set(vertex++, sides_beyond(box, to_double(p)));
    for (const Vec3d& p : block.exact)
      sides.set(vertex++, sides_beyond(box, p));
  });
  return sides.near(source, found, room);
}

}  // namespace

mesh_io::FaceCounts append_near(mesh_io::MeshSource& source, const BoundsD& box, RawMesh& mesh,
                                const mesh_io::VertexVisitor& visit, const ImportRoom& room) {
  const mesh_io::MeshDescription& description = source.description();
  const std::uint64_t vertices = description.vertex_count;
  auto near = std::make_unique<Triangles>(room.scratch, kImportSpoolBytes);
  const mesh_io::FaceCounts counts =
      vertices <= room.sort_bytes ? find_near(source, box, SideTable(vertices), visit, *near, room)
                                  : find_near(source, box, SideSpool(room), visit, *near, room);
  storage::RecordSpool<std::uint32_t> used(room.scratch, kImportSpoolBytes);
  append_used(std::move(near), vertices, false, mesh, used, room);
  UsedVertices kept(used, static_cast<std::size_t>(description.attributes.channels()), mesh, room);
  source.read_vertices([&](const mesh_io::VertexBlock& block) {
    room.cancel.check();
    kept.take(block);
  });
  return counts;
}

std::uint64_t crop_mesh(RawMesh& mesh, RawMesh& cropped, const BoundsD& box,
                        const ImportRoom& room) {
  cropped.layout = mesh.layout;
  cropped.fits_float = mesh.fits_float;
  const std::uint64_t triangles = mesh.triangles.size();
  if (triangles == 0) {
    keep_points(mesh, cropped, box, room);
  } else {
    const auto read = [&](std::uint64_t first, std::span<PlacedCorner> corners) {
      std::vector<Vec3d> block(corners.size());
      mesh.positions.read(first, block);
      for (std::size_t i = 0; i < corners.size(); ++i)
        corners[i] = {block[i], first + i};
    };
    auto kept = std::make_unique<Triangles>(room.scratch, kImportSpoolBytes);
    const std::array<HalfSpace, 6> sides = half_spaces_of(box);
    const auto take = [&](const Triangle<PlacedCorner>& t) {
      if (touches(sides, {t[0].position, t[1].position, t[2].position}))
        kept->append(vertices_of(t));
    };
    TriangleTranslator<PlacedCorner, decltype(take)> table({0, mesh.vertex_count(), read, false},
                                                           take, room);
    table.add(mesh.triangles);
    table.finish();
    storage::RecordSpool<std::uint32_t> used(room.scratch, kImportSpoolBytes);
    append_used(std::move(kept), mesh.vertex_count(), false, cropped, used, room);
    copy_vertices(mesh, used, cropped, room);
  }
  mesh.positions.clear();
  mesh.attributes.clear();
  mesh.triangles.clear();
  return triangles - cropped.triangles.size();
}

}  // namespace meshhier::importing
