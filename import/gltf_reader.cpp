#include "import/gltf_reader.h"

#include "import/gltf_materials.h"
#include "mesh_io/batch_table.h"
#include "mesh_io/input_error.h"
#include "mesh_io/part_of_file.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

mesh_io::GltfContent content_of(const InputFileFacts& facts) {
  if (facts.tile && facts.tile->data)
    return mesh_io::GltfContent::fleeting;
  return facts.format.is_gzip ? mesh_io::GltfContent::packed : mesh_io::GltfContent::stored;
}

}  // namespace

GltfReader::GltfReader(InputFiles& input, const ImportRoom& room)
    : input_(input),
      room_(room),
      decoding_(decoding_bytes()),
      contents_(input.system(), room.sort_bytes / 2, room.cancel) {}

std::uint64_t GltfReader::decoding_bytes() const {
  constexpr std::uint64_t kLeast = std::uint64_t{4} << 20;
  return std::max(2 * room_.sort_bytes, kLeast);
}

mesh_io::GltfFile GltfReader::open(const InputFileFacts& facts,
                                   std::shared_ptr<const storage::File> content) {
  const std::uint64_t offset = facts.tile ? facts.tile->offset : 0;
  if (facts.tile && offset + facts.tile->bytes > content->size())
    mesh_io::fail_file(facts.path, "ends within a tile (truncated?)");
  if (facts.tile)
    content = mesh_io::part_of(std::move(content), offset, facts.tile->bytes);
  return {std::move(content),
          facts.path.parent_path(),
          {input_.system(), room_.scratch, decoding_bytes(), content_of(facts), facts.path,
           [this] { room_.cancel.check(); }, offset,
           [this](std::uint64_t bytes) { return decoding_.share(bytes); }}};
}

std::unique_ptr<mesh_io::FeatureTable> GltfReader::batch_table(
    const std::shared_ptr<const storage::File>& content, const mesh_io::TilesetMesh& tile,
    const RawMesh& mesh, GltfPlace& place) const {
  if (!mesh.objects || !mesh.objects->choice.takes(mesh_io::ObjectSource::feature))
    return nullptr;
  try {
    return mesh_io::open_batch_table(content, tile.batch, decoding_bytes());
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input || !mesh.objects->choice.is_evident())
      throw;
    place.is_batch_unread = true;
    return nullptr;
  }
}

AddedFile GltfReader::import(const InputFileFacts& facts,
                             std::shared_ptr<const storage::File> content, RawMesh& mesh) {
  const mesh_io::TilesetMesh tile = facts.tile.value_or(mesh_io::TilesetMesh{});
  GltfPlace place{tile.placement, facts.tile.has_value()};
  const auto batch = batch_table(content, tile, mesh, place);
  mesh_io::GltfFile file = open(facts, std::move(content));
  if (input_.all().size() > 1)
    place.name = input_.object_name(facts.path) + '/';
  if (facts.part > 0)
    place.name += fmt::format("{}/", facts.part);
  place.batch = batch.get();
  return import_gltf(file, place, mesh, input_.textures(), input_.attributes(), room_);
}

void GltfReader::look_for_pictures(const InputFileFacts& facts) {
  const std::shared_ptr<const storage::File> file = facts.content(input_.system());
  mesh_io::GltfFile gltf = open(facts, facts.format.is_gzip ? mesh_io::unpacked(*file) : file);
  GltfMaterials materials(gltf);
  for (const mesh_io::GltfMesh& mesh : gltf.document().meshes) {
    for (const mesh_io::GltfPrimitive& primitive : mesh.primitives)
      materials.use(primitive.material, false);
  }
}

}  // namespace meshhier::importing
