#include "import/file_reader.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "images/ktx2_coder.h"
#include "import/append_mesh.h"
#include "import/gltf_reader.h"
#include "import/obj_import.h"
#include "import/off_import.h"
#include "import/osgb_import.h"
#include "import/ply_import.h"
#include "import/stl_import.h"
#include "import/terrain_import.h"
#include "mesh_io/named_files.h"
#include "mesh_io/renamed_file.h"
#include "mesh_io/unpadded_stream.h"
#include "storage/io/file_checksum.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>

namespace meshhier::importing {
namespace {

using mesh_io::InputStream;
using mesh_io::MeshKind;
using Path = std::filesystem::path;

class AnyFileReader final : public FileReader {
 public:
  AnyFileReader(InputFiles& input, const ImportEnvironment& environment, RawMesh& mesh)
      : input_(input),
        env_(environment),
        room_{environment.scratch, environment.sort_bytes, environment.cancel},
        named_(input.system()),
        mesh_(mesh),
        gltf_(input, room_) {}

  void look_for_decoders() override {
    const bool may_lack = input_.textures() == Textures::use &&
                          std::ranges::any_of(input_.all(), &InputFileFacts::names_ktx2) &&
                          !images::missing_for_ktx2().empty();
    for (const InputFileFacts& file : input_.all()) {
      if (may_lack && file.names_ktx2)
        gltf_.look_for_pictures(file);
    }
  }

  /// Requires a kind that files have: the tiles of a tileset are files of their own.
  AddedFile read(const InputFileFacts& facts, const Path& room) override {
    AddedFile added = read_by_kind(facts, room);
    complete_objects(facts);
    return added;
  }

  void unpack(const InputFileFacts& facts, TemporaryFile& to) override {
    read_stream(facts, [&](InputStream& stream) {
      const auto file = env_.files.create(to.path());
      std::vector<std::byte> buffer(std::size_t{1} << 20);
      std::uint64_t offset = 0;
      for (std::size_t count = buffer.size(); count == buffer.size(); offset += count) {
        count = stream.read(buffer);
        file->write_at(offset, std::span(buffer).first(count));
      }
    });
    to.counted();
  }

  void read_run(std::span<const InputFileFacts> files,
                const std::function<void(const AddedFile&)>& added) override {
    if (files[0].format.kind == MeshKind::osgb)
      return read_osgb(files, added);
    // Blocks of spools, windows, the buffers of a decoder.
    constexpr std::uint64_t kItemBytes = std::uint64_t{4} << 20;
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

  Terrain read_terrain() override {
    for (const InputFileFacts& file : input_.all())
      facts_.checksums.push_back(checksum_of(file.path));
    return count_terrain(input_.bytes());
  }

 private:
  AddedFile read_by_kind(const InputFileFacts& facts, const Path& room) {
    const std::uint64_t before = mesh_.vertex_count();
    for (const Reader& reader : readers()) {
      if (reader.kind != facts.format.kind)
        continue;
      AddedFile added = (this->*reader.read)(facts, room);
      next_vertex(mesh_, facts.path, 0);
      note(added);
      added.vertices = mesh_.vertex_count() - before;
      return added;
    }
    throw Error(ErrorCode::internal, facts.path.string() + " is of a format without a reader");
  }

  /// Counts and warns as a file's reader says.
  void note(const AddedFile& added) {
    facts_.near_apart += added.near_apart;
    add_all(added.counts);
    for (const std::string& warning : added.warnings)
      env_.progress.warn(warning);
  }
  void add_all(const std::vector<SourceCount>& counts) {
    for (const SourceCount& one : counts)
      add_count(facts_.counts, one.name, one.count);
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

  using AddStream = AddedFile (AnyFileReader::*)(InputStream& stream, const Path& path);

  /// The way in which a file of a kind is read. `room`: a path where a file may be while it is
  /// read.
  struct Reader {
    MeshKind kind;
    AddedFile (AnyFileReader::*read)(const InputFileFacts& facts, const Path& room);
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
    facts_.checksums.push_back(checksum.complete(*file, [this] { env_.cancel.check(); }));
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
      added.count(mesh_io::OddSyntax{.bytes_behind = text.padding()});
    });
    return added;
  }

  std::unique_ptr<mesh_io::PlySource> open_ply(std::unique_ptr<storage::File> file) const {
    return mesh_io::make_ply_source(std::move(file), {.unplaced = mesh_io::Unplaced::visited,
                                                      .attributes = input_.attributes()});
  }

  /// Unpacks a file to `room`, and returns read(file).
  template <class Read>
  AddedFile read_unpacked(const InputFileFacts& facts, const Path& room, const Read& read) {
    TemporaryFile unpacked(env_.files, room, env_.scratch.pool().scratch_use());
    unpack(facts, unpacked);
    return read(mesh_io::renamed(env_.files.open(room), facts.unpacked_name()));
  }

  AddedFile read_ply(const InputFileFacts& facts, const Path& room) {
    if (facts.format.is_gzip) {
      return read_unpacked(facts, room, [&](std::unique_ptr<storage::File> file) {
        return add_ply(*open_ply(std::move(file)), facts.path);
      });
    }
    const auto source = open_ply(input_.system().open(facts.path));
    AddedFile added = add_ply(*source, facts.path);
    facts_.checksums.push_back(source->checksum([this] { env_.cancel.check(); }));
    env_.progress.advance(facts.identity.bytes);
    return added;
  }

  AddedFile add_ply(mesh_io::PlySource& source, const Path& path) {
    return import_ply(source, path, {input_.textures(), input_.crop()}, mesh_, named_, room_);
  }

  AddedFile read_gltf(const InputFileFacts& facts, const Path& room) {
    if (facts.format.is_gzip) {
      return read_unpacked(facts, room, [&](std::unique_ptr<storage::File> file) {
        return gltf_.import(facts, std::move(file), mesh_);
      });
    }
    const ReadContent content = gltf_.read(facts);
    AddedFile added = gltf_.import(facts, content.file, mesh_);
    note_checksum(facts, content.checksum);
    env_.progress.advance(facts.identity.bytes);
    return added;
  }

  void note_checksum(const InputFileFacts& facts, std::optional<std::uint64_t> known) {
    facts_.checksums.push_back(known ? *known : checksum_of(facts.path));
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

  std::unique_ptr<MeshApart> make_apart() {
    auto apart = std::make_unique<MeshApart>(env_.scratch);
    if (mesh_.objects)
      apart->mesh.objects = std::make_unique<MeshObjects>(env_.scratch, mesh_.objects->choice);
    return apart;
  }

  std::unique_ptr<MeshApart> read_apart(const InputFileFacts& facts) {
    std::unique_ptr<MeshApart> apart = make_apart();
    const ReadContent content = gltf_.read(facts);
    apart->added = gltf_.import(facts, content.file, apart->mesh);
    apart->checksum = content.checksum;
    return apart;
  }

  /// Moves a mesh behind all others.
  AddedFile append_apart(MeshApart& apart, const Path& path) {
    const std::uint64_t vertices = apart.mesh.vertex_count();
    next_vertex(mesh_, path, vertices);
    apart.mesh.layout = apart.added.layout;
    append_mesh(std::move(apart.mesh), mesh_, env_.cancel);
    note(apart.added);
    apart.added.vertices = vertices;
    return std::move(apart.added);
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
                       apart->added = import_gltf(file, {place, true}, apart->mesh,
                                                  input_.textures(), input_.attributes(), room_);
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
    facts_.checksums.push_back(checksum_of(path));
    facts_.tiles.add_all(facts.tiles);
    add_all(facts.counts);
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

  Terrain count_terrain(std::uint64_t bytes) {
    TerrainImport import = import_terrain(input_, bytes, env_);
    add_all(import.counts);
    return std::move(import.terrain);
  }

  /// Reads all rasters with the first of them.
  AddedFile read_raster(const InputFileFacts& facts, const Path& /*room*/) {
    facts_.checksums.push_back(checksum_of(facts.path));
    const auto is_raster = [](const InputFileFacts& file) { return file.format.row().is_raster; };
    if (&facts != &*std::ranges::find_if(input_.all(), is_raster))
      return {};
    const auto source = open_terrain(count_terrain(facts.identity.bytes));
    const std::uint32_t base = next_vertex(mesh_, facts.path, source->description().vertex_count);
    AddedFile added;
    source->read_vertices([&](const mesh_io::VertexBlock& block) {
      env_.cancel.check();
      mesh_.positions.append(block.exact);
      added.fits_float = added.fits_float && block.fits_float();
    });
    added.faces = source
                      ->read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
                        env_.cancel.check();
                        append_triangles(triangles, base, mesh_);
                      })
                      .faces;
    return added;
  }

  AddedFile add_obj(InputStream& stream, const Path& path) {
    return import_obj(stream, path, mesh_, named_, input_.textures(), input_.attributes(), room_);
  }
  template <StlForm form>
  AddedFile add_stl(InputStream& stream, const Path& path) {
    return import_stl(form, stream, path, mesh_, room_);
  }
  AddedFile add_off(InputStream& stream, const Path& path) {
    return import_off(stream, path, mesh_, room_);
  }

  InputFiles& input_;
  const ImportEnvironment& env_;
  ImportRoom room_;
  mesh_io::NamedFiles named_;
  RawMesh& mesh_;
  GltfReader gltf_;
  std::map<Path, std::uint64_t> checked_;  ///< files of glTF and OSGB
};

std::span<const AnyFileReader::Reader> AnyFileReader::readers() {
  static constexpr auto kReaders = std::to_array<Reader>({
      {MeshKind::ply, &AnyFileReader::read_ply},
      {MeshKind::obj, &AnyFileReader::read_text<&AnyFileReader::add_obj>},
      {MeshKind::gltf, &AnyFileReader::read_gltf},
      {MeshKind::glb, &AnyFileReader::read_gltf},
      {MeshKind::b3dm, &AnyFileReader::read_gltf},
      {MeshKind::stl_binary, &AnyFileReader::read_bytes<&AnyFileReader::add_stl<StlForm::binary>>},
      {MeshKind::stl_text, &AnyFileReader::read_text<&AnyFileReader::add_stl<StlForm::text>>},
      {MeshKind::off, &AnyFileReader::read_text<&AnyFileReader::add_off>},
      {MeshKind::geotiff, &AnyFileReader::read_raster},
      {MeshKind::hgt, &AnyFileReader::read_raster},
      {MeshKind::asc, &AnyFileReader::read_raster},
  });
  return kReaders;
}

}  // namespace

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

std::unique_ptr<FileReader> make_file_reader(InputFiles& input,
                                             const ImportEnvironment& environment, RawMesh& mesh) {
  return std::make_unique<AnyFileReader>(input, environment, mesh);
}

}  // namespace meshhier::importing
