#include "import/mesh_input.h"

#include "execution/parallel.h"
#include "import/find_copies.h"
#include "import/gltf_values.h"
#include "mesh_io/ply_source.h"
#include "mesh_io/renamed_file.h"

#include <algorithm>
#include <utility>

namespace meshhier::importing {
namespace {

std::uint64_t count_between(const std::vector<std::uint64_t>& tile_ends, const CopyList& copies,
                            const execution::CancelToken& cancel) {
  if (tile_ends.empty())
    return 0;
  const auto tile_of = [&](std::uint32_t vertex) {
    return std::ranges::upper_bound(tile_ends, vertex) - tile_ends.begin();
  };
  std::uint64_t count = 0;
  copies.for_each(
      [&] { cancel.check(); },
      [&](const CopyVertex& copy) { count += tile_of(copy.first) != tile_of(copy.id) ? 1 : 0; });
  return count;
}

}  // namespace

MeshInput::MeshInput(const mesh_io::InputPaths& paths, storage::FileSystem& files,
                     const InputUse& use)
    : system_(files), input_(files, paths, use) {
  if (needs_import())
    return;
  in_place_ = mesh_io::open_mesh(files.input(), paths[0], use.attributes);
  description_ = in_place_->description();
}

void MeshInput::import(const Place& place) {
  storage::ScratchFile scratch(system_, place.scratch, place.pool);
  ply_.emplace(system_, place.ply, place.pool.scratch_use());
  const std::filesystem::path beside = place.ply.string() + "-objects";
  if (place.objects.empty())
    objects_.emplace(system_, beside, place.pool.scratch_use());
  facts_ = import_input(input_, *ply_,
                        {system_, scratch, place.sort_bytes, place.progress, place.cancel,
                         objects_ ? beside : place.objects});
  description_ = open_imported()->description();
  description_.held_bytes += input_.held_bytes();
}

void MeshInput::note_unplaced() {
  input_.note_unplaced();
  in_place_.reset();
}

void MeshInput::find_copies(const Place& place) {
  try {
    return look_for_copies(place);
  } catch (const mesh_io::UnplacedVertexError&) {
    if (input_.has_unplaced())
      throw;
  }
  note_unplaced();
  ply_.reset();
  import(place);
  look_for_copies(place);
}

void MeshInput::look_for_copies(const Place& place) {
  place.progress.stage("import", description_.vertex_count, "vertices");
  const std::unique_ptr<mesh_io::MeshSource> imported = in_place_ ? nullptr : open_imported();
  mesh_io::MeshSource& source = in_place_ ? *in_place_ : *imported;
  using storage::ScratchFile;
  copy_scratch_.emplace(system_, place.copies, place.pool);
  if (source.description().place_count == source.description().vertex_count)
    return;
  ScratchFile scratch(system_, place.scratch, place.pool, ScratchFile::Stays::no,
                      ScratchFile::Files::one_a_thread);
  const std::uint64_t memory = place.sort_bytes;
  copies_ = importing::find_copies(
      source, *copy_scratch_,
      {scratch, memory, execution::useful_blocks(memory, look_block_bytes(description_)),
       place.progress, place.cancel});
  description_.place_count = description_.vertex_count - copies_.count();
  copies_between_tiles_ = count_between(facts_.tile_ends, copies_, place.cancel);
}

void MeshInput::recall(const mesh_io::MeshDescription& found) {
  if (!needs_import() && found.vertex_count < description_.vertex_count)
    note_unplaced();
  if (needs_import())
    description_ = found;
  if (input_.is_terrain())
    description_.held_bytes = input_.mosaic()->held_bytes();
  if (needs_import())
    description_.held_bytes += input_.held_bytes();
  description_.place_count = found.place_count;
}

bool MeshInput::is_sure_label(const std::string& name) const {
  const auto names_features = [](const InputFileFacts& file) {
    return file.format.row().names_features;
  };
  const auto& values = description_.attributes.values;
  const auto is_object = [&](const ScalarAttribute& value) {
    return value.is_object && value.name == name;
  };
  return facts_.label_names.contains(name) || std::ranges::any_of(values, is_object) ||
         (is_feature_name(name) && std::ranges::any_of(input_.all(), names_features));
}

void MeshInput::drop() {
  ply_.reset();
  objects_.reset();
  facts_.terrain.reset();
  if (input_.mosaic())
    input_.mosaic()->release();
  copies_ = {};
  copy_scratch_.reset();
}

std::unique_ptr<mesh_io::MeshSource> MeshInput::open() {
  return needs_import() ? open_imported() : std::move(in_place_);
}

std::unique_ptr<mesh_io::MeshSource> MeshInput::open_imported() {
  if (facts_.terrain)
    return open_terrain(*facts_.terrain);
  return mesh_io::make_ply_source(
      mesh_io::renamed(system_.open(ply_->path()), input_.imported_name()),
      {.writer = facts_.writer, .attributes = input_.attributes()});
}

InputRecord MeshInput::record(std::uint64_t checksum) const {
  if (needs_import())
    return facts_.record;
  const InputFileFacts& file = input_.all()[0];
  return {{{file.path, InputPart::mesh, file.identity, checksum}}, {}};
}

std::uint64_t MeshInput::checksum(const execution::CancelToken& cancel) {
  if (!facts_.files.empty())
    return joined_checksum(facts_.files);
  return in_place_ ? in_place_->checksum([&] { cancel.check(); }) : input_.checksum(cancel);
}

}  // namespace meshhier::importing
