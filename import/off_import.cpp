#include "import/off_import.h"

#include "execution/spool_cursor.h"
#include "import/append_mesh.h"
#include "import/face_colours.h"
#include "import/place_lookup.h"
#include "import/split_corners.h"
#include "import/text_blocks.h"
#include "mesh_io/off_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::importing {
namespace {

/// A number that a face does not have: white, or opaque.
constexpr float kFull = std::numeric_limits<float>::quiet_NaN();

/// A file as it is.
struct OffParts {
  explicit OffParts(storage::ScratchFile& scratch)
      : positions(scratch, kImportSpoolBytes),
        attributes(scratch, kImportSpoolBytes),
        triangles(scratch, kImportSpoolBytes),
        colours(scratch, kImportSpoolBytes) {}

  storage::RecordSpool<Vec3d> positions;
  storage::RecordSpool<float> attributes;
  storage::RecordSpool<Triangle<VertexId>> triangles;
  /// Colours of triangles, as far as there are any; or kFull.
  storage::RecordSpool<FaceColour> colours;
};

/// Collects the colours of faces.
class FaceColours {
 public:
  explicit FaceColours(OffParts& parts) : parts_(parts) {}

  /// `triangles`: of all faces so far.
  void add(std::uint64_t triangles, const std::optional<mesh_io::OffColour>& given) {
    FaceColour colour{kFull, kFull, kFull, kFull};
    if (given) {
      std::ranges::copy_n(given->numbers.begin(), given->has_alpha ? 4 : 3, colour.begin());
      are_bytes_ = are_bytes_ && given->are_bytes;
      has_alpha_ = has_alpha_ || given->has_alpha;
      append_until(known_, {kFull, kFull, kFull, kFull});
      ++coloured_;
    } else {
      ++plain_;
    }
    if (coloured_ > 0)
      append_until(triangles, colour);
    known_ = triangles;
  }

  std::uint64_t coloured() const { return coloured_; }
  std::uint64_t plain() const { return plain_; }
  ColourType type() const { return are_bytes_ ? ColourType::u8 : ColourType::f32; }
  bool has_alpha() const { return has_alpha_ && are_bytes_; }

 private:
  void append_until(std::uint64_t triangles, const FaceColour& colour) {
    while (parts_.colours.size() < triangles)
      parts_.colours.append(colour);
  }

  OffParts& parts_;
  std::uint64_t known_ = 0;  ///< triangles of the faces so far
  std::uint64_t coloured_ = 0, plain_ = 0;
  bool are_bytes_ = true, has_alpha_ = false;
};

void append_plain(const OffParts& parts, RawMesh& mesh, const ImportRoom& room) {
  const auto base = static_cast<std::uint32_t>(mesh.vertex_count());
  execution::SpoolCursor positions(parts.positions, room.cancel);
  for (std::uint64_t i = 0; i < positions.size(); ++i)
    mesh.positions.append(positions.at(i));
  execution::SpoolCursor attributes(parts.attributes, room.cancel);
  for (std::uint64_t i = 0; i < attributes.size(); ++i)
    mesh.attributes.append(attributes.at(i));
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i)
    append_triangles(std::span(&triangles.at(i), 1), base, mesh);
}

void add_corners(const OffParts& parts, ColourType type, CornerSplitter& splitter,
                 const ImportRoom& room) {
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  execution::SpoolCursor colours(parts.colours, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    FaceColour colour = colours.at(i);
    for (float& number : colour)
      number = std::isnan(number) ? full_number(type) : number;
    const CornerParts::Parts shown = parts_of(colour, type);
    for (const VertexId corner : triangles.at(i))
      splitter.add({raw(corner), shown});
  }
}

/// Vertices with the colour of their faces, behind normals and before texture coordinates.
void append_coloured(const OffParts& parts, const AttributeLayout& given,
                     const AttributeLayout& layout, RawMesh& mesh, const ImportRoom& room) {
  CornerSplitter splitter(parts.positions.size(), room);
  add_corners(parts, layout.colour, splitter, room);
  SplitVertices vertices(room.scratch);
  splitter.split(vertices, mesh);
  SplitCursor split(vertices, room.cancel);
  execution::SpoolCursor positions(parts.positions, room.cancel);
  execution::SpoolCursor attributes(parts.attributes, room.cancel);
  const auto channels = static_cast<std::size_t>(given.channels());
  const auto before = layout.part(AttributeKind::colours).first;
  for (std::uint64_t i = 0; i < vertices.count(); ++i) {
    const std::uint32_t vertex = split.position(i);
    mesh.positions.append(positions.at(vertex));
    const auto append_given = [&](std::size_t from, std::size_t to) {
      for (std::size_t c = from; c < to; ++c)
        mesh.attributes.append(attributes.at(vertex * channels + c));
    };
    append_given(0, before);
    const FaceColour colour = colour_of(split.parts(i), layout.colour);
    mesh.attributes.append(std::span(colour).first(layout.part(AttributeKind::colours).count));
    append_given(before, channels);
  }
}

constexpr std::string_view kIgnoredFaceColours = "ignored_face_colours";

AddedFile facts_of(const mesh_io::OffCounts& counts) {
  AddedFile added{.layout = counts.attributes,
                  .fits_float = counts.fits_float,
                  .faces = counts.faces.faces,
                  .degenerate_triangles = counts.faces.degenerate_triangles,
                  .unplaced = counts.unplaced};
  added.count(counts.faces.polygons);
  added.count(kIgnoredFaceColours, counts.unknown_colours);
  added.count(counts.odd);
  added.count(counts.zeroed);
  return added;
}

}  // namespace

AddedFile import_off(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     const ImportRoom& room) {
  OffParts parts(room.scratch);
  SpoolLookup<Vec3d> places(parts.positions);
  FaceColours colours(parts);
  const mesh_io::OffCounts counts = mesh_io::read_off(
      stream, path,
      [&](Vec3d position, std::span<const float> attributes) {
        parts.positions.append(position);
        parts.attributes.append(attributes);
      },
      [&](std::span<const Triangle<VertexId>> triangles) {
        room.cancel.check();
        parts.triangles.append(triangles);
      },
      [&](std::uint64_t triangles, const auto& colour) { colours.add(triangles, colour); },
      [&](std::uint32_t vertex) { return places.at(vertex); },
      parallel_blocks(mesh_io::kOffLinesBytes, room));
  AddedFile added = facts_of(counts);
  if (colours.coloured() == 0 || counts.attributes.has_colours()) {
    added.count(kIgnoredFaceColours, colours.coloured());
    append_plain(parts, mesh, room);
    return added;
  }
  added.layout.colour = colours.type();
  added.layout.alpha = colours.has_alpha();
  added.count(kFacesMadeWhite, colours.plain());
  const std::uint64_t before = mesh.vertex_count();
  append_coloured(parts, counts.attributes, added.layout, mesh, room);
  added.count("split_vertices", mesh.vertex_count() - before - parts.positions.size());
  return added;
}

}  // namespace meshhier::importing
