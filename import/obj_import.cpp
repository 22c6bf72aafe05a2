#include "import/obj_import.h"

#include "import/gather_values.h"
#include "import/obj_look.h"
#include "import/split_corners.h"
#include "import/text_blocks.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace meshhier::importing {
namespace {

using mesh_io::ObjColour;
using mesh_io::ObjCorner;
using mesh_io::ObjTriangle;

// CornerParts::parts of an OBJ file, each from 1 on.
constexpr std::size_t kTexcoord = 0;
constexpr std::size_t kNormal = 1;

/// Counts the corners of triangles that have colours in the file.
class CornerColours {
 public:
  explicit CornerColours(const ObjParts& parts) : colours_(parts.colours) {}

  std::size_t count(const ObjTriangle& triangle) {
    return static_cast<std::size_t>(std::ranges::count_if(
        triangle, [this](const ObjCorner& c) { return is_colour(colours_.at(c.position)); }));
  }

 private:
  SpoolLookup<ObjColour> colours_;
};

/// Returns whether colours of a textured file tint: vertices have them where there is no picture,
/// and there alone. Programs also colour vertices that have pictures: such colours say the same
/// twice.
bool do_colours_tint(const ObjParts& parts, ObjSurface& surface, const ImportRoom& room) {
  ShownTriangles triangles(parts, surface, room);
  CornerColours colours(parts);
  bool is_plain_coloured = false;
  for (std::uint64_t i = 0; i < triangles.count(); ++i) {
    const bool has_picture = triangles.shown(i).has_picture;  // materials are numbered as asked for
    if (colours.count(triangles.triangle(i)) == 0)
      continue;
    if (has_picture)
      return false;
    is_plain_coloured = true;
  }
  return is_plain_coloured;
}

/// Adds the corners of all triangles. show(i) returns what triangle i shows:
/// CornerParts::kMaterial, and whether texture coordinates count.
template <class Show>
void add_corners(const ObjParts& parts, CornerSplitter& splitter, const ImportRoom& room,
                 const Show& show) {
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  execution::SpoolCursor labels(parts.combinations, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    const auto [material, has_coordinates] = show(i);
    const std::uint32_t label = labels.size() == 0 ? 0 : labels.at(i);
    // kNone + 1 is 0.
    for (const ObjCorner& c : triangles.at(i)) {
      splitter.add(
          {c.position, {has_coordinates ? c.texcoord + 1 : 0, c.normal + 1, label, material}});
    }
  }
}

using Shown = std::pair<std::uint32_t, bool>;

/// Adds the corners of triangles with their materials. Triangles without a picture whose corners
/// all have colours that tint get a white one.
void add_shown_corners(const ObjParts& parts, ObjSurface& surface, bool tint, RawMesh& mesh,
                       CornerSplitter& splitter, const ImportRoom& room) {
  ShownTriangles triangles(parts, surface, room);
  CornerColours colours(parts);
  std::optional<std::uint32_t> white;
  add_corners(parts, splitter, room, [&](std::uint64_t i) {
    const ObjTextures::Shown shown = triangles.shown(i);
    if (!tint || shown.has_picture || colours.count(triangles.triangle(i)) < 3)
      return Shown(shown.number + 1, shown.has_picture);
    if (!white)
      white = mesh.materials.add({});
    return Shown(*white + 1, false);
  });
}

void add_plain_corners(const ObjParts& parts, const std::optional<ObjPaint>& paint,
                       CornerSplitter& splitter, const ImportRoom& room) {
  execution::SpoolCursor names(parts.materials, room.cancel);
  add_corners(parts, splitter, room,
              [&](std::uint64_t i) { return Shown(paint ? paint->part(names.at(i)) : 0, true); });
}

/// Appends the vertex's own colour, else that of a material (ObjPaint::part), as the file's own
/// are; returns false if there is none, which is white.
bool append_colour(ObjColour colour, std::uint32_t paint, RawMesh& mesh) {
  const bool is_known = is_colour(colour) || paint > 0;
  if (!is_colour(colour)) {
    colour = ObjPaint::colour(paint).values();
    for (float& channel : colour)
      channel /= 255;
  }
  mesh.attributes.append(colour);
  return is_known;
}

/// Appends the vertices that corners have become.
class ObjVertices {
 public:
  ObjVertices(ObjParts& parts, const SplitVertices& vertices, const ObjLook& look,
              const AttributeLayout& layout, RawMesh& mesh, const ImportRoom& room)
      : parts_(parts),
        look_(look),
        layout_(layout),
        mesh_(mesh),
        texcoords_(room.scratch, kImportSpoolBytes),
        normals_(room.scratch, kImportSpoolBytes),
        vertices_(vertices, room.cancel),
        positions_(parts.positions, room.cancel),
        colours_(parts.colours, room.cancel),
        all_texcoords_(texcoords_, room.cancel),
        all_normals_(normals_, room.cancel) {
    if (layout.texcoords)
      gather(vertices.parts[kTexcoord], parts.texcoords, texcoords_, room);
    if (layout.normals)
      gather(vertices.parts[kNormal], parts.normals, normals_, room);
  }

  void append(AddedFile& added) {
    for (std::uint64_t i = 0; i < vertices_.size(); ++i) {
      const std::uint32_t position = vertices_.position(i);
      const CornerParts::Parts shown = vertices_.parts(i);
      mesh_.positions.append(positions_.at(position));
      if (layout_.normals) {
        const Vec3f n = all_normals_.at(i);
        mesh_.attributes.append(std::array{n.x, n.y, n.z});
      }
      append_colour_of(position, shown);
      mesh_.attributes.append(parts_.labels.channels(shown[CornerParts::kValues]));
      if (layout_.material)
        append_material(i, shown);
      else if (layout_.texcoords)
        mesh_.attributes.append(all_texcoords_.at(i));
    }
    added.count(kMadeWhite, made_white_);
    added.count(kHiddenColours, hidden_colours_);
  }

 private:
  void append_colour_of(std::uint32_t position, const CornerParts::Parts& shown) {
    const std::uint32_t material = shown[CornerParts::kMaterial];
    if (layout_.colour == PlainColours::kType) {
      mesh_.attributes.append(ObjPaint::colour(material).values());
    } else if (layout_.has_colours()) {
      const bool is_coloured =
          append_colour(colours_.at(position), look_.paint ? material : 0, mesh_);
      made_white_ += is_coloured || layout_.material ? 0 : 1;
      const bool is_plain = layout_.material && material > 0 && shown[kTexcoord] == 0;
      hidden_colours_ += is_coloured && is_plain && !layout_.tints ? 1 : 0;
    }
  }

  void append_material(std::uint64_t vertex, const CornerParts::Parts& shown) {
    // A position that no triangle uses has no material: any will do.
    const std::uint32_t material = std::max(shown[CornerParts::kMaterial], std::uint32_t{1}) - 1;
    const Vec2f at = shown[kTexcoord] == 0
                         ? Vec2f{}
                         : look_.surface->textures.texcoord(material, all_texcoords_.at(vertex));
    mesh_.attributes.append(std::array{at.u, at.v, static_cast<float>(material)});
  }

  ObjParts& parts_;
  const ObjLook& look_;
  const AttributeLayout& layout_;
  RawMesh& mesh_;
  storage::RecordSpool<ObjParts::Texcoord> texcoords_;  ///< one a vertex; or none
  storage::RecordSpool<Vec3f> normals_;                 ///< likewise
  SplitCursor vertices_;
  execution::SpoolCursor<Vec3d> positions_;
  execution::SpoolCursor<ObjColour> colours_;
  execution::SpoolCursor<ObjParts::Texcoord> all_texcoords_;
  execution::SpoolCursor<Vec3f> all_normals_;
  std::uint64_t made_white_ = 0, hidden_colours_ = 0;
};

/// Corners refer to positions alone. Returns how many became white.
std::uint64_t append_plain(const ObjParts& parts, RawMesh& mesh, const ImportRoom& room) {
  std::uint64_t made_white = 0;
  const std::uint64_t base = mesh.vertex_count();
  execution::SpoolCursor positions(parts.positions, room.cancel);
  for (std::uint64_t i = 0; i < positions.size(); ++i)
    mesh.positions.append(positions.at(i));
  execution::SpoolCursor colours(parts.colours, room.cancel);
  for (std::uint64_t i = 0; i < colours.size(); ++i)
    made_white += append_colour(colours.at(i), 0, mesh) ? 0 : 1;
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    const ObjTriangle& t = triangles.at(i);
    mesh.triangles.append({static_cast<std::uint32_t>(base + t[0].position),
                           static_cast<std::uint32_t>(base + t[1].position),
                           static_cast<std::uint32_t>(base + t[2].position)});
  }
  return made_white;
}

/// Corners that name several things at a position become vertices.
void append_split(ObjParts& parts, const ObjLook& look, AddedFile& added, RawMesh& mesh,
                  const ImportRoom& room) {
  SplitVertices vertices(room.scratch);
  CornerSplitter splitter(parts.positions.size(), room);
  if (look.surface) {
    added.layout.tints = parts.counts.coloured > 0 && do_colours_tint(parts, *look.surface, room);
    add_shown_corners(parts, *look.surface, added.layout.tints, mesh, splitter, room);
  } else {
    add_plain_corners(parts, look.paint, splitter, room);
  }
  parts.triangles.clear();
  if (look.paint && parts.colours.size() > 0) {
    execution::SpoolCursor colours(parts.colours, room.cancel);
    splitter.split(vertices, mesh,
                   [&](std::uint32_t position) { return is_colour(colours.at(position)); });
  } else {
    splitter.split(vertices, mesh);
  }
  ObjVertices(parts, vertices, look, added.layout, mesh, room).append(added);
  added.count("split_vertices", vertices.count() - parts.positions.size());
  added.count("vertices_without_texcoord",
              added.layout.texcoords ? vertices.without[kTexcoord] : 0);
  added.count("vertices_without_normal", added.layout.normals ? vertices.without[kNormal] : 0);
}

void read_parts(mesh_io::InputStream& stream, const std::filesystem::path& path, ObjParts& parts,
                const ImportRoom& room) {
  mesh_io::ObjReader reader(path, parts);
  parts.counts = read_text_blocks<mesh_io::ObjBlock>(
      mesh_io::LineBlocks(stream), mesh_io::kObjBlockBytes, mesh_io::parse, reader, room);
  parts.objects.finish(parts.triangles.size());
}

/// Returns what the file has, but for its materials.
AddedFile facts_of(ObjParts& parts) {
  mesh_io::ObjCounts& counts = parts.counts;
  AddedFile added{.fits_float = counts.fits_float,
                  .faces = counts.faces,
                  .degenerate_triangles = counts.degenerate_triangles,
                  .unplaced = counts.unplaced};
  added.layout.texcoords = counts.textured_corners > 0;
  added.layout.normals = counts.normal_corners > 0;
  added.layout.values = parts.labels.attributes();
  if (parts.has_polypaint())
    counts.coloured = counts.positions;
  else
    added.count("ignored_polypaint", counts.painted);
  if (counts.coloured > 0)
    added.layout.colour = ColourType::f32;
  added.count(counts.zeroed);
  added.count(counts.odd);
  added.count("groups", counts.groups);
  added.count("objects", counts.objects);
  added.count("material_uses", counts.materials);
  added.count("material_libraries", counts.libraries);
  added.count(kPointsAndLines, counts.points_and_lines);
  added.count(counts.polygons);
  added.count("ignored_statements", counts.others);
  return added;
}

}  // namespace

AddedFile import_obj(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     mesh_io::NamedFiles& files, Textures textures,
                     const mesh_io::AttributeChoice& attributes, const ImportRoom& room) {
  ObjParts parts(path, attributes, textures == Textures::use, mesh, room.scratch);
  read_parts(stream, path, parts, room);
  AddedFile added = facts_of(parts);
  ObjLook look;
  if (textures == Textures::use)
    look = find_look(parts, added, mesh, files, room);
  added.layout.material = look.surface != nullptr;
  if (look.paint) {
    added.is_painted = !added.layout.has_colours();
    if (added.is_painted)
      added.layout.colour = PlainColours::kType;
    added.material_colours = look.paint->count();
  }
  const AttributeLayout& layout = added.layout;
  if (layout.texcoords || layout.normals || look.paint || !layout.values.empty())
    append_split(parts, look, added, mesh, room);
  else
    added.count(kMadeWhite, append_plain(parts, mesh, room));
  return added;
}

}  // namespace meshhier::importing
