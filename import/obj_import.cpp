#include "import/obj_import.h"

#include "base/small_letters.h"
#include "execution/spool_cursor.h"
#include "import/material_colours.h"
#include "import/obj_labels.h"
#include "import/obj_objects.h"
#include "import/obj_textures.h"
#include "import/place_lookup.h"
#include "import/split_corners.h"
#include "import/text_blocks.h"
#include "mesh_io/input_error.h"
#include "partition/external_sort.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

using mesh_io::ObjColour;
using mesh_io::ObjCorner;
using mesh_io::ObjTriangle;
using Texcoord = std::array<float, 2>;

constexpr ObjColour kWhite{1, 1, 1};
/// The colour in a spool of a position that has none. No file has such a colour.
constexpr ObjColour kNoColour{std::numeric_limits<float>::infinity()};

bool is_colour(const ObjColour& colour) {
  return colour[0] != kNoColour[0];
}

// CornerParts::parts of an OBJ file, each from 1 on.
constexpr std::size_t kTexcoord = 0;
constexpr std::size_t kNormal = 1;

bool has_texcoords(const ObjTriangle& triangle) {
  return std::ranges::all_of(
      triangle, [](const ObjCorner& corner) { return corner.texcoord != ObjCorner::kNone; });
}

/// All that a file holds, as it stands there.
class ObjParts final : public mesh_io::ObjVisitor {
 public:
  ObjParts(storage::ScratchFile& scratch, const std::filesystem::path& path, Textures use,
           const mesh_io::AttributeChoice& attributes, RawMesh& mesh)
      : names(path),
        labels(attributes, mesh.label_names),
        objects(mesh.objects.get(), scratch),
        positions(scratch, kImportSpoolBytes),
        colours(scratch, kImportSpoolBytes),
        texcoords(scratch, kImportSpoolBytes),
        normals(scratch, kImportSpoolBytes),
        triangles(scratch, kImportSpoolBytes),
        materials(scratch, kImportSpoolBytes),
        combinations(scratch, kImportSpoolBytes),
        keeps_materials_(use == Textures::use),
        places_(positions) {}

  void add_position(Vec3d position, const std::optional<ObjColour>& colour) override {
    positions.append(position);
    if (colour && !has_colours_) {
      colours.clear();  // those of ZBrush
      has_colours_ = true;
      for (std::uint64_t i = 1; i < positions.size(); ++i)
        colours.append(kNoColour);
    }
    if (has_colours_)
      colours.append(colour.value_or(kNoColour));
  }
  void add_polypaint(const ObjColour& colour) override {
    if (!has_colours_)
      colours.append(colour);
  }
  /// Returns whether colours of ZBrush count: they are those of all vertices, or of none. Asked
  /// once all is there.
  bool has_polypaint() {
    if (has_colours_ || colours.size() == 0)
      return false;
    if (colours.size() != positions.size())
      colours.clear();
    return colours.size() > 0;
  }
  Vec3d position(std::uint32_t number) override { return places_.at(number); }
  void add_texcoord(Texcoord texcoord) override { texcoords.append(texcoord); }
  void add_normal(Vec3f normal) override { normals.append(normal); }
  void use_material(const std::string& name) override {
    if (keeps_materials_)
      names.begin(name);
    begin(ObjLabel::material, name);
  }
  bool takes_groups() const override { return labels.are_asked() || objects.are_asked(); }
  void use_group(const std::string& group) override { begin(ObjLabel::group, group); }
  void use_object(const std::string& name) override { begin(ObjLabel::object, name); }
  void use_libraries(const std::string& statement) override {
    if (keeps_materials_)
      names.add_libraries(statement);
  }
  void add_triangle(const ObjTriangle& triangle) override {
    triangles.append(triangle);
    if (keeps_materials_)
      materials.append(names.use(has_texcoords(triangle)));
    if (labels.are_asked())
      combinations.append(labels.use());
  }

  MaterialNames names;
  ObjLabels labels;
  ObjObjects objects;
  storage::RecordSpool<Vec3d> positions;
  storage::RecordSpool<ObjColour> colours;  ///< none, or one a position, perhaps kNoColour
  storage::RecordSpool<Texcoord> texcoords;
  storage::RecordSpool<Vec3f> normals;
  storage::RecordSpool<ObjTriangle> triangles;
  storage::RecordSpool<std::uint32_t> materials;     ///< number in `names`, one a triangle; or none
  storage::RecordSpool<std::uint32_t> combinations;  ///< number in `labels`, likewise

 private:
  void begin(ObjLabel statement, const std::string& name) {
    labels.begin(statement, name);
    objects.begin(statement, name, triangles.size());
  }

  bool keeps_materials_;
  bool has_colours_ = false;  ///< lines v have colours
  SpoolLookup<Vec3d> places_;
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

/// Gathers the values that vertices refer to, in the vertices' order; vertices without a reference
/// get Value{}. Two sorts, however the references jump.
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

/// The square of each triangle whose material has a picture for each; 0: the whole picture, or no
/// square has one. Finds the pictures.
class TileFinder {
 public:
  TileFinder(const ObjParts& parts, ObjTextures& textures, const ImportRoom& room)
      : parts_(parts),
        textures_(textures),
        room_(room),
        texcoords_(room.scratch, kImportSpoolBytes) {}

  void find(storage::RecordSpool<std::uint32_t>& tiles) {
    gather_texcoords();
    execution::SpoolCursor triangles(parts_.triangles, room_.cancel);
    execution::SpoolCursor names(parts_.materials, room_.cancel);
    execution::SpoolCursor texcoords(texcoords_, room_.cancel);
    for (std::uint64_t i = 0; i < triangles.size(); ++i) {
      std::uint32_t tile = 0;
      if (is_tiled(names.at(i), triangles.at(i))) {
        const Texcoord a = texcoords.at(3 * i), b = texcoords.at(3 * i + 1);
        tile = find_tile(names.at(i), {a, b, texcoords.at(3 * i + 2)});
      }
      tiles.append(tile);
    }
  }

 private:
  bool is_tiled(std::uint32_t name, const ObjTriangle& triangle) const {
    return textures_.is_tiled(name) && has_texcoords(triangle);
  }

  std::uint32_t find_tile(std::uint32_t name, const std::array<Texcoord, 3>& corners) {
    const auto tile = textures_.tile_of(name, corners);
    return tile && textures_.find_picture(name, *tile) ? tile->number() : 0;
  }

  /// Gathers the coordinates of all corners, so that they come in the triangles' order.
  void gather_texcoords() {
    if (3 * parts_.triangles.size() >= UINT32_MAX) {
      mesh_io::fail_file(parts_.names.obj(),
                         "has more triangles than textures of several pictures (<UDIM>) allow");
    }
    References corners(room_.scratch, kImportSpoolBytes);
    execution::SpoolCursor triangles(parts_.triangles, room_.cancel);
    for (std::uint64_t i = 0; i < triangles.size(); ++i) {
      for (const ObjCorner& corner : triangles.at(i))
        corners.append(corner.texcoord + 1);
    }
    gather(corners, parts_.texcoords, texcoords_, room_);
  }

  const ObjParts& parts_;
  ObjTextures& textures_;
  const ImportRoom& room_;
  storage::RecordSpool<Texcoord> texcoords_;
};

/// The pictures that triangles of a textured file show.
struct ObjSurface {
  ObjSurface(std::vector<LibraryMaterial> materials, mesh_io::NamedFiles& files, RawMesh& mesh,
             const ImportRoom& room)
      : textures(std::move(materials), files, mesh.materials),
        tiles(room.scratch, kImportSpoolBytes) {}

  /// Returns the square of triangle `i`; none if its picture was not there when it was looked for.
  std::optional<PictureTile> tile(std::uint32_t name, std::uint64_t i,
                                  execution::SpoolCursor<std::uint32_t>& all_tiles) const {
    if (!textures.is_tiled(name))
      return PictureTile();
    const std::uint32_t number = all_tiles.at(i);
    return number == 0 ? std::nullopt : std::optional(PictureTile::from(number));
  }

  ObjTextures textures;
  storage::RecordSpool<std::uint32_t> tiles;  ///< one a triangle if a material has them
};

/// Returns whether a name means a material, and is not one that programs write where there is none.
bool is_name(const std::string& name) {
  const std::string small = small_letters(name);
  return !small.empty() && small != "none" && small != "(null)" && small != "null";
}

/// Returns the material of each name in `parts`.
std::vector<LibraryMaterial> find_materials(const ObjParts& parts, ObjImport& import, RawMesh& mesh,
                                            mesh_io::NamedFiles& files, const ImportRoom& room) {
  Libraries libraries =
      read_libraries(parts.names, files, mesh.materials.companions(), room.cancel);
  import.missing_libraries = libraries.missing;
  import.byte_libraries = libraries.of_bytes;
  const std::vector<MaterialNames::Use>& uses = parts.names.all();
  std::set<std::string> undefined;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const LibraryMaterial& material = libraries.materials[i];
    const bool is_undefined =
        uses[i].name && !material.is_defined && undefined.insert(*uses[i].name).second;
    import.undefined_materials += is_undefined ? 1 : 0;
    if (is_undefined && libraries.missing == 0 && is_name(*uses[i].name))
      mesh.materials.miss_material(*uses[i].name, parts.names.obj());
    import.other_alphas += material.has_other_alpha ? 1 : 0;
  }
  if (libraries.defined > 1 && !parts.names.are_used())
    mesh.materials.leave_materials(parts.names.obj());
  if (libraries.missing > 0 && import.undefined_materials > 0)
    mesh.materials.miss_library(libraries.first_missing, parts.names.obj());
  return std::move(libraries.materials);
}

/// Looks for the pictures that triangles show; none if there are none.
std::unique_ptr<ObjSurface> find_surface(const ObjParts& parts,
                                         std::vector<LibraryMaterial> materials, RawMesh& mesh,
                                         mesh_io::NamedFiles& files, const ImportRoom& room) {
  const std::vector<MaterialNames::Use>& uses = parts.names.all();
  auto surface = std::make_unique<ObjSurface>(std::move(materials), files, mesh, room);
  ObjTextures& textures = surface->textures;
  bool is_tiled = false;
  for (std::uint32_t name = 0; name < uses.size(); ++name) {
    if (!uses[name].has_texcoords)
      continue;
    if (textures.is_tiled(name))
      is_tiled = true;
    else
      textures.find_picture(name, {});
  }
  if (is_tiled)
    TileFinder(parts, textures, room).find(surface->tiles);
  return textures.has_pictures() ? std::move(surface) : nullptr;
}

/// The colours that materials have in a file without pictures.
class ObjPaint {
 public:
  explicit ObjPaint(const std::vector<LibraryMaterial>& materials) {
    for (const LibraryMaterial& material : materials) {
      of_names_.push_back({PlainColour::of(material.material), material.is_defined});
      all_.add(of_names_.back().colour);
    }
  }

  bool is_seen() const { return all_.are_seen(); }
  std::size_t count() const { return all_.count(); }

  /// Returns CornerParts::kMaterial of a triangle of that name; 0 if nobody says its colour.
  std::uint32_t part(std::uint32_t name) const {
    return of_names_[name].is_defined ? of_names_[name].colour.number() + 1 : 0;
  }
  /// Returns the colour of a vertex with that part.
  static PlainColour colour(std::uint32_t part) {
    return part == 0 ? PlainColour() : PlainColour::from(part - 1);
  }

 private:
  struct Named {
    PlainColour colour;
    bool is_defined = false;
  };
  std::vector<Named> of_names_;
  PlainColours all_;
};

/// The look of a file's materials: pictures, their colours, or nothing.
struct ObjLook {
  std::unique_ptr<ObjSurface> surface;
  std::optional<ObjPaint> paint;
};

ObjLook find_look(const ObjParts& parts, ObjImport& import, RawMesh& mesh,
                  mesh_io::NamedFiles& files, const ImportRoom& room) {
  const bool all_have_colours = import.counts.coloured == import.counts.positions;
  ObjLook look;
  if (!import.layout.texcoords && (all_have_colours || !parts.names.are_any()))
    return look;
  std::vector<LibraryMaterial> materials = find_materials(parts, import, mesh, files, room);
  ObjPaint paint(materials);
  if (import.layout.texcoords)
    look.surface = find_surface(parts, std::move(materials), mesh, files, room);
  // Beside colours of vertices, one shade of grey is one as well.
  if (!look.surface && !all_have_colours && (import.counts.coloured > 0 || paint.is_seen()))
    look.paint = std::move(paint);
  return look;
}

/// Triangles of a textured file with what they show, from the first on.
class ShownTriangles {
 public:
  ShownTriangles(const ObjParts& parts, ObjSurface& surface, const ImportRoom& room)
      : surface_(surface),
        triangles_(parts.triangles, room.cancel),
        names_(parts.materials, room.cancel),
        tiles_(surface.tiles, room.cancel) {}

  std::uint64_t count() const { return triangles_.size(); }
  const ObjTriangle& triangle(std::uint64_t i) { return triangles_.at(i); }
  ObjTextures::Shown shown(std::uint64_t i) {
    const std::uint32_t name = names_.at(i);
    const auto tile =
        has_texcoords(triangles_.at(i)) ? surface_.tile(name, i, tiles_) : std::nullopt;
    return surface_.textures.show(name, tile);
  }

 private:
  ObjSurface& surface_;
  execution::SpoolCursor<ObjTriangle> triangles_;
  execution::SpoolCursor<std::uint32_t> names_, tiles_;
};

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

/// CornerParts::kValues of the corners of triangles, which come in their order.
class CornerLabels {
 public:
  CornerLabels(const ObjParts& parts, const ImportRoom& room)
      : combinations_(parts.combinations, room.cancel) {}

  std::uint32_t part(std::uint64_t triangle) {
    return combinations_.size() == 0 ? 0 : combinations_.at(triangle);
  }

 private:
  execution::SpoolCursor<std::uint32_t> combinations_;
};

/// Adds the corners of triangles with their materials. Triangles without a picture whose corners
/// all have colours that tint get a white one.
void add_shown_corners(const ObjParts& parts, ObjSurface& surface, bool tint, RawMesh& mesh,
                       CornerSplitter& splitter, const ImportRoom& room) {
  ShownTriangles triangles(parts, surface, room);
  std::optional<CornerColours> colours;
  if (tint)
    colours.emplace(parts);
  CornerLabels labels(parts, room);
  std::optional<std::uint32_t> white;
  for (std::uint64_t i = 0; i < triangles.count(); ++i) {
    const ObjTriangle& triangle = triangles.triangle(i);
    ObjTextures::Shown shown = triangles.shown(i);
    if (tint && !shown.has_picture && colours->count(triangle) == triangle.size()) {
      if (!white)
        white = mesh.materials.add({});
      shown.number = *white;
    }
    // kNone + 1 is 0.
    for (const ObjCorner& c : triangle) {
      splitter.add({c.position,
                    {shown.has_picture ? c.texcoord + 1 : 0, c.normal + 1, labels.part(i),
                     shown.number + 1}});
    }
  }
}

void add_plain_corners(const ObjParts& parts, const std::optional<ObjPaint>& paint,
                       CornerSplitter& splitter, const ImportRoom& room) {
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  execution::SpoolCursor names(parts.materials, room.cancel);
  CornerLabels labels(parts, room);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t material = paint ? paint->part(names.at(i)) : 0;
    for (const ObjCorner& c : triangles.at(i))
      splitter.add({c.position, {c.texcoord + 1, c.normal + 1, labels.part(i), material}});
  }
}

/// The vertex's own one, else that of a material (ObjPaint::part), as the file's own are; false if
/// there is none, which is white.
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

void append_vertices(ObjParts& parts, const SplitVertices& vertices, const ObjLook& look,
                     ObjImport& import, RawMesh& mesh, const ImportRoom& room) {
  const AttributeLayout& layout = import.layout;
  storage::RecordSpool<Texcoord> texcoords(room.scratch, kImportSpoolBytes);
  storage::RecordSpool<Vec3f> normals(room.scratch, kImportSpoolBytes);
  if (layout.texcoords)
    gather(vertices.parts[kTexcoord], parts.texcoords, texcoords, room);
  if (layout.normals)
    gather(vertices.parts[kNormal], parts.normals, normals, room);
  execution::SpoolCursor places(vertices.positions, room.cancel);
  execution::SpoolCursor positions(parts.positions, room.cancel);
  execution::SpoolCursor colours(parts.colours, room.cancel);
  execution::SpoolCursor all_texcoords(texcoords, room.cancel);
  execution::SpoolCursor all_normals(normals, room.cancel);
  execution::SpoolCursor shown(vertices.parts[kTexcoord], room.cancel);
  execution::SpoolCursor materials(vertices.parts[CornerParts::kMaterial], room.cancel);
  execution::SpoolCursor combinations(vertices.parts[CornerParts::kValues], room.cancel);
  for (std::uint64_t i = 0; i < vertices.count(); ++i) {
    const std::uint32_t position = places.at(i);
    mesh.positions.append(positions.at(position));
    if (layout.normals) {
      const Vec3f n = all_normals.at(i);
      mesh.attributes.append(std::array{n.x, n.y, n.z});
    }
    if (layout.colour == PlainColours::kType) {
      mesh.attributes.append(ObjPaint::colour(materials.at(i)).values());
    } else if (layout.has_colours()) {
      const std::uint32_t paint = look.paint ? materials.at(i) : 0;
      const bool is_coloured = append_colour(colours.at(position), paint, mesh);
      import.filled_colours += is_coloured || layout.material ? 0 : 1;
      const bool is_plain = layout.material && materials.at(i) > 0 && shown.at(i) == 0;
      import.hidden_colours += is_coloured && is_plain && !layout.tints ? 1 : 0;
    }
    mesh.attributes.append(parts.labels.channels(combinations.at(i)));
    if (layout.texcoords && !layout.material)
      mesh.attributes.append(all_texcoords.at(i));
    if (layout.material) {
      // A position that no triangle uses has no material: any will do.
      const std::uint32_t material = std::max(materials.at(i), std::uint32_t{1}) - 1;
      const Vec2f at = shown.at(i) == 0
                           ? Vec2f{}
                           : look.surface->textures.texcoord(material, all_texcoords.at(i));
      mesh.attributes.append(std::array{at.u, at.v, static_cast<float>(material)});
    }
  }
}

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
void append_split(ObjParts& parts, const ObjLook& look, ObjImport& import, RawMesh& mesh,
                  const ImportRoom& room) {
  SplitVertices vertices(room.scratch);
  CornerSplitter splitter(parts.positions.size(), room);
  if (look.surface) {
    import.layout.tints = import.counts.coloured > 0 && do_colours_tint(parts, *look.surface, room);
    add_shown_corners(parts, *look.surface, import.layout.tints, mesh, splitter, room);
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
  append_vertices(parts, vertices, look, import, mesh, room);
  import.split_vertices = vertices.count() - parts.positions.size();
  import.filled_texcoords = import.layout.texcoords ? vertices.without[kTexcoord] : 0;
  import.filled_normals = import.layout.normals ? vertices.without[kNormal] : 0;
}

mesh_io::ObjCounts read_parts(mesh_io::InputStream& stream, const std::filesystem::path& path,
                              ObjParts& parts, const ImportRoom& room) {
  mesh_io::ObjReader reader(path, parts);
  return read_text_blocks<mesh_io::ObjBlock>(mesh_io::LineBlocks(stream), mesh_io::kObjBlockBytes,
                                             mesh_io::parse, reader, room);
}

}  // namespace

ObjImport import_obj(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     mesh_io::NamedFiles& files, Textures textures,
                     const mesh_io::AttributeChoice& attributes, const ImportRoom& room) {
  ObjParts parts(room.scratch, path, textures, attributes, mesh);
  ObjImport import;
  import.counts = read_parts(stream, path, parts, room);
  parts.objects.finish(parts.triangles.size());
  import.fits_float = import.counts.fits_float;
  import.layout.texcoords = import.counts.textured_corners > 0;
  import.layout.normals = import.counts.normal_corners > 0;
  import.layout.values = parts.labels.attributes();
  if (parts.has_polypaint())
    import.counts.coloured = import.counts.positions;
  else
    import.ignored_polypaint = import.counts.painted;
  if (import.counts.coloured > 0)
    import.layout.colour = ColourType::f32;
  ObjLook look;
  if (textures == Textures::use)
    look = find_look(parts, import, mesh, files, room);
  import.layout.material = look.surface != nullptr;
  if (look.paint) {
    import.is_painted = !import.layout.has_colours();
    if (import.is_painted)
      import.layout.colour = PlainColours::kType;
    import.material_colours = look.paint->count();
  }
  if (import.layout.texcoords || import.layout.normals || look.paint ||
      !import.layout.values.empty())
    append_split(parts, look, import, mesh, room);
  else
    import.filled_colours = append_plain(parts, mesh, room);
  return import;
}

}  // namespace meshhier::importing
