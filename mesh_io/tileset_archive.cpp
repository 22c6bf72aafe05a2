#include "mesh_io/tileset_archive.h"

#include "mesh_io/input_error.h"
#include "storage/io/zip_files.h"

#include <array>
#include <cstddef>
#include <string>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTilesetName = "tileset.json";

bool has_file(storage::FileSystem& files, const fs::path& path) {
  return files.kind(path) == storage::FileKind::regular;
}

/// Returns the tilesets of the folders in a folder, but for those of hierarchies.
std::vector<fs::path> tilesets_below(storage::FileSystem& files, const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::path& child : files.children(folder)) {
    if (has_file(files, child / kTilesetName) && !has_file(files, child / "hierarchy.json"))
      found.push_back(child / kTilesetName);
  }
  return found;
}

}  // namespace

std::vector<fs::path> tilesets_in(storage::FileSystem& files, const fs::path& folder) {
  if (has_file(files, folder / kTilesetName))
    return {folder / kTilesetName};
  return files.can_list(folder) ? tilesets_below(files, folder) : std::vector<fs::path>();
}

bool is_tileset_archive(storage::FileSystem& files, const fs::path& path) {
  if (!storage::is_3tz_name(path) || !has_file(files, path))
    return false;
  std::array<std::byte, 2> start{};
  files.open(path)->read_at(0, start);
  return start == std::array{std::byte{'P'}, std::byte{'K'}};
}

fs::path tileset_of_archive(storage::FileSystem& files, const fs::path& archive) {
  if (has_file(files, archive / kTilesetName))
    return archive / kTilesetName;
  const std::vector<fs::path> found = tilesets_below(files, archive);
  if (found.size() == 1)
    return found[0];
  if (found.empty())
    fail_file(archive,
              "holds no tileset.json, as a 3D Tiles archive does; pack the folder of one "
              "so that it lies at the top");
  fail_file(
      archive,
      fmt::format("holds several tilesets, the first are {} and {}; unpack it, and name those "
                  "to build",
                  found[0].string(), found[1].string()));
}

}  // namespace meshhier::mesh_io
