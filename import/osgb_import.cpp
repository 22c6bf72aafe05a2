#include "import/osgb_import.h"

#include "base/plain_text.h"
#include "mesh_io/input_error.h"
#include "mesh_io/osgb_tiles.h"
#include "mesh_io/part_of_file.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// Returns where a range of the GLB lies in the OSGB as it is, as pictures that are files do.
std::optional<std::uint64_t> find_in_file(const mesh_io::OsgbShown& shown, std::uint64_t offset,
                                          std::uint64_t bytes) {
  if (shown.file.is_packed() || bytes == 0)
    return std::nullopt;
  const std::span<const std::byte> all = shown.file.bytes();
  // Linear, whatever the bytes are.
  const void* const found =
      ::memmem(all.data(), all.size(), shown.tile.glb->data() + offset, bytes);
  if (found == nullptr)
    return std::nullopt;
  return static_cast<std::uint64_t>(static_cast<const std::byte*>(found) - all.data());
}

std::vector<std::string> warnings_of(const std::filesystem::path& path,
                                     const mesh_io::OsgbCounts& counts) {
  std::vector<std::string> warnings;
  if (counts.missing > 0) {
    warnings.push_back(mesh_io::file_message(
        path, fmt::format("{} that tiles name {} not there (the first is {}): coarser ones stand "
                          "in their place",
                          counted(counts.missing, "files"), counts.missing == 1 ? "is" : "are",
                          counts.first_missing)));
  }
  if (counts.unknown > 0) {
    warnings.push_back(
        mesh_io::file_message(path, counted(counts.unknown, "parts") +
                                        " of kinds that OpenSceneGraph does not know, left out"));
  }
  return warnings;
}

}  // namespace

OsgbImport import_osgb(
    const std::filesystem::path& path, const mesh_io::GltfRoom& room,
    const std::function<void(mesh_io::GltfFile&, const mesh_io::GltfTransform&)>& add,
    const std::function<void(std::uint64_t)>& advance) {
  OsgbImport import;
  constexpr std::uint64_t kInMemory = 3;  // a file, as a question once more, and the answer
  mesh_io::OsgbTiles tiles(room.files, room.memory_bytes / kInMemory);
  tiles.for_each(path, [&](const mesh_io::OsgbShown& shown) {
    room.check();
    if (shown.tile.triangles > 0) {
      mesh_io::GltfRoom own = room;
      own.content = mesh_io::GltfContent::packed;
      own.stored_in = shown.path;
      own.find_plain = [&](std::uint64_t offset, std::uint64_t bytes) {
        return find_in_file(shown, offset, bytes);
      };
      mesh_io::GltfFile file(mesh_io::file_of_bytes(shown.path, shown.tile.glb),
                             shown.path.parent_path(), std::move(own));
      add(file, shown.place);
    }
    const storage::FileIdentity identity = room.files.identity(shown.path);
    if (shown.path != path)
      import.tiles.add({shown.path, InputPart::tile, identity});
    advance(identity.bytes);
  });
  import.tiles.await(tiles.counts().sought);
  add_count(import.counts, "missing_tiles", tiles.counts().missing);
  add_count(import.counts, kPointsAndLines, tiles.counts().others);
  add_count(import.counts, "unknown_parts", tiles.counts().unknown);
  import.warnings = warnings_of(path, tiles.counts());
  return import;
}

}  // namespace meshhier::importing
