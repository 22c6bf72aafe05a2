#include "mesh_io/osgb_tiles.h"

#include "base/plain_text.h"
#include "mesh_io/input_error.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Path = std::filesystem::path;

constexpr std::uint64_t kMostShown = std::uint64_t{1} << 20;
constexpr std::size_t kDeepest = 100;  ///< there are about 20 levels of detail
constexpr std::size_t kLongestShownName = 255;

/// Returns whether a path, as it is written, lies in the folder or below.
bool is_below(const Path& path, const Path& folder) {
  const Path way = path.lexically_normal().lexically_relative(
      folder.empty() ? Path(".") : folder.lexically_normal());
  return !way.empty() && *way.begin() != "..";
}

}  // namespace

/// A file, the files that its names lead to, and its finest parts where these are there.
struct OsgbTiles::Read {
  Read(OsgbTiles& tiles, const Path& path)
      : file(*tiles.files_.open(path), tiles.most_bytes_), names(file.names()) {
    found = tiles.find_files(path, names);
    std::vector<std::byte> present;
    for (const Path& one : found)
      present.push_back(std::byte{one.empty() ? std::uint8_t{0} : std::uint8_t{1}});
    tile = file.tile(present);
  }

  OsgbFile file;
  std::vector<std::string> names;
  std::vector<Path> found;  ///< of each name; empty: it is not there
  OsgbTile tile;
};

/// Returns the file of each name; an empty path if there is none.
std::vector<Path> OsgbTiles::find_files(const Path& path, const std::vector<std::string>& names) {
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

void OsgbTiles::for_each(const Path& path, const std::function<void(const OsgbShown&)>& visit) {
  std::vector<Path> above;
  walk(path, {}, above, visit);
}

OsgbTile OsgbTiles::tile(const Path& path) {
  return std::move(Read(*this, path).tile);
}

void OsgbTiles::walk(const Path& path, const GltfTransform& place, std::vector<Path>& above,
                     const std::function<void(const OsgbShown&)>& visit) {
  if (std::ranges::find(above, path) != above.end())
    fail_file(above.back(), fmt::format("names {}, which names it: files are in a circle",
                                        plain_text(path.string(), kLongestShownName)));
  if (above.size() > kDeepest)
    fail_file(path, fmt::format("is named by files within each other, deeper than {}", kDeepest));
  if (++shown_ > kMostShown)
    fail_file(path, fmt::format("with it more than {} tiles are shown", kMostShown));
  std::vector<std::pair<Path, GltfTransform>> finer;
  {
    const Read read(*this, path);
    visit({path, read.file, read.tile, place});
    counts_.missing += read.tile.missing;
    counts_.others += read.tile.others;
    counts_.unknown += read.tile.unknown;
    for (std::size_t i = 0; read.tile.missing > 0 && i < read.names.size(); ++i) {
      if (!read.found[i].empty())
        continue;
      const std::vector<Path> places = sought_places(path.parent_path(), read.names[i]);
      counts_.sought.insert(counts_.sought.end(), places.begin(), places.end());
      if (counts_.first_missing.empty())
        counts_.first_missing =
            fmt::format("{} in {}", plain_text(read.names[i], kLongestShownName),
                        plain_text(path.string(), kLongestShownName));
    }
    for (const OsgbFiner& one : read.tile.finer)
      finer.emplace_back(read.found[one.name], place * one.place);
  }
  above.push_back(path);
  for (const auto& [file, there] : finer)
    walk(file, there, above, visit);
  above.pop_back();
}

std::vector<Path> osgb_family(storage::FileSystem& files, const Path& path) {
  const Path folder = path.parent_path();
  const Path looked = folder.empty() ? Path(".") : folder;
  if (!files.can_list(looked))
    return {};
  const std::string stem = path.stem().string();
  const bool is_own_folder = folder.filename() == stem;
  std::vector<Path> family;
  for (const Path& child : files.children(looked)) {
    const std::string name = child.filename().string();
    if (storage::lower_extension(child) == ".osgb" && name != path.filename() &&
        (is_own_folder || name.starts_with(stem + '_')))
      family.push_back(folder / name);
  }
  return family;
}

}  // namespace meshhier::mesh_io
