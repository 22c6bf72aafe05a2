#include "import/obj_import.h"

#include "execution/spool_cursor.h"
#include "hierarchy/error.h"
#include "partition/external_sort.h"

#include <utility>

namespace meshhier::importing {
namespace {

using mesh_io::ObjColour;
using mesh_io::ObjCorner;
using mesh_io::ObjTriangle;
using Texcoord = std::array<float, 2>;

constexpr ObjColour kWhite{1, 1, 1};

/// All that a file holds, as it stands there.
class ObjParts final : public mesh_io::ObjVisitor {
 public:
  explicit ObjParts(storage::ScratchFile& scratch)
      : positions(scratch, kImportSpoolBytes),
        colours(scratch, kImportSpoolBytes),
        texcoords(scratch, kImportSpoolBytes),
        normals(scratch, kImportSpoolBytes),
        triangles(scratch, kImportSpoolBytes) {}

  void add_position(Vec3d position, const std::optional<ObjColour>& colour) override {
    positions.append(position);
    if (colour && colours.size() == 0) {
      for (std::uint64_t i = 1; i < positions.size(); ++i)
        colours.append(kWhite);
    }
    if (colour || colours.size() > 0)
      colours.append(colour.value_or(kWhite));
  }
  void add_texcoord(Texcoord texcoord) override { texcoords.append(texcoord); }
  void add_normal(Vec3f normal) override { normals.append(normal); }
  void add_triangle(const ObjTriangle& triangle) override { triangles.append(triangle); }

  storage::RecordSpool<Vec3d> positions;
  storage::RecordSpool<ObjColour> colours;  ///< none, or one a position
  storage::RecordSpool<Texcoord> texcoords;
  storage::RecordSpool<Vec3f> normals;
  storage::RecordSpool<ObjTriangle> triangles;
};

/// A corner of a triangle with what it refers to: the position from 0 on, the others from 1 on, 0
/// being none.
struct CornerUse {
  std::uint32_t position, texcoord, normal;
  std::uint32_t corner_high, corner_low;  ///< not a u64, so that nothing is padded

  std::uint64_t corner() const { return std::uint64_t{corner_high} << 32 | corner_low; }
  bool is_same_vertex(const CornerUse& other) const {
    return position == other.position && texcoord == other.texcoord && normal == other.normal;
  }
};
/// By position, texture coordinate, normal; of equal ones the corner does not matter.
struct UseKey {
  using Key = std::pair<std::uint64_t, std::uint32_t>;
  Key operator()(const CornerUse& use) const {
    return {std::uint64_t{use.position} << 32 | use.texcoord, use.normal};
  }
};

struct Reference {
  std::uint32_t target, from;
};
struct ReferenceKey {
  std::uint32_t operator()(const Reference& reference) const { return reference.target; }
};

template <class Value>
struct Placed {
  std::uint32_t place;
  Value value;
};
struct PlaceKey {
  template <class Value>
  std::uint32_t operator()(const Placed<Value>& placed) const {
    return placed.place;
  }
};

struct CornerVertex {
  std::uint64_t corner, vertex;
};
struct CornerKey {
  std::uint64_t operator()(const CornerVertex& c) const { return c.corner; }
};
using CornerSort = partition::ExternalSort<CornerVertex, CornerKey>;

using References = storage::RecordSpool<std::uint32_t>;  // of each vertex, from 1 on; 0: none

/// What each vertex refers to, in the vertices' order; what refers to nothing gets Value{}. Two
/// sorts, however the references jump.
template <class Value>
void gather(const References& references, const storage::RecordSpool<Value>& values,
            storage::RecordSpool<Value>& gathered, const ImportRoom& room) {
  partition::ExternalSort<Placed<Value>, PlaceKey> by_place(room.scratch, room.sort_bytes);
  {
    partition::ExternalSort<Reference, ReferenceKey> by_target(room.scratch, room.sort_bytes);
    execution::SpoolCursor all(references, room.cancel);
    for (std::uint64_t i = 0; i < references.size(); ++i) {
      if (all.at(i) > 0)
        by_target.add({all.at(i) - 1, static_cast<std::uint32_t>(i)});
    }
    by_target.sort();
    execution::SpoolCursor targets(values, room.cancel);
    by_target.for_each_block([&](std::span<const Reference> block) {
      for (const Reference& reference : block)
        by_place.add({reference.from, targets.at(reference.target)});
    });
  }
  by_place.sort();
  by_place.for_each_block([&](std::span<const Placed<Value>> block) {
    room.cancel.check();
    for (const Placed<Value>& placed : block) {
      while (gathered.size() < placed.place)
        gathered.append(Value{});
      gathered.append(placed.value);
    }
  });
  while (gathered.size() < references.size())
    gathered.append(Value{});
}

/// Vertices, one for each combination that corners use, as references to the parts.
struct SplitVertices {
  explicit SplitVertices(storage::ScratchFile& scratch)
      : positions(scratch, kImportSpoolBytes),
        texcoords(scratch, kImportSpoolBytes),
        normals(scratch, kImportSpoolBytes) {}

  void add(std::uint32_t position, std::uint32_t texcoord, std::uint32_t normal) {
    if (positions.size() + 1 >= UINT32_MAX)
      throw Error(ErrorCode::input, "the input has 2^32 vertices or more; split it");
    positions.append(position);
    texcoords.append(texcoord);
    normals.append(normal);
    without_texcoord += texcoord == 0 ? 1 : 0;
    without_normal += normal == 0 ? 1 : 0;
  }
  std::uint64_t count() const { return positions.size(); }

  References positions;  ///< from 0 on: all have one
  References texcoords;
  References normals;
  std::uint64_t without_texcoord = 0;
  std::uint64_t without_normal = 0;
};

/// `corners`: gets the vertex of each corner.
void split_corners(const ObjParts& parts, SplitVertices& vertices, CornerSort& corners,
                   const ImportRoom& room) {
  partition::ExternalSort<CornerUse, UseKey> uses(room.scratch, room.sort_bytes);
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    for (std::uint64_t k = 0; k < 3; ++k) {
      const ObjCorner& c = triangles.at(i)[k];
      const std::uint64_t corner = 3 * i + k;
      // kNone + 1 is 0.
      uses.add({c.position, c.texcoord + 1, c.normal + 1, static_cast<std::uint32_t>(corner >> 32),
                static_cast<std::uint32_t>(corner)});
    }
  }
  uses.sort();
  std::uint32_t next = 0;  // position
  CornerUse last{};
  uses.for_each_block([&](std::span<const CornerUse> block) {
    room.cancel.check();
    for (const CornerUse& use : block) {
      const bool is_first = next <= use.position;
      while (next < use.position)
        vertices.add(next++, 0, 0);
      if (is_first || !use.is_same_vertex(last))
        vertices.add(use.position, use.texcoord, use.normal);
      next = use.position + 1;
      last = use;
      corners.add({use.corner(), vertices.count() - 1});
    }
  });
  while (next < parts.positions.size())
    vertices.add(next++, 0, 0);
}

void append_vertices(const ObjParts& parts, const SplitVertices& vertices,
                     const AttributeLayout& layout, RawMesh& mesh, const ImportRoom& room) {
  storage::RecordSpool<Texcoord> texcoords(room.scratch, kImportSpoolBytes);
  storage::RecordSpool<Vec3f> normals(room.scratch, kImportSpoolBytes);
  if (layout.texcoords)
    gather(vertices.texcoords, parts.texcoords, texcoords, room);
  if (layout.normals)
    gather(vertices.normals, parts.normals, normals, room);
  execution::SpoolCursor places(vertices.positions, room.cancel);
  execution::SpoolCursor positions(parts.positions, room.cancel);
  execution::SpoolCursor colours(parts.colours, room.cancel);
  execution::SpoolCursor all_texcoords(texcoords, room.cancel);
  execution::SpoolCursor all_normals(normals, room.cancel);
  for (std::uint64_t i = 0; i < vertices.count(); ++i) {
    const std::uint32_t position = places.at(i);
    mesh.positions.append(positions.at(position));
    if (layout.normals) {
      const Vec3f n = all_normals.at(i);
      mesh.attributes.append(std::array{n.x, n.y, n.z});
    }
    if (layout.colour != ColourType::none)
      mesh.attributes.append(colours.at(position));
    if (layout.texcoords)
      mesh.attributes.append(all_texcoords.at(i));
  }
}

/// Corners refer to positions alone.
void append_plain(const ObjParts& parts, RawMesh& mesh, const ImportRoom& room) {
  const std::uint64_t base = mesh.vertex_count();
  execution::SpoolCursor positions(parts.positions, room.cancel);
  for (std::uint64_t i = 0; i < positions.size(); ++i)
    mesh.positions.append(positions.at(i));
  execution::SpoolCursor colours(parts.colours, room.cancel);
  for (std::uint64_t i = 0; i < colours.size(); ++i)
    mesh.attributes.append(colours.at(i));
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    const ObjTriangle& t = triangles.at(i);
    mesh.triangles.append({static_cast<std::uint32_t>(base + t[0].position),
                           static_cast<std::uint32_t>(base + t[1].position),
                           static_cast<std::uint32_t>(base + t[2].position)});
  }
}

void append_triangles(CornerSort& corners, std::uint64_t base, RawMesh& mesh,
                      const ImportRoom& room) {
  corners.sort();
  Triangle<std::uint32_t> triangle{};
  corners.for_each_block([&](std::span<const CornerVertex> block) {
    room.cancel.check();
    for (const auto& [corner, vertex] : block) {
      triangle[corner % 3] = static_cast<std::uint32_t>(base + vertex);
      if (corner % 3 == 2)
        mesh.triangles.append(triangle);
    }
  });
}

}  // namespace

ObjImport import_obj(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     const ImportRoom& room) {
  ObjParts parts(room.scratch);
  ObjImport import;
  import.counts = mesh_io::read_obj(stream, path, parts);
  import.fits_float = import.counts.fits_float;
  import.layout.texcoords = import.counts.textured_corners > 0;
  import.layout.normals = import.counts.normal_corners > 0;
  if (import.counts.coloured > 0) {
    import.layout.colour = ColourType::f32;
    import.filled_colours = import.counts.positions - import.counts.coloured;
  }
  if (!import.layout.texcoords && !import.layout.normals) {
    append_plain(parts, mesh, room);
    return import;
  }
  const std::uint64_t base = mesh.vertex_count();
  SplitVertices vertices(room.scratch);
  CornerSort corners(room.scratch, room.sort_bytes);
  split_corners(parts, vertices, corners, room);
  parts.triangles.clear();
  append_triangles(corners, base, mesh, room);
  append_vertices(parts, vertices, import.layout, mesh, room);
  import.split_vertices = vertices.count() - parts.positions.size();
  import.filled_texcoords = import.layout.texcoords ? vertices.without_texcoord : 0;
  import.filled_normals = import.layout.normals ? vertices.without_normal : 0;
  return import;
}

}  // namespace meshhier::importing
