#include "import/import_input.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "import/crop_mesh.h"
#include "import/file_reader.h"
#include "import/join_layouts.h"
#include "import/name_objects.h"
#include "import/place_vertices.h"
#include "import/raw_mesh.h"
#include "import/unread_metadata.h"
#include "import/weld.h"
#include "mesh_io/ply_writer.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::uint64_t kImportMiB = std::uint64_t{1} << 20;

/// One build's import.
class Import {
 public:
  Import(InputFiles& input, const ImportEnvironment& environment)
      : input_(input),
        env_(environment),
        room_{environment.scratch, environment.sort_bytes, environment.cancel},
        mesh_(environment.scratch),
        reader_(make_file_reader(input, environment, mesh_)) {
    if (input.objects().from != mesh_io::ObjectSource::none)
      mesh_.objects = std::make_unique<MeshObjects>(environment.scratch, input.objects());
  }

  ImportFacts run(TemporaryFile& ply) {
    reader_->look_for_decoders();
    env_.progress.stage("import", input_.bytes(), "bytes");
    if (input_.is_unpacked_only()) {
      reader_->unpack(input_.all()[0], ply);
    } else if (input_.is_terrain()) {
      facts_.terrain = reader_->read_terrain();
      for (const SourceCount& one : reader_->facts().counts)
        count(one.name, one.count);
    } else {
      add_all(ply);
      for (const SourceCount& one : reader_->facts().counts)
        count(one.name, one.count);
      facts_.faces = faces_;
      if (input_.weld() || input_.crop() || unplaced_.count > 0 || !are_tiles_)
        facts_.tile_ends.clear();
      require_triangles();
      join();
      RawMesh& named = mesh_.objects ? name() : mesh_;
      RawMesh& placed = unplaced_.count > 0 ? place(named) : named;
      RawMesh& piece = input_.crop() ? crop(placed) : placed;
      write(input_.weld() ? weld(piece) : piece, ply);
    }
    for (const SourceCount& one : input_.tileset_counts())
      count(one.name, one.count);
    note_files();
    facts_.terrain ? note_drape() : note_textures();
    facts_.label_names = std::move(mesh_.label_names);
    std::ranges::sort(facts_.counts, {}, &SourceCount::name);
    return std::move(facts_);
  }

 private:
  /// Fails if nothing is left of glTF and tiles: all of their parts may be of kinds that are left
  /// out.
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
    for (const AttributeKindRow& row : kAttributeKinds)
      count(fmt::format("dropped_{}", row.name),
            counts.dropped[static_cast<std::size_t>(row.kind)]);
    count(kMadeWhite, counts.white_vertices);
    count(kHiddenColours, counts.hidden_colours);
    count("converted_colours", counts.converted_colours);
  }

  void count(std::string_view name, std::uint64_t count) { add_count(facts_.counts, name, count); }

  /// Notes the files when all is read. Pictures are read for their checksums, which is little
  /// beside decoding them.
  void note_files() {
    CompanionFiles all = reader_->facts().tiles;
    add_others(all);
    for (const CompanionFile& library : mesh_.materials.companions().files())
      all.add(library);
    const images::MaterialList& materials =
        facts_.terrain ? facts_.terrain->materials : mesh_.materials.list();
    for (const images::ImageSource& picture : materials.images) {
      if (!picture.file.empty() && picture.bytes == 0)
        all.add({picture.file, InputPart::picture, input_.system().identity(picture.file)});
    }
    if (facts_.terrain) {
      for (const std::filesystem::path& path : facts_.terrain->beside)
        all.add({path, InputPart::buffer, input_.system().identity(path)});
    }
    all.await(mesh_.materials.companions().awaited());
    input_.set_companions(std::move(all));
    facts_.record =
        input_.record(reader_->facts().checksums, env_.cancel, [this](const CompanionFile& file) {
          if (file.part == InputPart::buffer ||
              file.part == InputPart::tileset)  // the others were not known when the stage began
            env_.progress.advance(file.identity.bytes);
        });
    facts_.files = input_.describe(facts_.record);
    input_.check_unchanged();
  }

  /// Adds the companions that were known before the import, but for tiles that it did not read: no
  /// file names them.
  void add_others(CompanionFiles& all) {
    std::set<std::filesystem::path> meshes;
    for (const InputFileFacts& file : input_.all())
      meshes.insert(file.path);
    std::uint64_t unnamed = 0;
    std::string first;
    for (const CompanionFile& file : input_.companions().files()) {
      if (file.part != InputPart::tile) {
        all.add(file);
      } else if (!all.has(file.path) && !meshes.contains(file.path)) {
        first = unnamed++ == 0 ? file.path.string() : first;
      }
    }
    all.await(input_.companions().awaited());
    count("unnamed_tiles", unnamed);
    if (unnamed > 0) {
      env_.progress.warn(fmt::format("{} (the first is {}) {} named by no tile, and left out",
                                     counted(unnamed, "files"), first,
                                     unnamed == 1 ? "is" : "are"));
    }
  }

  void note_drape() {
    facts_.materials = facts_.terrain->materials;
    if (!facts_.materials.empty())
      facts_.textures = {.materials = 1, .images = 1};
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

  void add_all(TemporaryFile& ply) {
    std::span<const InputFileFacts> left = input_.all();
    are_tiles_ = left.size() > 1 && std::ranges::all_of(left, [](const InputFileFacts& file) {
                   return file.tile.has_value();
                 });
    while (!left.empty()) {
      const std::size_t run = FileReader::run_of(left);
      if (run > 0)
        reader_->read_run(left.first(run), [&](const AddedFile& added) { note(added); });
      else
        note(reader_->read(left[0], ply.path()));
      left = left.subspan(std::max<std::size_t>(run, 1));
    }
  }

  void note(const AddedFile& added) {
    const std::uint64_t before = facts_.tile_ends.empty() ? 0 : facts_.tile_ends.back();
    facts_.tile_ends.push_back(before + added.vertices);
    count(kMaterialColours, added.material_colours);
    joined_.push_back({added.layout, added.vertices, added.is_painted});
    mesh_.fits_float = mesh_.fits_float && added.fits_float;
    faces_ += added.faces;
    facts_.degenerate_triangles += added.degenerate_triangles;
    if (unplaced_.count == 0)
      unplaced_.first = added.unplaced.first;
    unplaced_.count += added.unplaced.count;
  }

  RawMesh& crop(RawMesh& whole) {
    cropped_.emplace(env_.scratch);
    count("cropped_triangles",
          reader_->facts().near_apart + crop_mesh(whole, *cropped_, *input_.crop(), room_));
    if (cropped_->vertex_count() == 0) {
      throw Error(ErrorCode::usage, "nothing of " + input_.name() +
                                        " lies in the box of \"crop\"; compare it with where the "
                                        "mesh is");
    }
    return *cropped_;
  }

  /// Returns the mesh with its objects; as it is, if it has none.
  RawMesh& name() {
    for (const std::string& warning : warnings_of_metadata(facts_.counts))
      env_.progress.warn(input_.name() + ": " + warning);
    named_.emplace(env_.scratch);
    auto objects =
        name_objects(mesh_, *named_, facts_.tile_ends,
                     {env_.files, input_.name(), input_.object_table(), env_.objects, room_});
    if (!objects)
      return mesh_;
    for (const SourceCount& one : objects->counts)
      count(one.name, one.count);
    std::ranges::for_each(objects->warnings, [&](const auto& text) { env_.progress.warn(text); });
    facts_.objects = std::move(objects->imported);
    return *named_;
  }

  RawMesh& place(RawMesh& mesh) {
    placed_.emplace(env_.scratch);
    const DroppedUnplaced dropped = drop_unplaced(mesh, *placed_, unplaced_.first, room_);
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
  RawMesh mesh_;
  std::unique_ptr<FileReader> reader_;
  std::optional<RawMesh> named_, placed_, cropped_, welded_;
  mesh_io::UnplacedVertices unplaced_;
  std::uint64_t faces_ = 0;
  bool are_tiles_ = false;  ///< all files are, and there are several
  std::vector<JoinedFile> joined_;
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

/// Names the labels among the values that vertices have.
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
  // The counts of an unpacked PLY were made while it was read.
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

ImportMemory plan_import(std::uint64_t memory_budget, std::uint64_t held_bytes) {
  // The program and its allocator, as memory_plan.cpp measured them; blocks and buffers of readers
  // and writers, 12 MiB.
  constexpr std::uint64_t kFixed = 30 * kImportMiB;
  constexpr std::uint64_t kAllocatorParts = 12;
  const std::uint64_t taken = kFixed + held_bytes + memory_budget / kAllocatorParts;
  // A budget that is too small is refused when the mesh is known.
  const std::uint64_t rest = std::max(memory_budget, taken + 4 * kImportMiB) - taken;
  return {rest / 4, rest / 4};
}

std::uint64_t predict_import(const InputFiles& input, const ImportMemory& memory) {
  // The PLY has at most the size of the text or soup. Spools and sorts beside it, but for the pool
  // in memory, take once the size of a text of floats, three times where corners have attributes,
  // and three times that of an STL, whose corners are sorted. They take six times that of a PLY
  // with textured faces: corners are sorted twice, 44 bytes each, and a face has 17. Ten times
  // where faces have values: a face has 14 bytes, and each corner may become a vertex. Gzip packs
  // such files to a third or a quarter.
  constexpr std::uint64_t kSpools = 3;
  constexpr std::uint64_t kCorneredSpools = 6;
  constexpr std::uint64_t kValuedSpools = 10;
  constexpr std::uint64_t kPacked = 4;
  constexpr std::uint64_t kLeastVertexBytes = 12;
  std::uint64_t content = input.geometry_bytes();
  std::uint64_t cornered = 0;  // bytes that such files take beyond kSpools times their size
  if (input.is_terrain())
    return 0;
  if (input.mosaic()) {
    constexpr std::uint64_t kCellBytes = 50;  // as text a vertex and two triangles would have
    content += kCellBytes * input.mosaic()->cells();
  }
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
  // Objects: corners are sorted, and vertices written anew.
  constexpr std::uint64_t kObjectSpools = 4;
  if (input.asks_for_objects())
    cornered += kObjectSpools * content;
  const std::uint64_t spools = input.is_unpacked_only() ? 0 : kSpools * content + cornered;
  return content + spools - std::min(spools, memory.pool_bytes);
}

ImportFacts import_input(InputFiles& input, TemporaryFile& ply,
                         const ImportEnvironment& environment) {
  return Import(input, environment).run(ply);
}

}  // namespace meshhier::importing
