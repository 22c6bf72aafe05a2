#include "import/file_reader.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/parallel.h"
#include "images/ktx2_coder.h"
#include "import/append_mesh.h"
#include "import/crop_mesh.h"
#include "import/gltf_reader.h"
#include "import/obj_import.h"
#include "import/off_import.h"
#include "import/osgb_import.h"
#include "import/ply_import.h"
#include "import/stl_import.h"
#include "import/terrain_import.h"
#include "import/text_blocks.h"
#include "mesh_io/batch_table.h"
#include "mesh_io/input_error.h"
#include "mesh_io/named_files.h"
#include "mesh_io/part_of_file.h"
#include "mesh_io/ply_lines.h"
#include "mesh_io/ply_source.h"
#include "mesh_io/renamed_file.h"
#include "mesh_io/unpadded_stream.h"
#include "storage/io/file_checksum.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {

using mesh_io::InputStream;
using mesh_io::MeshKind;

class FileReader::Impl {
  using Path = std::filesystem::path;

 public:
  static constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

  Impl(InputFiles& input, const ImportEnvironment& environment, RawMesh& mesh)
      : input_(input),
        env_(environment),
        room_{environment.scratch, environment.sort_bytes, environment.cancel},
        named_(input.system()),
        mesh_(mesh),
        gltf_(input, room_) {}

  /// Requires a kind that files have: the tiles of a tileset are files of their own.
  AddedFile read(const InputFileFacts& facts, const std::filesystem::path& room) {
    AddedFile added = read_by_kind(facts, room);
    complete_objects(facts);
    return added;
  }

  AddedFile read_by_kind(const InputFileFacts& facts, const Path& room) {
    const std::uint64_t before = mesh_.vertex_count();
    for (const Reader& reader : readers()) {
      if (reader.kind != facts.format.kind)
        continue;
      AddedFile added = (this->*reader.read)(facts, room);
      added.vertices = mesh_.vertex_count() - before;
      return added;
    }
    throw Error(ErrorCode::internal, facts.path.string() + " is of a format without a reader");
  }

  void unpack(const InputFileFacts& facts, TemporaryFile& to) {
    read_stream(facts, [&](InputStream& stream) {
      const auto file = env_.files.create(to.path());
      std::vector<std::byte> buffer(kMiB);
      std::uint64_t offset = 0;
      for (std::size_t count = buffer.size(); count == buffer.size(); offset += count) {
        count = stream.read(buffer);
        file->write_at(offset, std::span(buffer).first(count));
      }
    });
    to.counted();
  }

 private:
  void count(std::string_view name, std::uint64_t count) { add_count(counts_, name, count); }

  /// Whatever source_counts() knows.
  template <class Counts>
  void count(const Counts& counts) {
    for (const SourceCount& one : source_counts(counts))
      count(one.name, one.count);
  }

  /// Says whose the last triangles of a file are, where its reader did not.
  void complete_objects(const InputFileFacts& facts) {
    if (!mesh_.objects || mesh_.objects->choice.from == mesh_io::ObjectSource::label)
      return;
    MeshObjects& objects = *mesh_.objects;
    const std::uint64_t end = mesh_.triangles.size();
    if (objects.choice.from == mesh_io::ObjectSource::file && end > objects.runs.triangles())
      objects.runs.add(objects.names.number(input_.object_name(facts.path)),
                       end - objects.runs.triangles());
    objects.fill(end);
  }

  using AddStream = AddedFile (Impl::*)(InputStream& stream, const Path& path);

  /// The way in which a file of a kind is read. `room`: a path where a file may be while it is
  /// read.
  struct Reader {
    MeshKind kind;
    AddedFile (Impl::*read)(const InputFileFacts& facts, const Path& room);
  };
  static std::span<const Reader> readers();

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

  template <AddStream add>
  AddedFile read_bytes(const InputFileFacts& facts, const Path& /*room*/) {
    AddedFile added;
    read_stream(facts, [&](InputStream& stream) { added = (this->*add)(stream, facts.path); });
    return added;
  }

  template <AddStream add>
  AddedFile read_text(const InputFileFacts& facts, const Path& /*room*/) {
    AddedFile added;
    read_stream(facts, [&](InputStream& stream) {
      mesh_io::UnpaddedStream text(stream);
      added = (this->*add)(text, facts.path);
      count(mesh_io::OddSyntax{.bytes_behind = text.padding()});
    });
    return added;
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

  AddedFile read_ply(const InputFileFacts& facts, const std::filesystem::path& room) {
    if (!facts.format.is_gzip) {
      const auto source = open_ply(input_.system().open(facts.path));
      const AddedFile added = add_open_ply(*source, facts.path);
      checksums_.push_back(source->checksum([this] { env_.cancel.check(); }));
      env_.progress.advance(facts.identity.bytes);
      return added;
    }
    TemporaryFile unpacked(env_.files, room, env_.scratch.pool().scratch_use());
    unpack(facts, unpacked);
    const auto source = open_ply(mesh_io::renamed(env_.files.open(room), facts.unpacked_name()));
    return add_open_ply(*source, facts.path);
  }

  AddedFile add_open_ply(mesh_io::PlySource& source, const std::filesystem::path& path) {
    AddedFile added = add_plain_ply(source, path);
    count(source.odd_syntax());
    return added;
  }

  AddedFile add_cornered_ply(mesh_io::PlySource& source, const std::filesystem::path& path) {
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

  /// Warns if nearly each face has values of its own: each vertex becomes about six then.
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

  AddedFile add_plain_ply(mesh_io::PlySource& source, const std::filesystem::path& path) {
    const mesh_io::MeshDescription& description = source.description();
    const std::uint32_t base = checked_base(path, description.vertex_count);
    if (has_corner_attributes(source.plan(), input_.textures()))
      return add_cornered_ply(source, path);
    if (input_.crop() && description.vertices_in_place && description.face_count > 0)
      return add_near(source, path);
    AddedFile added{.layout = description.attributes};
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

  /// Adds a piece of a PLY that is read in place: a large file is not copied for it.
  AddedFile add_near(mesh_io::PlySource& source, const std::filesystem::path& path) {
    AddedFile added{.layout = source.description().attributes};
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

  AddedFile read_gltf(const InputFileFacts& facts, const std::filesystem::path& room) {
    if (!facts.format.is_gzip) {
      const ReadContent content = gltf_.read(facts);
      const AddedFile added = add_plain_gltf(facts, content.file);
      note_checksum(facts, content.checksum);
      env_.progress.advance(facts.identity.bytes);
      return added;
    }
    TemporaryFile unpacked(env_.files, room, env_.scratch.pool().scratch_use());
    unpack(facts, unpacked);
    return add_plain_gltf(facts, mesh_io::renamed(env_.files.open(room), facts.unpacked_name()));
  }

  void note_checksum(const InputFileFacts& facts, std::optional<std::uint64_t> known) {
    checksums_.push_back(known ? *known : checksum_of(facts.path));
  }

  /// Returns the checksum of a file that may hold many meshes, for which it is asked again.
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

  AddedFile add_plain_gltf(const InputFileFacts& facts,
                           std::shared_ptr<const storage::File> content) {
    return note_gltf(gltf_.import(facts, std::move(content), mesh_));
  }

  AddedFile note_gltf(const GltfImport& import) {
    for (const SourceCount& one : import.counts)
      count(one.name, one.count);
    count(import.zeroed);
    return {import.layout,           import.fits_float,
            import.triangles,        import.degenerate_triangles,
            import.material_colours, import.is_painted};
  }

  std::unique_ptr<MeshApart> make_apart() {
    auto apart = std::make_unique<MeshApart>(env_.scratch);
    if (mesh_.objects)
      apart->mesh.objects = std::make_unique<MeshObjects>(env_.scratch, mesh_.objects->choice);
    return apart;
  }

  std::unique_ptr<MeshApart> read_apart(const InputFileFacts& facts) {
    std::unique_ptr<MeshApart> apart = make_apart();
    const ReadContent content = gltf_.read(facts);
    apart->import = gltf_.import(facts, content.file, apart->mesh);
    apart->checksum = content.checksum;
    apart->mesh.layout = apart->import.layout;
    return apart;
  }

  /// Moves a mesh behind all others.
  AddedFile append_apart(MeshApart& apart, const Path& path) {
    const std::uint64_t vertices = apart.mesh.vertex_count();
    checked_base(path, vertices);
    append_mesh(std::move(apart.mesh), mesh_, env_.cancel);
    AddedFile added = note_gltf(apart.import);
    added.vertices = vertices;
    return added;
  }

  void read_run(std::span<const InputFileFacts> files,
                const std::function<void(const AddedFile&)>& added) {
    if (files[0].format.kind == MeshKind::osgb)
      return read_osgb(files, added);
    // Blocks of spools, windows, the buffers of a decoder.
    constexpr std::uint64_t kItemBytes = 4 * kMiB;
    execution::ordered_for(
        files.size(), execution::useful_blocks(gltf_.decoding_bytes(), kItemBytes), env_.cancel,
        [&](std::size_t i) { return read_apart(files[i]); },
        [&](std::size_t i, const std::unique_ptr<MeshApart>& apart) {
          const AddedFile one = append_apart(*apart, files[i].path);
          complete_objects(files[i]);
          note_checksum(files[i], apart->checksum);
          env_.progress.advance(files[i].identity.bytes);
          added(one);
        });
  }

  /// Reads tiles with the finer ones that they name. Of a tile, runs of equal layout are one.
  void read_osgb(std::span<const InputFileFacts> files,
                 const std::function<void(const AddedFile&)>& added) {
    const mesh_io::GltfRoom room{input_.system(),
                                 env_.scratch,
                                 gltf_.decoding_bytes(),
                                 mesh_io::GltfContent::packed,
                                 {},
                                 [this] { env_.cancel.check(); }};
    std::vector<AddedFile> runs;
    std::size_t next = 0;
    import_osgb(files, {room, gltf_.decoding(), env_.cancel},
                {.read =
                     [&](mesh_io::GltfFile& file, const mesh_io::GltfTransform& place) {
                       std::unique_ptr<MeshApart> apart = make_apart();
                       apart->import = import_gltf(file, {place, true}, apart->mesh,
                                                   input_.textures(), input_.attributes(), room_);
                       apart->mesh.layout = apart->import.layout;
                       return apart;
                     },
                 .add =
                     [&](std::unique_ptr<MeshApart> apart) {
                       append_run(runs, append_apart(*apart, files[next].path));
                     },
                 .told =
                     [&](std::size_t i, const OsgbFacts& facts) {
                       next = i + 1;
                       note_osgb(files[i].path, facts);
                       complete_objects(files[i]);
                       std::ranges::for_each(std::exchange(runs, {}), added);
                     },
                 .advance = [this](std::uint64_t bytes) { env_.progress.advance(bytes); }});
  }

  void note_osgb(const Path& path, const OsgbFacts& facts) {
    checksums_.push_back(checksum_of(path));
    tiles_.add_all(facts.tiles);
    for (const SourceCount& one : facts.counts)
      count(one.name, one.count);
    for (const std::string& warning : facts.warnings)
      env_.progress.warn(warning);
  }

  static void append_run(std::vector<AddedFile>& all, AddedFile added) {
    if (all.empty() || all.back().layout != added.layout ||
        all.back().is_painted != added.is_painted) {
      all.push_back(std::move(added));
      return;
    }
    AddedFile& last = all.back();
    last.vertices += added.vertices;
    last.faces += added.faces;
    last.degenerate_triangles += added.degenerate_triangles;
    last.material_colours += added.material_colours;
    last.fits_float = last.fits_float && added.fits_float;
  }

  Terrain read_terrain() {
    for (const InputFileFacts& file : input_.all())
      checksums_.push_back(checksum_of(file.path));
    return count_terrain(input_.bytes());
  }

  Terrain count_terrain(std::uint64_t bytes) {
    TerrainImport import = import_terrain(input_, bytes, env_);
    for (const SourceCount& one : import.counts)
      count(one.name, one.count);
    return std::move(import.terrain);
  }

  /// Reads all rasters with the first of them.
  AddedFile read_raster(const InputFileFacts& facts, const Path& /*room*/) {
    checksums_.push_back(checksum_of(facts.path));
    const auto is_raster = [](const InputFileFacts& file) { return file.format.row().is_raster; };
    if (&facts != &*std::ranges::find_if(input_.all(), is_raster))
      return {};
    const auto source = open_terrain(count_terrain(facts.identity.bytes));
    const std::uint32_t base = checked_base(facts.path, source->description().vertex_count);
    AddedFile added;
    source->read_vertices([&](const mesh_io::VertexBlock& block) {
      env_.cancel.check();
      mesh_.positions.append(block.exact);
      added.fits_float = added.fits_float && block.fits_float();
    });
    added.faces = source
                      ->read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
                        append(triangles, base);
                      })
                      .faces;
    return added;
  }

  AddedFile add_obj(InputStream& stream, const std::filesystem::path& path) {
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

  template <StlForm form>
  AddedFile add_stl(InputStream& stream, const std::filesystem::path& path) {
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

  AddedFile add_off(InputStream& stream, const std::filesystem::path& path) {
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

  friend class FileReader;

  InputFiles& input_;
  const ImportEnvironment& env_;
  ImportRoom room_;
  mesh_io::NamedFiles named_;
  RawMesh& mesh_;
  GltfReader gltf_;
  std::uint64_t near_apart_ = 0;
  std::vector<SourceCount> counts_;
  std::vector<std::uint64_t> checksums_;
  std::map<Path, std::uint64_t> checked_;  ///< files of glTF and OSGB
  CompanionFiles tiles_;
};

std::span<const FileReader::Impl::Reader> FileReader::Impl::readers() {
  static constexpr auto kReaders = std::to_array<Reader>({
      {MeshKind::ply, &Impl::read_ply},
      {MeshKind::obj, &Impl::read_text<&Impl::add_obj>},
      {MeshKind::gltf, &Impl::read_gltf},
      {MeshKind::glb, &Impl::read_gltf},
      {MeshKind::b3dm, &Impl::read_gltf},
      {MeshKind::stl_binary, &Impl::read_bytes<&Impl::add_stl<StlForm::binary>>},
      {MeshKind::stl_text, &Impl::read_text<&Impl::add_stl<StlForm::text>>},
      {MeshKind::off, &Impl::read_text<&Impl::add_off>},
      {MeshKind::geotiff, &Impl::read_raster},
      {MeshKind::hgt, &Impl::read_raster},
      {MeshKind::asc, &Impl::read_raster},
  });
  return kReaders;
}

FileReader::FileReader(InputFiles& input, const ImportEnvironment& environment, RawMesh& mesh)
    : impl_(std::make_unique<Impl>(input, environment, mesh)) {}

FileReader::~FileReader() = default;

AddedFile FileReader::read(const InputFileFacts& facts, const std::filesystem::path& room) {
  return impl_->read(facts, room);
}

std::size_t FileReader::run_of(std::span<const InputFileFacts> files) {
  const auto is_tile = [](const InputFileFacts& file) {
    return file.format.kind == MeshKind::osgb;
  };
  const auto is_apart = [](const InputFileFacts& file) {
    return file.format.row().names_features && !file.format.is_gzip;
  };
  const auto begin = files.begin(), end = files.end();
  if (const auto tiles = std::find_if_not(begin, end, is_tile); tiles != begin)
    return static_cast<std::size_t>(tiles - begin);
  const auto run = static_cast<std::size_t>(std::find_if_not(begin, end, is_apart) - begin);
  return run > 1 ? run : 0;
}

void FileReader::read_run(std::span<const InputFileFacts> files,
                          const std::function<void(const AddedFile&)>& added) {
  impl_->read_run(files, added);
}

void FileReader::look_for_decoders() {
  const bool may_lack = impl_->input_.textures() == Textures::use &&
                        std::ranges::any_of(impl_->input_.all(), &InputFileFacts::names_ktx2) &&
                        !images::missing_for_ktx2().empty();
  for (const InputFileFacts& file : impl_->input_.all()) {
    if (may_lack && file.names_ktx2)
      impl_->gltf_.look_for_pictures(file);
  }
}

Terrain FileReader::read_terrain() {
  return impl_->read_terrain();
}

void FileReader::unpack(const InputFileFacts& facts, TemporaryFile& to) {
  impl_->unpack(facts, to);
}

const std::vector<std::uint64_t>& FileReader::checksums() const {
  return impl_->checksums_;
}

const std::vector<SourceCount>& FileReader::counts() const {
  return impl_->counts_;
}

const CompanionFiles& FileReader::tiles() const {
  return impl_->tiles_;
}

std::uint64_t FileReader::near_apart() const {
  return impl_->near_apart_;
}

}  // namespace meshhier::importing
