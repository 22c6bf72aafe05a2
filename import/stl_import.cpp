#include "import/stl_import.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/spool_cursor.h"
#include "import/text_blocks.h"
#include "import/weld.h"
#include "mesh_io/stl_block.h"
#include "mesh_io/stl_colours.h"
#include "mesh_io/stl_reader.h"

#include <optional>
#include <span>
#include <type_traits>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// Binary files hold floats.
template <class Point>
class StlImporter {
 public:
  /// `objects`: those of the mesh; null: nobody asks for them.
  StlImporter(MeshObjects* objects, const ImportRoom& room)
      : room_(room),
        objects_(objects),
        corners_(room.scratch, kImportSpoolBytes),
        attributes_(room.scratch, kImportSpoolBytes),
        colours_(room.scratch, kImportSpoolBytes) {}

  AddedFile import(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh) {
    read(stream, path);
    if (counts_.dropped.count > counts_.facets / 2) {
      throw Error(ErrorCode::input, counts_.dropped.first +
                                        "; that is so of most facets, so the mesh cannot be built");
    }
    find_colours();
    const WeldCounts welded = weld_soup(corners_, has_colours_ ? &colours_ : nullptr, mesh, room_);
    added_.degenerate_triangles = welded.degenerate_triangles;
    added_.count("welded_corners", welded.merged);
    tell_counts();
    return added_;
  }

 private:
  void read(mesh_io::InputStream& stream, const std::filesystem::path& path) {
    const mesh_io::SoupVisitor take = [&](std::span<const mesh_io::SoupTriangle> triangles) {
      room_.cancel.check();
      for (const mesh_io::SoupTriangle& triangle : triangles)
        append(triangle);
    };
    if constexpr (std::is_same_v<Point, Vec3f>) {
      counts_ = mesh_io::read_binary_stl(stream, path, take,
                                         [&](std::span<const std::uint16_t> attributes) {
                                           attributes_.append(attributes);
                                           known_.add(attributes);
                                         });
    } else {
      mesh_io::StlTextReader reader(path, take, solid_visitor());
      counts_ = read_text_blocks<mesh_io::StlBlock>(
          mesh_io::LineBlocks(stream, mesh_io::whole_facets), mesh_io::kStlBlockBytes,
          mesh_io::parse_facets, reader, room_);
    }
  }

  mesh_io::StlSolidVisitor solid_visitor() {
    if (objects_ == nullptr || !objects_->choice.takes(mesh_io::ObjectSource::solid))
      return {};
    return [this](std::string_view name) { solid_ = objects_->names.number(name); };
  }

  void append(const mesh_io::SoupTriangle& triangle) {
    const auto& [a, b, c] = triangle;
    if (solid_ && a != b && b != c && c != a)  // others are dropped by welding
      objects_->runs.add(*solid_, 1);
    for (const Vec3d& p : triangle) {
      if constexpr (std::is_same_v<Point, Vec3f>)
        corners_.append(to_float(p));
      else
        corners_.append(p);
    }
  }

  void find_colours() {
    known_.set_header(counts_.header_colour);
    has_colours_ = std::is_same_v<Point, Vec3f> && known_.any();
    if (!has_colours_)
      return added_.count("ignored_facet_attributes", counts_.attributes);
    added_.layout.colour = ColourType::u8;
    std::uint64_t white = 0;
    execution::SpoolCursor attributes(attributes_, room_.cancel);
    for (std::uint64_t i = 0; i < attributes.size(); ++i) {
      const std::optional<mesh_io::StlColour> colour = known_.colour_of(attributes.at(i));
      white += colour ? 0 : 1;
      colours_.append(colour.value_or(mesh_io::StlColour{255, 255, 255}));
    }
    attributes_.clear();
    added_.count(kFacesMadeWhite, white);
  }

  void tell_counts() {
    added_.fits_float = counts_.fits_float;
    added_.faces = counts_.facets;
    added_.count("ignored_facet_normals", counts_.facets);
    added_.count("ignored_bytes_behind", counts_.bytes_behind);
    added_.count("dropped_facets", counts_.dropped.count);
    added_.count(counts_.odd);
    if (counts_.dropped.count > 0) {
      added_.warnings.push_back(fmt::format("{}: {} left out", counts_.dropped.first,
                                            counted(counts_.dropped.count, "such facets")));
    }
  }

  const ImportRoom& room_;
  MeshObjects* objects_;
  std::optional<std::uint32_t> solid_{};  ///< object of the facets from here on
  storage::RecordSpool<Point> corners_;
  storage::RecordSpool<std::uint16_t> attributes_;  ///< one for each facet of a binary file
  storage::RecordSpool<FacetColour> colours_;       ///< the same
  mesh_io::StlColours known_;
  bool has_colours_ = false;
  mesh_io::StlCounts counts_;
  AddedFile added_;
};

}  // namespace

AddedFile import_stl(StlForm form, mesh_io::InputStream& stream, const std::filesystem::path& path,
                     RawMesh& mesh, const ImportRoom& room) {
  MeshObjects* const objects = mesh.objects.get();
  return form == StlForm::binary ? StlImporter<Vec3f>(objects, room).import(stream, path, mesh)
                                 : StlImporter<Vec3d>(objects, room).import(stream, path, mesh);
}

}  // namespace meshhier::importing
