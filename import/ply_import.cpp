#include "import/ply_import.h"

#include "base/plain_text.h"
#include "execution/spool_cursor.h"
#include "import/append_mesh.h"
#include "import/crop_mesh.h"
#include "import/face_colours.h"
#include "import/face_values.h"
#include "import/place_vertices.h"
#include "import/ply_pictures.h"
#include "import/ply_texture_faces.h"
#include "import/split_corners.h"
#include "import/text_blocks.h"
#include "mesh_io/input_error.h"
#include "mesh_io/ply_lines.h"
#include "mesh_io/polygon_cut.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

// CornerParts::parts of a PLY file that shows pictures.
constexpr std::size_t kU = 0;  ///< its bits
constexpr std::size_t kV = 1;

using Texcoord = std::array<float, 2>;
using mesh_io::PlyTexcoords;

struct FaceTriangle {
  Triangle<std::uint32_t> corners;
  std::int32_t texture;  ///< -1: none
};

/// Returns a corner's coordinates; none if they are not finite.
std::optional<Texcoord> texcoord_of(const mesh_io::PlyFace& face, std::size_t corner) {
  const Texcoord at{face.texcoords[2 * corner], face.texcoords[2 * corner + 1]};
  return std::isfinite(at[0]) && std::isfinite(at[1]) ? std::optional(at) : std::nullopt;
}

/// The triangles of a file.
struct PlyTriangles {
  explicit PlyTriangles(storage::ScratchFile& scratch)
      : all(scratch, kImportSpoolBytes),
        texcoords(scratch, kImportSpoolBytes),
        colours(scratch, kImportSpoolBytes) {}

  void clear() {
    all.clear();
    texcoords.clear();
    colours.clear();
  }

  storage::RecordSpool<FaceTriangle> all;
  /// One for each triangle, if faces have their own.
  storage::RecordSpool<std::array<Texcoord, 3>> texcoords;
  storage::RecordSpool<FaceColour> colours;  ///< one for each triangle, if faces have colours
  std::set<std::int32_t> textures;
};

/// Notes what a block of vertices tells of the file.
void note_block(const mesh_io::VertexBlock& block, const std::filesystem::path& path,
                AddedFile& added) {
  added.fits_float = added.fits_float && block.fits_float();
  count_unplaced(block, path, added.unplaced);
  added.count(block.zeroed);
}

void note_faces(const mesh_io::FaceCounts& counts, AddedFile& added) {
  added.faces = counts.faces;
  added.degenerate_triangles = counts.degenerate_triangles;
  added.count(counts.polygons);
}

void append_blocks(mesh_io::PlySource& source, const std::filesystem::path& path, RawMesh& mesh,
                   AddedFile& added, const ImportRoom& room) {
  added.layout = source.description().attributes;
  source.read_vertices(
      [&](const mesh_io::VertexBlock& block) {
        room.cancel.check();
        for (const Vec3f& p : block.positions)
          mesh.positions.append(to_double(p));
        mesh.positions.append(block.exact);
        mesh.attributes.append(block.attributes);
        note_block(block, path, added);
      },
      parallel_blocks(mesh_io::kPlyLinesBytes, room));
}

/// Appends a file whose corners have no attributes of their own.
AddedFile append_whole(mesh_io::PlySource& source, const std::filesystem::path& path,
                       std::uint32_t base, RawMesh& mesh, const ImportRoom& room) {
  AddedFile added;
  append_blocks(source, path, mesh, added, room);
  const auto take = [&](std::span<const Triangle<VertexId>> triangles) {
    room.cancel.check();
    append_triangles(triangles, base, mesh);
  };
  note_faces(source.read_triangles(take, parallel_blocks(mesh_io::kPlyLinesBytes, room)), added);
  return added;
}

/// Appends the piece near a box of a file that is read in place.
AddedFile append_piece(mesh_io::PlySource& source, const std::filesystem::path& path,
                       const BoundsD& box, RawMesh& mesh, const ImportRoom& room) {
  AddedFile added{.layout = source.description().attributes};
  const std::uint64_t before = mesh.triangles.size();
  const mesh_io::FaceCounts counts = append_near(
      source, box, mesh, [&](const mesh_io::VertexBlock& block) { note_block(block, path, added); },
      room);
  added.near_apart = counts.triangles - (mesh.triangles.size() - before);
  note_faces(counts, added);
  return added;
}

/// Imports a file whose faces have attributes.
class PlyImporter {
 public:
  PlyImporter(mesh_io::PlySource& source, const std::filesystem::path& path, Textures textures,
              RawMesh& mesh, mesh_io::NamedFiles& files, const ImportRoom& room)
      : source_(source),
        plan_(source.plan()),
        path_(path),
        mesh_(mesh),
        files_(files),
        room_(room),
        texcoords_(textures == Textures::use ? plan_.texcoords : PlyTexcoords::none),
        white_(white_face(plan_.face_colour)),
        triangles_(room.scratch),
        values_(plan_.face_values, room),
        given_(source.description().attributes) {}

  AddedFile run() {
    if (texcoords_ == PlyTexcoords::of_texture_faces)
      texture_faces_.emplace(source_, path_, room_);
    const mesh_io::FaceCounts read =
        source_.read_faces([this](const mesh_io::PlyFace& face) { add(face); });
    texture_faces_.reset();
    counts_.faces = read.faces;
    counts_.degenerate_triangles += read.degenerate_triangles;
    if (texcoords_ != PlyTexcoords::none)
      pictures_.emplace(plan_, path_, triangles_.textures, files_, mesh_.materials);
    is_textured_ = pictures_ && pictures_->any_is_there();
    if (is_textured_ || has_colours() || values_.any())
      append_cornered();
    else
      append_plain();
    note_faces(counts_, added_);
    added_.count(zeroed_);
    added_.count(kHiddenColours, hidden_colours_);
    return added_;
  }

 private:
  bool has_own_texcoords() const {
    return texcoords_ == PlyTexcoords::of_faces || texcoords_ == PlyTexcoords::of_texture_faces;
  }
  bool has_colours() const { return plan_.face_colour != ColourType::none; }

  void add(const mesh_io::PlyFace& face) {
    room_.cancel.check();
    if (texture_faces_) {
      shown_ = face;
      texture_faces_->complete(shown_);
      cut(shown_);
    } else {
      cut(face);
    }
  }

  /// Polygons become triangles, as mesh_io::TriangleBlocks makes them.
  void cut(const mesh_io::PlyFace& face) {
    const bool has_texcoords = !has_own_texcoords() || !face.texcoords.empty();
    const std::int32_t texture = has_texcoords ? face.texture : -1;
    for (std::size_t i = 0; i < face.texcoords.size() / 2; ++i)
      zeroed_.texcoords += texcoord_of(face, i) ? 0 : 1;
    counts_.degenerate_triangles += face.corners.size() < 3 ? 1 : 0;
    cut_.for_each_triangle(
        face.corners.size(), [&](std::size_t i) { return source_.place_of(face.corners[i]); },
        counts_.polygons,
        [&](std::size_t i, std::size_t j, std::size_t k) {
          add(face, {i, j, k}, texture);
        });
  }

  void add(const mesh_io::PlyFace& face, const std::array<std::size_t, 3>& corners,
           std::int32_t texture) {
    FaceTriangle triangle{{}, texture};
    std::array<Texcoord, 3> texcoords{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = face.corners[corners[k]];
      if (!face.texcoords.empty())
        texcoords[k] = texcoord_of(face, corners[k]).value_or(Texcoord{});
    }
    if (is_degenerate(triangle.corners)) {
      ++counts_.degenerate_triangles;
      return;
    }
    ++counts_.triangles;
    triangles_.all.append(triangle);
    if (has_own_texcoords())
      triangles_.texcoords.append(texcoords);
    if (has_colours())
      triangles_.colours.append(face.row ? face.colour : white_);
    values_.add(face.values);
    triangles_.textures.insert(texture);
  }

  /// Pictures count instead of colours.
  ColourType face_colour() const { return is_textured_ ? ColourType::none : plan_.face_colour; }

  /// Corners that show something else than others at their vertex become vertices.
  void append_cornered() {
    values_.compare();
    CornerSplitter splitter(source_.description().vertex_count, room_);
    is_textured_ ? add_shown_corners(splitter) : add_corners(splitter);
    AttributeLayout& layout = added_.layout = given_;
    if (is_textured_)
      layout.texcoords = layout.material = true;
    if (face_colour() != ColourType::none) {
      layout.colour = plan_.face_colour;
      layout.alpha = plan_.face_alpha;
    }
    layout.values.insert(layout.values.end(), plan_.face_values.begin(), plan_.face_values.end());
    append_split(splitter);
  }

  void add_corners(CornerSplitter& splitter) {
    execution::SpoolCursor triangles(triangles_.all, room_.cancel);
    execution::SpoolCursor colours(triangles_.colours, room_.cancel);
    for (std::uint64_t i = 0; i < triangles.size(); ++i) {
      CornerParts::Parts parts{};
      if (has_colours())
        parts = parts_of(colours.at(i), plan_.face_colour);
      parts[CornerParts::kValues] = values_.number_of(i);
      for (const std::uint32_t corner : triangles.at(i).corners)
        splitter.add({corner, parts});
    }
  }

  void add_shown_corners(CornerSplitter& splitter) {
    execution::SpoolCursor triangles(triangles_.all, room_.cancel);
    execution::SpoolCursor texcoords(triangles_.texcoords, room_.cancel);
    for (std::uint64_t i = 0; i < triangles.size(); ++i) {
      const auto& [corners, texture] = triangles.at(i);
      const std::uint32_t material = pictures_->material_of(texture, mesh_.materials) + 1;
      const std::uint32_t values = values_.number_of(i);
      const bool has_own = has_own_texcoords() && pictures_->is_there(texture);
      for (std::size_t k = 0; k < 3; ++k) {
        const Texcoord at = has_own ? texcoords.at(i)[k] : Texcoord{};
        splitter.add({corners[k],
                      {std::bit_cast<std::uint32_t>(at[0]), std::bit_cast<std::uint32_t>(at[1]),
                       values, material}});
      }
    }
  }

  void append_split(CornerSplitter& splitter) {
    triangles_.clear();
    SplitVertices vertices(room_.scratch);
    splitter.split(vertices, mesh_);
    tell_of_split(vertices.count());
    SplitCursor split(vertices, room_.cancel);
    std::uint64_t next = 0;
    read_vertices([&](std::uint64_t vertex, Vec3d position, std::span<const float> attributes) {
      for (; next < split.size() && split.position(next) == vertex; ++next) {
        mesh_.positions.append(position);
        append_attributes(attributes, split.parts(next));
      }
    });
  }

  /// Warns if nearly each face has values of its own: each vertex becomes about six then.
  void tell_of_split(std::uint64_t vertices) {
    const std::uint64_t given = source_.description().vertex_count;
    added_.count("split_vertices", vertices - given);
    if (plan_.face_values.empty() || vertices - given <= given)
      return;
    added_.warnings.push_back(mesh_io::file_message(
        path_,
        fmt::format("values of faces make {} of {}, and the hierarchy larger; \"attributes\" "
                    "of the config chooses which are read",
                    counted(vertices, "vertices"), given)));
  }

  /// Appends attributes part by part, as AttributeLayout has them.
  void append_attributes(std::span<const float> given, const CornerParts::Parts& parts) {
    const auto colours = given_.part(AttributeKind::colours).first;
    const auto texcoords = given_.part(AttributeKind::texcoords).first;
    mesh_.attributes.append(given.first(colours));
    if (face_colour() != ColourType::none) {
      const FaceColour colour = colour_of(parts, plan_.face_colour);
      mesh_.attributes.append(
          std::span(colour).first(added_.layout.part(AttributeKind::colours).count));
    }
    mesh_.attributes.append(given.subspan(colours, texcoords - colours));
    mesh_.attributes.append(values_.channels(parts[CornerParts::kValues]));
    if (is_textured_)
      append_shown(given, parts);
    else
      mesh_.attributes.append(given.subspan(texcoords));
  }

  void append_shown(std::span<const float> given, const CornerParts::Parts& parts) {
    // A vertex that no triangle uses has no material: any will do.
    const std::uint32_t part = parts[CornerParts::kMaterial];
    const std::uint32_t material = std::max(part, std::uint32_t{1}) - 1;
    std::array<float, 3> shown{0, 0, static_cast<float>(material)};
    const bool shows_picture = part > 0 && mesh_.materials.list().materials[material].image;
    if (part > 0 && !shows_picture && given_.has_colours())
      ++hidden_colours_;
    if (shows_picture) {
      const auto texcoord = given_.part(AttributeKind::texcoords).first;
      const Texcoord at = has_own_texcoords() ? Texcoord{std::bit_cast<float>(parts[kU]),
                                                         std::bit_cast<float>(parts[kV])}
                                              : Texcoord{given[texcoord], given[texcoord + 1]};
      shown[0] = at[0];
      shown[1] = static_cast<float>(1 - double{at[1]});
    }
    mesh_.attributes.append(shown);
  }

  /// Calls take(number, position, attributes) for each vertex of the file.
  template <class Take>
  void read_vertices(const Take& take) {
    const auto channels = static_cast<std::size_t>(given_.channels());
    source_.read_vertices(
        [&](const mesh_io::VertexBlock& block) {
          room_.cancel.check();
          note_block(block, path_, added_);
          const std::size_t count = block.positions.size() + block.exact.size();
          for (std::size_t i = 0; i < count; ++i) {
            const Vec3d position =
                block.exact.empty() ? to_double(block.positions[i]) : block.exact[i];
            take(block.first + i, position, block.attributes.subspan(i * channels, channels));
          }
        },
        parallel_blocks(mesh_io::kPlyLinesBytes, room_));
  }

  void append_plain() {
    const std::uint64_t base = mesh_.vertex_count();
    append_blocks(source_, path_, mesh_, added_, room_);
    execution::SpoolCursor triangles(triangles_.all, room_.cancel);
    for (std::uint64_t i = 0; i < triangles.size(); ++i) {
      Triangle<std::uint32_t> t = triangles.at(i).corners;
      for (std::uint32_t& corner : t)
        corner = static_cast<std::uint32_t>(base + corner);
      mesh_.triangles.append(t);
    }
  }

  mesh_io::PlySource& source_;
  const mesh_io::PlyPlan& plan_;
  const std::filesystem::path& path_;
  RawMesh& mesh_;
  mesh_io::NamedFiles& files_;
  const ImportRoom& room_;
  PlyTexcoords texcoords_;
  FaceColour white_;  ///< the colour of strips
  PlyTriangles triangles_;
  FaceValues values_;
  AttributeLayout given_;
  mesh_io::PolygonCut cut_;
  std::optional<PlyTextureFaces> texture_faces_;
  mesh_io::PlyFace shown_;  ///< a face with the places of its texture face
  std::optional<PlyPictures> pictures_;
  bool is_textured_ = false;  ///< a picture is there
  mesh_io::FaceCounts counts_;
  mesh_io::ZeroedCounts zeroed_;  ///< of polygons' corners
  std::uint64_t hidden_colours_ = 0;
  AddedFile added_;
};

}  // namespace

AddedFile import_ply(mesh_io::PlySource& source, const std::filesystem::path& path,
                     const PlyUse& use, RawMesh& mesh, mesh_io::NamedFiles& files,
                     const ImportRoom& room) {
  const mesh_io::MeshDescription& description = source.description();
  const std::uint32_t base = next_vertex(mesh, path, description.vertex_count);
  const bool is_piece = use.crop && description.vertices_in_place && description.face_count > 0;
  AddedFile added = has_corner_attributes(source.plan(), use.textures)
                        ? PlyImporter(source, path, use.textures, mesh, files, room).run()
                    : is_piece ? append_piece(source, path, *use.crop, mesh, room)
                               : append_whole(source, path, base, mesh, room);
  added.count(source.odd_syntax());
  return added;
}

}  // namespace meshhier::importing
