#include "import/ply_import.h"

#include "execution/spool_cursor.h"
#include "import/split_corners.h"
#include "mesh_io/polygon_cut.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

// CornerParts::parts of a PLY file.
constexpr std::size_t kU = 0;  ///< its bits
constexpr std::size_t kV = 1;

using Texcoord = std::array<float, 2>;

struct TexturedTriangle {
  Triangle<std::uint32_t> corners;
  std::int32_t texture;  ///< -1: none
};

/// Of a corner; none if they are not finite.
std::optional<Texcoord> texcoord_of(const mesh_io::PlyFace& face, std::size_t corner) {
  const Texcoord at{face.texcoords[2 * corner], face.texcoords[2 * corner + 1]};
  return std::isfinite(at[0]) && std::isfinite(at[1]) ? std::optional(at) : std::nullopt;
}

/// The triangles of a file.
struct PlyTriangles {
  explicit PlyTriangles(storage::ScratchFile& scratch)
      : all(scratch, kImportSpoolBytes), texcoords(scratch, kImportSpoolBytes) {}

  storage::RecordSpool<TexturedTriangle> all;
  storage::RecordSpool<std::array<Texcoord, 3>> texcoords;  ///< of each, if faces have their own
  std::set<std::int32_t> textures;
};

class PlyImporter {
 public:
  PlyImporter(mesh_io::PlySource& source, const std::filesystem::path& path, RawMesh& mesh,
              mesh_io::NamedFiles& files, const ImportRoom& room)
      : source_(source),
        path_(path),
        mesh_(mesh),
        files_(files),
        room_(room),
        triangles_(room.scratch),
        given_(source.description().attributes) {}

  PlyImport run() {
    const mesh_io::FaceCounts read =
        source_.read_textured_faces([this](const mesh_io::PlyFace& face) { add(face); });
    import_.counts.faces = read.faces;
    import_.counts.degenerate_triangles += read.degenerate_triangles;
    if (find_pictures())
      append_textured();
    else
      append_plain();
    return import_;
  }

 private:
  /// Polygons become triangles, as mesh_io::TriangleBlocks makes them.
  void add(const mesh_io::PlyFace& face) {
    room_.cancel.check();
    const bool has_texcoords = !source_.has_face_texcoords() || !face.texcoords.empty();
    const std::int32_t texture = has_texcoords ? face.texture : -1;
    for (std::size_t i = 0; i < face.texcoords.size() / 2; ++i)
      import_.zeroed.texcoords += texcoord_of(face, i) ? 0 : 1;
    import_.counts.degenerate_triangles += face.corners.size() < 3 ? 1 : 0;
    cut_.for_each_triangle(
        face.corners.size(), [&](std::size_t i) { return source_.place_of(face.corners[i]); },
        import_.counts.polygons,
        [&](std::size_t i, std::size_t j, std::size_t k) {
          add(face, {i, j, k}, texture);
        });
  }

  void add(const mesh_io::PlyFace& face, const std::array<std::size_t, 3>& corners,
           std::int32_t texture) {
    TexturedTriangle triangle{{}, texture};
    std::array<Texcoord, 3> texcoords{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = face.corners[corners[k]];
      if (!face.texcoords.empty())
        texcoords[k] = texcoord_of(face, corners[k]).value_or(Texcoord{});
    }
    if (is_degenerate(triangle.corners)) {
      ++import_.counts.degenerate_triangles;
      return;
    }
    ++import_.counts.triangles;
    triangles_.all.append(triangle);
    if (source_.has_face_texcoords())
      triangles_.texcoords.append(texcoords);
    triangles_.textures.insert(texture);
  }

  /// Of the textures that triangles use; false if none is there.
  bool find_pictures() {
    const std::vector<std::string>& names = source_.texture_files();
    pictures_.resize(names.size());
    for (const std::int32_t texture : triangles_.textures) {
      if (texture < 0)
        continue;
      const auto i = static_cast<std::size_t>(texture);
      const std::filesystem::path folder = path_.parent_path();
      pictures_[i] = files_.find(folder, names[i]);
      if (!pictures_[i]) {
        mesh_.materials.miss(names[i], path_.string(), mesh_io::sought_places(folder, names[i]));
      }
    }
    return std::ranges::any_of(pictures_, [](const auto& picture) { return picture.has_value(); });
  }

  /// The number of a texture's material in the table, from 1 on.
  std::uint32_t material_of(std::int32_t texture) {
    std::uint32_t& number = numbers_[static_cast<std::size_t>(texture + 1)];
    if (number > 0)
      return number;
    images::Material material;
    if (texture >= 0) {
      const auto i = static_cast<std::size_t>(texture);
      material.name = source_.texture_files()[i];
      if (pictures_[i])
        material.image = mesh_.materials.add_picture({material.name, *pictures_[i]});
    }
    number = mesh_.materials.add(std::move(material)) + 1;
    return number;
  }

  bool has_picture(std::int32_t texture) const {
    return texture >= 0 && pictures_[static_cast<std::size_t>(texture)];
  }

  void append_textured() {
    numbers_.resize(pictures_.size() + 1);
    CornerSplitter splitter(room_);
    add_corners(splitter);
    triangles_.all.clear();
    triangles_.texcoords.clear();
    SplitVertices vertices(room_.scratch);
    splitter.split(source_.description().vertex_count, vertices, mesh_);
    import_.split_vertices = vertices.count() - source_.description().vertex_count;
    import_.layout = given_.without_texcoords();
    import_.layout.texcoords = import_.layout.material = true;
    append_vertices(vertices);
  }

  void add_corners(CornerSplitter& splitter) {
    execution::SpoolCursor triangles(triangles_.all, room_.cancel);
    execution::SpoolCursor texcoords(triangles_.texcoords, room_.cancel);
    for (std::uint64_t i = 0; i < triangles.size(); ++i) {
      const auto& [corners, texture] = triangles.at(i);
      const std::uint32_t material = material_of(texture);
      const bool has_own = source_.has_face_texcoords() && has_picture(texture);
      for (std::size_t k = 0; k < 3; ++k) {
        const Texcoord at = has_own ? texcoords.at(i)[k] : Texcoord{};
        splitter.add(
            {corners[k],
             {std::bit_cast<std::uint32_t>(at[0]), std::bit_cast<std::uint32_t>(at[1]), material}});
      }
    }
  }

  void append_vertices(const SplitVertices& vertices) {
    execution::SpoolCursor positions(vertices.positions, room_.cancel);
    std::array<execution::SpoolCursor<std::uint32_t>, CornerParts::kCount> parts{
        {{vertices.parts[kU], room_.cancel},
         {vertices.parts[kV], room_.cancel},
         {vertices.parts[CornerParts::kMaterial], room_.cancel}}};
    const auto channels = static_cast<std::size_t>(given_.channels());
    std::uint64_t next = 0;
    read_vertices([&](std::uint64_t vertex, Vec3d position, std::span<const float> attributes) {
      for (; next < vertices.count() && positions.at(next) == vertex; ++next) {
        mesh_.positions.append(position);
        append_attributes(attributes.first(channels), parts[kU].at(next), parts[kV].at(next),
                          parts[CornerParts::kMaterial].at(next));
      }
    });
  }

  void append_attributes(std::span<const float> given, std::uint32_t u, std::uint32_t v,
                         std::uint32_t part) {
    const auto texcoord = static_cast<std::size_t>(given_.texcoord_offset());
    mesh_.attributes.append(given.first(texcoord));
    // A vertex that no triangle uses has no material: any will do.
    const std::uint32_t material = std::max(part, std::uint32_t{1}) - 1;
    std::array<float, 3> shown{0, 0, static_cast<float>(material)};
    if (part > 0 && mesh_.materials.list().materials[material].image) {
      const Texcoord at = source_.has_face_texcoords()
                              ? Texcoord{std::bit_cast<float>(u), std::bit_cast<float>(v)}
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
    source_.read_vertices([&](const mesh_io::VertexBlock& block) {
      room_.cancel.check();
      import_.zeroed += block.zeroed;
      const std::size_t count = block.positions.size() + block.exact.size();
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3d position = block.exact.empty() ? to_double(block.positions[i]) : block.exact[i];
        import_.fits_float = import_.fits_float && (block.exact.empty() || fits_float(position));
        take(block.first + i, position, block.attributes.subspan(i * channels, channels));
      }
    });
  }

  void append_plain() {
    const std::uint64_t base = mesh_.vertex_count();
    import_.layout = given_;
    read_vertices([&](std::uint64_t, Vec3d position, std::span<const float> attributes) {
      mesh_.positions.append(position);
      mesh_.attributes.append(attributes);
    });
    execution::SpoolCursor triangles(triangles_.all, room_.cancel);
    for (std::uint64_t i = 0; i < triangles.size(); ++i) {
      Triangle<std::uint32_t> t = triangles.at(i).corners;
      for (std::uint32_t& corner : t)
        corner = static_cast<std::uint32_t>(base + corner);
      mesh_.triangles.append(t);
    }
  }

  mesh_io::PlySource& source_;
  const std::filesystem::path& path_;
  RawMesh& mesh_;
  mesh_io::NamedFiles& files_;
  const ImportRoom& room_;
  PlyTriangles triangles_;
  AttributeLayout given_;
  mesh_io::PolygonCut cut_;
  std::vector<Vec3d> places_;                                   ///< of a face
  std::vector<std::optional<std::filesystem::path>> pictures_;  ///< of each texture
  std::vector<std::uint32_t> numbers_;  ///< of each texture from -1 on; 0: not used yet
  PlyImport import_;
};

}  // namespace

PlyImport import_textured_ply(mesh_io::PlySource& source, const std::filesystem::path& path,
                              RawMesh& mesh, mesh_io::NamedFiles& files, const ImportRoom& room) {
  return PlyImporter(source, path, mesh, files, room).run();
}

}  // namespace meshhier::importing
