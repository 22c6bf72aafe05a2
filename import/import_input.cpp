#include "import/import_input.h"

#include "hierarchy/error.h"
#include "hierarchy/plain_text.h"
#include "import/crop_mesh.h"
#include "import/gltf_import.h"
#include "import/join_layouts.h"
#include "import/obj_import.h"
#include "import/off_import.h"
#include "import/place_vertices.h"
#include "import/ply_import.h"
#include "import/raw_mesh.h"
#include "import/stl_import.h"
#include "import/text_blocks.h"
#include "import/weld.h"
#include "mesh_io/input_error.h"
#include "mesh_io/part_of_file.h"
#include "mesh_io/ply_lines.h"
#include "mesh_io/ply_source.h"
#include "mesh_io/ply_writer.h"
#include "mesh_io/renamed_file.h"
#include "mesh_io/unpadded_stream.h"
#include "storage/io/file_checksum.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::InputStream;
using mesh_io::MeshKind;

constexpr std::uint64_t kImportMiB = std::uint64_t{1} << 20;

/// One build's import.
class Import {
 public:
  Import(InputFiles& input, const ImportEnvironment& environment)
      : input_(input),
        env_(environment),
        room_{environment.scratch, environment.sort_bytes, environment.cancel},
        named_(input.system()),
        mesh_(environment.scratch) {}

  ImportFacts run(TemporaryFile& ply) {
    env_.progress.stage("import", input_.bytes(), "bytes");
    if (input_.is_unpacked_only()) {
      unpack(input_.all()[0], ply);
    } else {
      for (const InputFileFacts& file : input_.all())
        add(file, ply);
      facts_.faces = faces_;
      require_triangles();
      join();
      RawMesh& placed = unplaced_.count > 0 ? place() : mesh_;
      RawMesh& piece = input_.crop() ? crop(placed) : placed;
      write(input_.weld() ? weld(piece) : piece, ply);
    }
    for (const SourceCount& one : input_.tileset_counts())
      count(one.name, one.count);
    note_files();
    note_textures();
    facts_.label_names = std::move(mesh_.label_names);
    std::ranges::sort(facts_.counts, {}, &SourceCount::name);
    return std::move(facts_);
  }

 private:
  /// What of glTF and tiles is left out may be all.
  void require_triangles() const {
    const auto has = [&](std::string_view name) {
      return std::ranges::any_of(facts_.counts,
                                 [&](const SourceCount& one) { return one.name == name; });
    };
    if (mesh_.vertex_count() > 0)
      return;
    if (has(kPointsAndLines)) {
      throw Error(ErrorCode::input,
                  input_.name() +
                      " holds points or lines alone, no triangles; make a mesh of the "
                      "points first, as by Poisson reconstruction");
    }
    if (has(kInvisibleParts)) {
      throw Error(ErrorCode::input, input_.name() +
                                        " holds nothing that is to be seen: the materials of all "
                                        "its triangles have an alpha of 0");
    }
  }

  void join() {
    const JoinCounts counts = join_layouts(joined_, mesh_, room_);
    count("untextured_files", counts.untextured_files);
    count("dropped_normals", counts.dropped_normals);
    count("dropped_texcoords", counts.dropped_texcoords);
    count("dropped_values", counts.dropped_values);
    count(kMadeWhite, counts.white_vertices);
    count(kHiddenColours, counts.hidden_colours);
    count("converted_colours", counts.converted_colours);
  }

  /// What a file adds to the mesh besides vertices and triangles.
  struct Added {
    AttributeLayout layout;
    bool fits_float = true;
    std::uint64_t faces = 0;
    std::uint64_t degenerate_triangles = 0;
    std::uint64_t material_colours = 0;  ///< that vertices have
    bool is_painted = false;             ///< no vertex has another one
    mesh_io::UnplacedVertices unplaced{};
  };

  void count(std::string_view name, std::uint64_t count) { add_count(facts_.counts, name, count); }

  /// Whatever source_counts() knows.
  template <class Counts>
  void count(const Counts& counts) {
    for (const SourceCount& one : source_counts(counts))
      count(one.name, one.count);
  }

  /// Reads the file's content by `read(stream)`, and its checksum on the way.
  template <class Read>
  void read_stream(const InputFileFacts& facts, const Read& read) {
    const auto file = input_.system().open(facts.path);
    const std::uint64_t bytes = file->size();
    storage::FileChecksum checksum(bytes);
    const auto stream =
        mesh_io::open_stream({*file, bytes, &checksum}, [this](std::uint64_t count) {
          env_.cancel.check();
          env_.progress.advance(count);
        });
    read(*stream);
    checksums_.push_back(checksum.complete(*file, [this] { env_.cancel.check(); }));
  }

  /// The same of a text.
  template <class Read>
  void read_text(const InputFileFacts& facts, const Read& read) {
    read_stream(facts, [&](InputStream& stream) {
      mesh_io::UnpaddedStream text(stream);
      read(text);
      count(mesh_io::OddSyntax{.bytes_behind = text.padding()});
    });
  }

  /// When all is read. Pictures are read for their checksums, which is little beside decoding them.
  void note_files() {
    Companions all = input_.companions();
    for (const CompanionFile& library : mesh_.materials.companions().files())
      all.add(library);
    for (const images::ImageSource& picture : mesh_.materials.list().images) {
      if (!picture.file.empty() && picture.bytes == 0)
        all.add({picture.file, InputPart::picture, input_.system().identity(picture.file)});
    }
    all.await(mesh_.materials.companions().awaited());
    input_.set_companions(std::move(all));
    facts_.record = input_.record(checksums_, env_.cancel, [this](const CompanionFile& file) {
      if (file.part == InputPart::buffer ||
          file.part == InputPart::tileset)  // the others were not known when the stage began
        env_.progress.advance(file.identity.bytes);
    });
    facts_.files = input_.describe(facts_.record);
    input_.check_unchanged();
  }

  void note_textures() {
    MaterialTable& table = mesh_.materials;
    count("missing_images", table.missing());
    for (const std::string& warning :
         {table.warning_of_libraries(), table.warning_of_materials(),
          table.warning_of_left_materials(), table.warning(mesh_.layout.material)}) {
      if (!warning.empty())
        env_.progress.warn(warning);
    }
    if (!mesh_.layout.material)
      return;
    count("masked_materials", table.mask_mixed());
    facts_.materials = table.list();
    facts_.textures = {.materials = facts_.materials.materials.size(),
                       .images = facts_.materials.images.size() + table.missing(),
                       .missing_images = table.missing()};
  }

  void unpack(const InputFileFacts& facts, TemporaryFile& to) {
    read_stream(facts, [&](InputStream& stream) {
      const auto file = env_.files.create(to.path());
      std::vector<std::byte> buffer(kImportMiB);
      std::uint64_t offset = 0;
      for (std::size_t count = buffer.size(); count == buffer.size(); offset += count) {
        count = stream.read(buffer);
        file->write_at(offset, std::span(buffer).first(count));
      }
    });
    to.counted();
  }

  void add(const InputFileFacts& facts, TemporaryFile& ply) {
    const std::uint64_t vertices = mesh_.vertex_count();
    Added added;
    switch (facts.format.kind) {
      case MeshKind::ply:
        added = add_ply(facts, ply.path());
        break;
      case MeshKind::obj:
        read_text(facts, [&](InputStream& stream) { added = add_obj(stream, facts.path); });
        break;
      case MeshKind::stl_binary:
        read_stream(facts, [&](InputStream& stream) {
          added = add_stl(StlForm::binary, stream, facts.path);
        });
        break;
      case MeshKind::stl_text:
        read_text(facts,
                  [&](InputStream& stream) { added = add_stl(StlForm::text, stream, facts.path); });
        break;
      case MeshKind::off:
        read_text(facts, [&](InputStream& stream) { added = add_off(stream, facts.path); });
        break;
      case MeshKind::tileset:  // its tiles are the files
        throw Error(ErrorCode::internal, facts.path.string() + " is a tileset");
      case MeshKind::gltf:
      case MeshKind::glb:
      case MeshKind::b3dm:
        added = add_gltf(facts, ply.path());
        break;
    }
    count(kMaterialColours, added.material_colours);
    joined_.push_back({added.layout, mesh_.vertex_count() - vertices, added.is_painted});
    mesh_.fits_float = mesh_.fits_float && added.fits_float;
    faces_ += added.faces;
    facts_.degenerate_triangles += added.degenerate_triangles;
    if (unplaced_.count == 0)
      unplaced_.first = added.unplaced.first;
    unplaced_.count += added.unplaced.count;
  }

  std::uint32_t checked_base(const std::filesystem::path& path, std::uint64_t more) const {
    const std::uint64_t base = mesh_.vertex_count();
    if (base + more >= UINT32_MAX)
      mesh_io::fail_file(path, "with it the input has 2^32 vertices or more");
    return static_cast<std::uint32_t>(base);
  }

  void append(std::span<const Triangle<VertexId>> triangles, std::uint32_t base) {
    env_.cancel.check();
    for (const Triangle<VertexId>& t : triangles)
      mesh_.triangles.append(
          Triangle<std::uint32_t>{base + raw(t[0]), base + raw(t[1]), base + raw(t[2])});
  }

  std::unique_ptr<mesh_io::PlySource> open_ply(std::unique_ptr<storage::File> file) const {
    return mesh_io::make_ply_source(std::move(file), {.unplaced = mesh_io::Unplaced::visited,
                                                      .attributes = input_.attributes()});
  }

  Added add_ply(const InputFileFacts& facts, const std::filesystem::path& room) {
    if (!facts.format.is_gzip) {
      const auto source = open_ply(input_.system().open(facts.path));
      const Added added = add_open_ply(*source, facts.path);
      checksums_.push_back(source->checksum([this] { env_.cancel.check(); }));
      env_.progress.advance(facts.identity.bytes);
      return added;
    }
    TemporaryFile unpacked(env_.files, room, env_.scratch.pool().scratch_use());
    unpack(facts, unpacked);
    const auto source = open_ply(mesh_io::renamed(env_.files.open(room), facts.unpacked_name()));
    return add_open_ply(*source, facts.path);
  }

  Added add_open_ply(mesh_io::PlySource& source, const std::filesystem::path& path) {
    Added added = add_plain_ply(source, path);
    count(source.odd_syntax());
    return added;
  }

  Added add_cornered_ply(mesh_io::PlySource& source, const std::filesystem::path& path) {
    const PlyImport import =
        import_ply_corners(source, path, input_.textures(), mesh_, named_, room_);
    checked_base(path, 0);
    count("split_vertices", import.split_vertices);
    warn_of_split(source, import, path);
    count(kHiddenColours, import.hidden_colours);
    count(import.counts.polygons);
    count(import.zeroed);
    return {.layout = import.layout,
            .fits_float = import.fits_float,
            .faces = import.counts.faces,
            .degenerate_triangles = import.counts.degenerate_triangles,
            .unplaced = import.unplaced};
  }

  /// Where nearly each face has values of its own, each vertex becomes about six.
  void warn_of_split(const mesh_io::PlySource& source, const PlyImport& import,
                     const std::filesystem::path& path) {
    const std::uint64_t given = source.description().vertex_count;
    if (source.plan().face_values.empty() || import.split_vertices <= given)
      return;
    env_.progress.warn(mesh_io::file_message(
        path, fmt::format("values of faces make {} of {}, and the hierarchy larger; \"attributes\" "
                          "of the config chooses which are read",
                          counted(given + import.split_vertices, "vertices"), given)));
  }

  Added add_plain_ply(mesh_io::PlySource& source, const std::filesystem::path& path) {
    const mesh_io::MeshDescription& description = source.description();
    const std::uint32_t base = checked_base(path, description.vertex_count);
    if (has_corner_attributes(source.plan(), input_.textures()))
      return add_cornered_ply(source, path);
    if (input_.crop() && description.vertices_in_place && description.face_count > 0)
      return add_near(source, path);
    Added added{.layout = description.attributes};
    const mesh_io::BlockRunner runner = parallel_blocks(mesh_io::kPlyLinesBytes, room_);
    source.read_vertices(
        [&](const mesh_io::VertexBlock& block) {
          env_.cancel.check();
          for (const Vec3f& p : block.positions)
            mesh_.positions.append(to_double(p));
          mesh_.positions.append(block.exact);
          added.fits_float = added.fits_float && block.fits_float();
          count_unplaced(block, path, added.unplaced);
          mesh_.attributes.append(block.attributes);
          count(block.zeroed);
        },
        runner);
    const mesh_io::FaceCounts counts = source.read_triangles(
        [&](std::span<const Triangle<VertexId>> triangles) { append(triangles, base); }, runner);
    added.faces = counts.faces;
    added.degenerate_triangles = counts.degenerate_triangles;
    count(counts.polygons);
    return added;
  }

  /// Of a PLY that is read in place: a piece of a large file leaves no copy of it.
  Added add_near(mesh_io::PlySource& source, const std::filesystem::path& path) {
    Added added{.layout = source.description().attributes};
    const std::uint64_t before = mesh_.triangles.size();
    const mesh_io::FaceCounts counts = append_near(
        source, *input_.crop(), mesh_,
        [&](const mesh_io::VertexBlock& block) {
          added.fits_float = added.fits_float && block.fits_float();
          count_unplaced(block, path, added.unplaced);
          count(block.zeroed);
        },
        room_);
    near_apart_ += counts.triangles - (mesh_.triangles.size() - before);
    added.faces = counts.faces;
    added.degenerate_triangles = counts.degenerate_triangles;
    count(counts.polygons);
    return added;
  }

  Added add_gltf(const InputFileFacts& facts, const std::filesystem::path& room) {
    if (!facts.format.is_gzip) {
      const Added added = add_plain_gltf(facts, facts.content(input_.system()));
      checksums_.push_back(checksum_of(facts.path));
      env_.progress.advance(facts.identity.bytes);
      return added;
    }
    TemporaryFile unpacked(env_.files, room, env_.scratch.pool().scratch_use());
    unpack(facts, unpacked);
    return add_plain_gltf(facts, mesh_io::renamed(env_.files.open(room), facts.unpacked_name()));
  }

  /// Of a file that may hold many meshes, one behind the other.
  std::uint64_t checksum_of(const std::filesystem::path& path) {
    const auto known = checked_.find(path);
    if (known != checked_.end())
      return known->second;
    const auto file = input_.system().open(path);
    const std::uint64_t checksum =
        storage::FileChecksum(file->size()).complete(*file, [this] { env_.cancel.check(); });
    checked_.emplace(path, checksum);
    return checksum;
  }

  static mesh_io::GltfContent content_of(const InputFileFacts& facts) {
    if (facts.tile && facts.tile->data)
      return mesh_io::GltfContent::fleeting;
    return facts.format.is_gzip ? mesh_io::GltfContent::packed : mesh_io::GltfContent::stored;
  }

  Added add_plain_gltf(const InputFileFacts& facts, std::shared_ptr<const storage::File> content) {
    // While the reader decodes no sort runs.
    constexpr std::uint64_t kLeast = 4 * kImportMiB;
    const mesh_io::TilesetMesh tile = facts.tile.value_or(mesh_io::TilesetMesh{});
    if (facts.tile && tile.offset + tile.bytes > content->size())
      mesh_io::fail_file(facts.path, "ends within a tile (truncated?)");
    if (facts.tile)
      content = mesh_io::part_of(std::move(content), tile.offset, tile.bytes);
    mesh_io::GltfFile file(
        std::move(content), facts.path.parent_path(),
        {input_.system(), env_.scratch, std::max(2 * room_.sort_bytes, kLeast), content_of(facts),
         facts.path, [this] { env_.cancel.check(); }, tile.offset});
    const GltfImport import =
        import_gltf(file, tile.placement, mesh_, input_.textures(), input_.attributes(), room_);
    for (const SourceCount& one : import.counts)
      count(one.name, one.count);
    count(import.zeroed);
    return {import.layout,           import.fits_float,
            import.triangles,        import.degenerate_triangles,
            import.material_colours, import.is_painted};
  }

  Added add_obj(InputStream& stream, const std::filesystem::path& path) {
    const ObjImport import =
        import_obj(stream, path, mesh_, named_, input_.textures(), input_.attributes(), room_);
    checked_base(path, 0);
    const mesh_io::ObjCounts& counts = import.counts;
    count("split_vertices", import.split_vertices);
    count(kMadeWhite, import.filled_colours);
    count(kHiddenColours, import.hidden_colours);
    count("vertices_without_texcoord", import.filled_texcoords);
    count("vertices_without_normal", import.filled_normals);
    count("missing_material_libraries", import.missing_libraries);
    count("undefined_materials", import.undefined_materials);
    count("ignored_alpha_images", import.other_alphas);
    count("ignored_polypaint", import.ignored_polypaint);
    count("libraries_with_colours_of_bytes", import.byte_libraries);
    if (import.byte_libraries > 0) {
      env_.progress.warn(mesh_io::file_message(
          path,
          "the colours (Kd) of its materials are whole numbers up to 255: they are taken for "
          "bytes"));
    }
    count(counts.zeroed);
    count(counts.odd);
    count("groups", counts.groups);
    count("objects", counts.objects);
    count("material_uses", counts.materials);
    count("material_libraries", counts.libraries);
    count(kPointsAndLines, counts.points_and_lines);
    count(counts.polygons);
    count("ignored_statements", counts.others);
    return {import.layout,           import.fits_float, counts.faces,   counts.degenerate_triangles,
            import.material_colours, import.is_painted, counts.unplaced};
  }

  Added add_stl(StlForm form, InputStream& stream, const std::filesystem::path& path) {
    const StlImport import = import_stl(form, stream, path, mesh_, room_);
    checked_base(path, 0);
    const mesh_io::StlCounts& counts = import.counts;
    count("welded_corners", import.welded_corners);
    count("ignored_facet_normals", counts.facets);
    count("ignored_facet_attributes", import.ignored_attributes);
    count("ignored_bytes_behind", counts.bytes_behind);
    count(kFacesMadeWhite, import.white_facets);
    count("dropped_facets", counts.dropped.count);
    count(counts.odd);
    if (counts.dropped.count > 0) {
      env_.progress.warn(fmt::format("{}: {} left out", counts.dropped.first,
                                     counted(counts.dropped.count, "such facets")));
    }
    return {import.layout, counts.fits_float, counts.facets, import.degenerate_triangles};
  }

  Added add_off(InputStream& stream, const std::filesystem::path& path) {
    const OffImport import = import_off(stream, path, mesh_, room_);
    checked_base(path, 0);
    const mesh_io::OffCounts& counts = import.counts;
    count("split_vertices", import.split_vertices);
    count(counts.faces.polygons);
    count("ignored_face_colours", import.ignored_colours);
    count(kFacesMadeWhite, import.white_faces);
    count(counts.odd);
    count(counts.zeroed);
    return {.layout = import.layout,
            .fits_float = counts.fits_float,
            .faces = counts.faces.faces,
            .degenerate_triangles = counts.faces.degenerate_triangles,
            .unplaced = counts.unplaced};
  }

  RawMesh& crop(RawMesh& whole) {
    cropped_.emplace(env_.scratch);
    count("cropped_triangles", near_apart_ + crop_mesh(whole, *cropped_, *input_.crop(), room_));
    if (cropped_->vertex_count() == 0) {
      throw Error(ErrorCode::usage, "nothing of " + input_.name() +
                                        " lies in the box of \"crop\"; compare it with where the "
                                        "mesh is");
    }
    return *cropped_;
  }

  RawMesh& place() {
    placed_.emplace(env_.scratch);
    const DroppedUnplaced dropped = drop_unplaced(mesh_, *placed_, unplaced_.first, room_);
    count(kDroppedUnplaced, dropped.vertices);
    count("dropped_unplaced_triangles", dropped.triangles);
    if (dropped.triangles > 0) {
      env_.progress.warn(fmt::format("{}; {} left out, which {} such vertices", unplaced_.first,
                                     counted(dropped.triangles, "triangles"),
                                     dropped.triangles == 1 ? "uses" : "use"));
    }
    return *placed_;
  }

  RawMesh& weld(RawMesh& mesh) {
    welded_.emplace(env_.scratch);
    const WeldCounts counts = weld_vertices(mesh, *welded_, room_);
    count("welded_vertices", counts.merged);
    count("triangles_lost_by_welding", counts.degenerate_triangles);
    facts_.degenerate_triangles += counts.degenerate_triangles;
    return *welded_;
  }

  void write(RawMesh& mesh, TemporaryFile& ply) {
    facts_.writer = mesh_io::PlyWrittenBy::import;
    mesh_io::PlyContent content;
    content.vertex_count = mesh.vertex_count();
    content.triangle_count = mesh.triangles.size();
    content.attributes = mesh.layout;
    content.double_coordinates = !mesh.fits_float;
    content.is_import = true;
    mesh_io::PlyWriter writer(env_.files.create(ply.path()), content);
    constexpr std::uint64_t kBlock = 16384;
    const std::size_t channels = mesh.channels();
    std::vector<Vec3d> positions;
    std::vector<float> attributes;
    for (std::uint64_t i = 0; i < content.vertex_count; i += kBlock) {
      env_.cancel.check();
      positions.resize(std::min(kBlock, content.vertex_count - i));
      attributes.resize(positions.size() * channels);
      mesh.positions.read(i, positions);
      mesh.attributes.read(i * channels, attributes);
      writer.write_vertices(positions, attributes);
    }
    std::vector<Triangle<std::uint32_t>> triangles;
    for (std::uint64_t i = 0; i < content.triangle_count; i += kBlock) {
      env_.cancel.check();
      triangles.resize(std::min(kBlock, content.triangle_count - i));
      mesh.triangles.read(i, triangles);
      writer.write_triangles(triangles);
    }
    writer.finish();
    ply.counted();
  }

  InputFiles& input_;
  const ImportEnvironment& env_;
  ImportRoom room_;
  mesh_io::NamedFiles named_;
  RawMesh mesh_;
  std::optional<RawMesh> placed_, cropped_, welded_;
  std::uint64_t near_apart_ = 0;  ///< triangles that were not read, as they are not near the crop
  mesh_io::UnplacedVertices unplaced_;
  std::uint64_t faces_ = 0;
  std::vector<JoinedFile> joined_;
  std::vector<std::uint64_t> checksums_;                    ///< of the meshes that are read
  std::map<std::filesystem::path, std::uint64_t> checked_;  ///< files of glTF
  ImportFacts facts_;
};

}  // namespace

TemporaryFile::~TemporaryFile() {
  try {
    files_.remove_all(path_);
  } catch (const Error&) {  // the failure that brought us here, or the next one, is the one to tell
  }
  use_.add_removed(bytes_);
}

void TemporaryFile::counted() {
  use_.add_removed(bytes_);
  bytes_ = files_.open(path_)->size();
  use_.add_written(bytes_);
  use_.add_grown(bytes_);
}

namespace {

/// Of the values that vertices have.
void name_labels(const AllLabelNames& all, SourceSummary& summary) {
  constexpr std::size_t kLongest = 100;
  for (std::size_t i = 0; i < summary.values.size(); ++i) {
    const auto names = all.find(summary.attributes.values[i].name);
    if (names == all.end())
      continue;
    for (ValueStatistics::LabelCount& one : summary.values[i].labels) {
      if (one.label > 0)
        one.name = plain_text(names->second.name(static_cast<std::uint16_t>(one.label)), kLongest);
    }
  }
}

}  // namespace

void ImportFacts::complete(SourceSummary& summary) const {
  summary.file_bytes = 0;
  for (const SourceFile& file : files)
    summary.file_bytes += file.bytes;
  summary.checksum = joined_checksum(files);
  summary.files = files;
  // Of an unpacked PLY they were counted while it was read.
  summary.counts.insert(summary.counts.end(), counts.begin(), counts.end());
  std::ranges::sort(summary.counts, {}, &SourceCount::name);
  summary.textures = textures;
  name_labels(label_names, summary);
  if (faces)
    summary.faces = *faces;
  summary.degenerate_triangles += degenerate_triangles;
}

std::string counts_text(const std::vector<SourceCount>& counts) {
  std::string text;
  for (const SourceCount& one : counts) {
    std::string name = one.name;
    std::ranges::replace(name, '_', ' ');
    text += (text.empty() ? "" : ", ") + counted(one.count, name);
  }
  return text;
}

ImportMemory plan_import(std::uint64_t memory_budget) {
  // The program and its allocator, as memory_plan.cpp measured them; blocks and buffers of readers
  // and writers, 12 MiB.
  constexpr std::uint64_t kFixed = 30 * kImportMiB;
  constexpr std::uint64_t kAllocatorParts = 12;
  const std::uint64_t taken = kFixed + memory_budget / kAllocatorParts;
  // What cannot be is refused when the mesh is known.
  const std::uint64_t rest = std::max(memory_budget, taken + 4 * kImportMiB) - taken;
  return {rest / 4, rest / 4};
}

std::uint64_t predict_import(const InputFiles& input, const ImportMemory& memory) {
  // The PLY has at most the size of the text or soup. What lies in spools and sorts beside it, up
  // to the pool in memory: once the size of a text of floats, three times where corners have
  // attributes, and three times that of an STL, whose corners are sorted. Six times that of a PLY
  // with textured faces: corners are sorted twice, 44 bytes each, and a face has 17. Ten times
  // where faces have values: a face has 14 bytes, and each corner may become a vertex. Gzip packs
  // such files to a third or a quarter.
  constexpr std::uint64_t kSpools = 3;
  constexpr std::uint64_t kCorneredSpools = 6;
  constexpr std::uint64_t kValuedSpools = 10;
  constexpr std::uint64_t kPacked = 4;
  constexpr std::uint64_t kLeastVertexBytes = 12;
  std::uint64_t content = input.geometry_bytes();
  std::uint64_t cornered = 0;  // what these take beyond kSpools times
  for (const InputFileFacts& file : input.all()) {
    if (input.crop() && file.is_plain_ply() && !file.has_corner_attributes) {
      // A byte a vertex, of 12 bytes at least; how large the piece is shows when it is read.
      content -= file.identity.bytes - file.identity.bytes / kLeastVertexBytes;
      continue;
    }
    const std::uint64_t bytes = file.identity.bytes * (file.format.is_gzip ? kPacked : 1);
    content += bytes - file.identity.bytes;
    if (file.face_values > 0)
      cornered += (kValuedSpools + file.face_values / 2 - kSpools) * bytes;
    else if (file.has_corner_attributes)
      cornered += (kCorneredSpools - kSpools) * bytes;
  }
  const std::uint64_t spools = input.is_unpacked_only() ? 0 : kSpools * content + cornered;
  return content + spools - std::min(spools, memory.pool_bytes);
}

ImportFacts import_input(InputFiles& input, TemporaryFile& ply,
                         const ImportEnvironment& environment) {
  return Import(input, environment).run(ply);
}

}  // namespace meshhier::importing
