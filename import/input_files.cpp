#include "import/input_files.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "hierarchy/image_format.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_folder.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/osgb_file.h"
#include "mesh_io/osgb_folder.h"
#include "mesh_io/part_of_file.h"
#include "mesh_io/ply_header.h"
#include "mesh_io/ply_source.h"
#include "storage/io/file_checksum.h"
#include "storage/io/hash.h"
#include "storage/io/paths.h"
#include "storage/io/process.h"

#include <algorithm>
#include <bit>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {

namespace {

// The longest names in messages.
constexpr std::size_t kLongestPath = 4096;
constexpr std::size_t kLongestUnused = 100;

std::optional<mesh_io::PlyPlan> plan_of(const storage::File& file,
                                        const mesh_io::AttributeChoice& attributes) {
  std::string start(mesh_io::kMaxHeaderBytes, '\0');
  const auto stream = mesh_io::open_stream({file, file.size()}, {});
  start.resize(stream->read(std::as_writable_bytes(std::span(start))));
  return mesh_io::plan_of(start, file.path(), attributes);
}

}  // namespace

std::unique_ptr<storage::File> InputFileFacts::content(storage::FileSystem& files) const {
  return tile && tile->data ? mesh_io::file_of_bytes(path, tile->data) : files.open(path);
}

std::filesystem::path without_gz(std::filesystem::path path) {
  return path.extension() == ".gz" ? path.replace_extension() : path;
}

bool has_corner_attributes(const mesh_io::PlyPlan& plan, Textures textures) {
  return plan.face_colour != ColourType::none || !plan.face_values.empty() ||
         (textures == Textures::use && plan.texcoords != mesh_io::PlyTexcoords::none);
}

InputFiles::InputFiles(storage::FileSystem& files, const mesh_io::InputPaths& paths,
                       const InputUse& use)
    : files_(files.input()), named_(paths), use_(use) {
  for (const std::filesystem::path& path : paths)
    std::ranges::for_each(mesh_io::meshes_of(files_, path).meshes,
                          [this](const auto& mesh) { add_mesh(mesh); });
  join_rasters();
  add_object_table();
  find_common_folder();
  number_parts();
  std::ranges::sort(tileset_counts_, {}, &SourceCount::name);
}

void InputFiles::add_mesh(const std::filesystem::path& path) {
  const auto file = files_.open(path);
  const mesh_io::MeshFormat format = mesh_io::detect_format(*file);
  if (format.kind == mesh_io::MeshKind::tileset)
    return add_tileset(path);
  if (format.kind == mesh_io::MeshKind::osgb)
    return add_osgb(path, format);
  add_file({path, format, files_.identity(path)}, *file);
}

/// Adds a tile, and the files beside it that look like finer ones: an import tells which of them
/// it reads.
void InputFiles::add_osgb(const std::filesystem::path& path, const mesh_io::MeshFormat& format) {
  if (const std::string missing = mesh_io::missing_for_osgb(); !missing.empty())
    throw Error(ErrorCode::io, mesh_io::file_message(path, missing));
  all_.push_back({path, format, files_.identity(path)});
  for (const std::filesystem::path& tile : mesh_io::osgb_family(files_, path))
    companions_.add({tile, InputPart::tile, files_.identity(tile)});
}

void InputFiles::join_rasters() {
  std::vector<std::filesystem::path> rasters;
  for (const InputFileFacts& file : all_) {
    if (file.format.row().is_raster)
      rasters.push_back(file.path);
  }
  if (!use_.drape.empty() && (rasters.size() != all_.size() || is_changed())) {
    throw Error(ErrorCode::usage,
                "texture.drape: an orthophoto lies on rasters of heights alone, "
                "without other meshes, \"crop\" and \"weld\"");
  }
  if (rasters.empty())
    return;
  storage::allow_many_open_files();  // each raster stays open
  mosaic_ = std::make_shared<const mesh_io::Mosaic>(files_, rasters);
  for (std::string& warning : mosaic_->warnings())
    warnings_.push_back(std::move(warning));
  warn_of_heights();
}

void InputFiles::warn_of_heights() {
  const std::string& crs = mosaic_->keys().crs;
  if (crs == use_.crs || geodesy::horizontal_code(crs) != use_.crs)
    return;
  warnings_.push_back(mesh_io::file_message(
      mosaic_->path(), "its heights are those of " + crs +
                           ", for which PROJ has no grid, or which placement.crs leaves out: they "
                           "are taken to be above the ellipsoid, which may be tens of metres off"));
}

bool InputFiles::asks_for_objects() const {
  using mesh_io::ObjectSource;
  return use_.objects.from > ObjectSource::none || !use_.object_table.empty();
}

void InputFiles::add_object_table() {
  if (asks_for_objects() && is_terrain()) {
    throw Error(ErrorCode::usage,
                "objects: rasters of heights have none; say \"none\", without a table");
  }
  if (!use_.object_table.empty())
    companions_.add({use_.object_table, InputPart::table, files_.identity(use_.object_table)});
}

void InputFiles::find_common_folder() {
  for (const InputFileFacts& file : all_) {
    const std::filesystem::path folder = file.path.parent_path();
    if (&file == &all_.front())
      common_folder_ = folder;
    const auto differ = std::ranges::mismatch(common_folder_, folder);
    std::filesystem::path common;
    for (auto part = common_folder_.begin(); part != differ.in1; ++part)
      common /= *part;
    common_folder_ = common;
  }
}

/// A composite holds several tiles, and a tileset may show a file in several places.
void InputFiles::number_parts() {
  std::map<std::filesystem::path, std::size_t> counts;
  for (const InputFileFacts& file : all_)
    counts[file.path] += file.tile ? 1 : 0;
  std::erase_if(counts, [](const auto& one) { return one.second < 2; });
  std::map<std::filesystem::path, std::size_t> numbers;
  for (InputFileFacts& file : all_) {
    if (file.tile && counts.contains(file.path))
      file.part = ++numbers[file.path];
  }
}

std::string InputFiles::object_name(const std::filesystem::path& mesh) const {
  const std::filesystem::path way = mesh.lexically_relative(common_folder_);
  return (way.empty() ? mesh : way).generic_string();
}

bool InputFiles::is_terrain() const {
  return !is_changed() && std::ranges::all_of(all_, [](const InputFileFacts& file) {
    return file.format.row().is_raster;
  });
}

void InputFiles::add_file(InputFileFacts facts, const storage::File& file) {
  if (facts.format.kind == mesh_io::MeshKind::ply)
    look_into_ply(file, facts);
  const auto& outline = facts.format.row().outline;
  add_outlined(std::move(facts), outline == nullptr ? mesh_io::MeshOutline() : outline(file));
}

/// Adds a file, and the buffers that it names and that are there.
void InputFiles::add_outlined(InputFileFacts facts, const mesh_io::MeshOutline& outline) {
  facts.names_ktx2 = outline.names_ktx2;
  all_.push_back(std::move(facts));
  for (const std::filesystem::path& path : outline.buffers) {
    if (files_.kind(path) == storage::FileKind::regular)
      companions_.add({path, InputPart::buffer, files_.identity(path)});
  }
}

void InputFiles::add_tileset(const std::filesystem::path& path) {
  mesh_io::Tileset tileset =
      mesh_io::read_tileset(files_, path, frame_ ? &*frame_ : nullptr, use_.tileset);
  frame_ = tileset.frame;
  if (tileset.meshes.empty())
    mesh_io::fail_file(path, "is a tileset without a mesh in its finest tiles");
  companions_.add({path, InputPart::tileset, files_.identity(path)});
  for (const std::filesystem::path& document : tileset.documents)
    companions_.add({document, InputPart::tileset, files_.identity(document)});
  for (mesh_io::TilesetMesh& mesh : tileset.meshes) {
    const mesh_io::MeshOutline outline = std::exchange(mesh.outline, {});
    InputFileFacts facts{std::exchange(mesh.file, {}), mesh.format, {}};
    facts.identity = files_.identity(facts.path);
    facts.tile = std::move(mesh);
    add_outlined(std::move(facts), outline);
  }
  if (tileset.is_hierarchy) {
    warnings_.push_back(
        plain_text(path.string(), kLongestPath) +
        " belongs to a hierarchy, of which triangles at the borders of tiles come several times: "
        "`meshhier export` gives its mesh as it was");
  }
  const auto note = [&](const char* name, std::uint64_t count, const char* what) {
    add_count(tileset_counts_, name, count);
    if (count > 0 && what != nullptr)
      warnings_.push_back(fmt::format("{}: {} left out: only tiles of meshes are read",
                                      plain_text(path.string(), kLongestPath),
                                      counted(count, what)));
  };
  note("coarser_tiles", tileset.coarser, nullptr);
  note("ignored_instanced_tiles", tileset.instanced, "i3dm tiles");
  note("ignored_point_tiles", tileset.points, "point tiles");
  note("ignored_vector_tiles", tileset.vectors, "vector tiles");
}

void InputFiles::look_into_ply(const storage::File& file, InputFileFacts& facts) {
  const std::optional<mesh_io::PlyPlan> plan = plan_of(file, use_.attributes);
  if (!plan)
    return;
  facts.has_corner_attributes = importing::has_corner_attributes(*plan, use_.textures);
  facts.face_values = plan->face_values.size() + (plan->face_colour == ColourType::none ? 0 : 1);
  for (const std::string& name : plan->unused) {
    if (known_unused_.insert(name).second)
      unused_.push_back(name);
  }
  if (use_.textures == Textures::ignore)
    return;
  for (const std::string& picture : plan->unused_pictures) {
    warnings_.push_back(fmt::format(
        "{} names the picture {}, but {}: it is not used",
        plain_text(facts.path.string(), kLongestPath), plain_text(picture, kLongestPath),
        plan->texture_files.empty() ? "has no texture coordinates" : "no face of it can show it"));
  }
  if (plan->texcoords == mesh_io::PlyTexcoords::none && plan->unused_pictures.empty() &&
      (plan->attributes.texcoords || plan->has_unnamed_texcoords))
    look_for_picture(facts);
}

/// A picture beside may be the mesh's texture, or of anything else, as a photograph of the object.
void InputFiles::look_for_picture(const InputFileFacts& facts) {
  std::filesystem::path name = without_gz(facts.path);
  for (const std::string_view ending : unnamed_picture_endings()) {
    name.replace_extension(ending);
    if (files_.kind(name) != storage::FileKind::regular)
      continue;
    const std::string picture = plain_text(name.filename().string(), kLongestPath);
    warnings_.push_back(fmt::format(
        "{} has texture coordinates but names no picture: {} beside it is not used; if it is its "
        "texture, add the line 'comment TextureFile {}' to the header",
        plain_text(facts.path.string(), kLongestPath), picture, picture));
    return;
  }
}

std::optional<Unit> InputFiles::units() const {
  const bool in_metres = std::ranges::all_of(all_, [this](const InputFileFacts& file) {
    return file.format.row().is_raster ? mosaic_->is_in_metres() : file.format.row().in_metres;
  });
  return in_metres ? std::optional(Unit::m) : std::nullopt;
}

std::vector<std::string> InputFiles::unused() const {
  std::vector<std::string> names;
  for (const std::string& name : std::span(unused_).first(std::min(unused_.size(), kMostUnused)))
    names.push_back(plain_text(name, kLongestUnused));
  if (unused_.size() > kMostUnused)
    names.push_back(fmt::format("{} more", unused_.size() - kMostUnused));
  return names;
}

bool InputFiles::recall(const InputRecord& earlier) {
  const auto is_there = [this](const std::filesystem::path& path) {
    return files_.kind(path) == storage::FileKind::regular;
  };
  if (std::ranges::any_of(earlier.awaited, is_there))
    return false;
  // The picture of heights is named by the config, not by the files.
  const auto is_other = [this](const ReadFile& file) {
    return file.part == InputPart::picture && file.path != drape();
  };
  const bool has_drape =
      std::ranges::find(earlier.files, drape(), &ReadFile::path) != earlier.files.end();
  if (mosaic_ && (has_drape == drape().empty() || std::ranges::any_of(earlier.files, is_other)))
    return false;
  // So is the table of objects.
  const auto table = std::ranges::find(earlier.files, InputPart::table, &ReadFile::part);
  if ((table == earlier.files.end() ? std::filesystem::path() : table->path) != object_table())
    return false;
  CompanionFiles now;
  now.await(earlier.awaited);
  for (const ReadFile& file : earlier.files) {
    if (file.part == InputPart::mesh)
      continue;
    if (!is_there(file.path))
      return false;
    now.add({file.path, file.part, files_.identity(file.path)});
  }
  companions_ = std::move(now);
  return true;
}

std::string InputFiles::name() const {
  std::string name;
  const std::size_t count = named_.size();
  const std::size_t listed = count <= kMostListedMeshes ? count : kMostListedMeshes - 1;
  for (std::size_t i = 0; i < listed; ++i) {
    name += name.empty() ? "" : ", ";
    name += storage::without_last_slash(named_[i]).filename().string();
  }
  if (listed < count)
    name += fmt::format(" and {} more", count - listed);
  return name;
}

std::string InputFiles::formats() const {
  std::vector<std::pair<std::string, std::size_t>> runs;
  for (const InputFileFacts& file : all_) {
    std::string name = name_of(file.format);
    if (runs.empty() || runs.back().first != name)
      runs.emplace_back(std::move(name), 0);
    ++runs.back().second;
  }
  std::string text;
  for (const auto& [name, count] : runs) {
    text += text.empty() ? "" : ", ";
    text += count > 1 ? fmt::format("{} x {}", name, count) : name;
  }
  return text;
}

std::string InputFiles::imported_name() const {
  return is_unpacked_only() ? all_[0].unpacked_name() : named_.string() + " (imported)";
}

std::uint64_t InputFiles::bytes() const {
  std::uint64_t bytes = 0;
  for_each_file([&](const auto&, InputPart, const auto& file) { bytes += file.bytes; });
  return bytes;
}

std::uint64_t InputFiles::geometry_bytes() const {
  std::uint64_t bytes = 0;
  for_each_file([&](const auto&, InputPart part, const auto& file) {
    bytes += part <= InputPart::buffer || part == InputPart::tile ? file.bytes : 0;
  });
  return bytes;
}

std::int64_t InputFiles::times() const {
  std::vector<std::int64_t> times;
  for_each_file([&](const auto&, InputPart, const storage::FileIdentity& file) {
    times.insert(times.end(), {file.modified_ns, file.changed_ns});
  });
  return std::bit_cast<std::int64_t>(storage::checksum(std::as_bytes(std::span(times))));
}

std::uint64_t InputFiles::held_bytes() const {
  // Facts of a file, of its place in the record and in the joined mesh, as measured; its name in
  // both, and in the directory of an archive.
  constexpr std::uint64_t kFileBytes = 640;
  constexpr std::uint64_t kNames = 3;
  constexpr std::uint64_t kUncounted = std::uint64_t{1} << 20;
  std::uint64_t bytes = 0;
  for_each_file([&](const std::filesystem::path& path, InputPart, const auto&) {
    bytes += kFileBytes + kNames * path.native().size();
  });
  return bytes < kUncounted ? 0 : bytes;
}

void InputFiles::check_unchanged() const {
  for_each_file([&](const std::filesystem::path& path, InputPart, const auto& identity) {
    if (files_.identity(path) != identity) {
      throw Error(ErrorCode::input,
                  path.string() + " was changed while it was read; build it again");
    }
  });
}

std::uint64_t InputFiles::checksum(const execution::CancelToken& cancel) const {
  std::vector<std::uint64_t> meshes;
  for (const InputFileFacts& file : all_)
    meshes.push_back(checksum_of(file.path, cancel));
  return joined_checksum(describe(record(meshes, cancel, [](const CompanionFile&) {})));
}

std::uint64_t InputFiles::checksum_of(const std::filesystem::path& path,
                                      const execution::CancelToken& cancel) const {
  const auto file = files_.open(path);
  return storage::FileChecksum(file->size()).complete(*file, [&] { cancel.check(); });
}

InputRecord InputFiles::record(const std::vector<std::uint64_t>& meshes,
                               const execution::CancelToken& cancel,
                               const std::function<void(const CompanionFile&)>& visit) const {
  InputRecord record{{}, companions_.awaited()};
  for (std::size_t i = 0; i < all_.size(); ++i)
    record.files.push_back({all_[i].path, InputPart::mesh, all_[i].identity, meshes[i]});
  for (const CompanionFile& file : companions_.files()) {
    record.files.push_back({file.path, file.part, file.identity, checksum_of(file.path, cancel)});
    visit(file);
  }
  std::ranges::stable_sort(record.files, {}, &ReadFile::part);
  return record;
}

std::vector<SourceFile> InputFiles::describe(const InputRecord& record) const {
  std::vector<std::string> formats;
  for (const InputFileFacts& file : all_)
    formats.push_back(name_of(file.format));
  return source_files(record.files, formats);
}

}  // namespace meshhier::importing
