#include "mesh_io/osgb_tiles.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace meshhier::mesh_io {
namespace {

using Path = std::filesystem::path;

/// Returns whether a path, as it is written, lies in the folder or below.
bool is_below(const Path& path, const Path& folder) {
  const Path way = path.lexically_normal().lexically_relative(
      folder.empty() ? Path(".") : folder.lexically_normal());
  return !way.empty() && *way.begin() != "..";
}

/// Returns a byte for each name, as OsgbFile::tile() takes them.
std::vector<std::byte> present_of(const std::vector<Path>& found) {
  std::vector<std::byte> present;
  for (const Path& one : found)
    present.push_back(std::byte{one.empty() ? std::uint8_t{0} : std::uint8_t{1}});
  return present;
}

}  // namespace

/// Returns the file of each name; an empty path if there is none.
std::vector<Path> OsgbTiles::find_files(const Path& path, const std::vector<std::string>& names) {
  const std::lock_guard lock(looking_);
  const Path folder = path.parent_path();
  std::vector<Path> found;
  for (const std::string& name : names) {
    auto file = named_.find(folder, name);
    if (file && !is_below(*file, folder))
      file = named_.find(folder, Path(name).filename().string());
    found.push_back(file && is_below(*file, folder) ? *file : Path());
  }
  return found;
}

OsgbRead OsgbTiles::read(const Path& path) {
  OsgbFile file(*files_.open(path), most_bytes_);
  std::vector<std::string> names = file.names();
  std::vector<Path> found = find_files(path, names);
  OsgbTile tile = file.tile(present_of(found));
  return {std::move(file), std::move(names), std::move(found), std::move(tile)};
}

std::vector<std::byte> picture_of(const OsgbRead& read, std::uint64_t offset) {
  return read.file.picture(present_of(read.found), offset);
}

std::vector<OsgbFinerFile> finer_files(const OsgbRead& read) {
  std::vector<OsgbFinerFile> files;
  for (const OsgbFiner& one : read.tile.finer)
    files.push_back({read.found[one.name], one.place});
  return files;
}

std::vector<Path> missing_places(const Path& path, const OsgbRead& read) {
  std::vector<Path> all;
  for (std::size_t i = 0; i < read.names.size(); ++i) {
    if (!read.found[i].empty())
      continue;
    const std::vector<Path> places = sought_places(path.parent_path(), read.names[i]);
    all.insert(all.end(), places.begin(), places.end());
  }
  return all;
}

}  // namespace meshhier::mesh_io
