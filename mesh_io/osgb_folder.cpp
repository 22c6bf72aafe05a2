#include "mesh_io/osgb_folder.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/number_text.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Path = std::filesystem::path;

constexpr const char* kOsgbEnding = ".osgb";

/// A file's name without its ending: the tile's, and the level of a finer one.
struct TileName {
  std::string tile;
  std::optional<std::int64_t> level{};
};

/// Splits "Tile_+000_L18_0": tile "Tile_+000", level 18.
TileName split_name(const std::string& stem) {
  constexpr std::string_view kMark = "_L";
  constexpr std::string_view kDigits = "0123456789";
  const std::size_t mark = stem.rfind(kMark);
  if (mark == std::string::npos || mark == 0)
    return {stem};
  const std::size_t begin = mark + kMark.size();
  const std::size_t end = std::min(stem.find_first_not_of(kDigits, begin), stem.size());
  if (end == begin || (end < stem.size() && stem[end] != '_'))
    return {stem};
  return {stem.substr(0, mark), parse_integer(std::string_view(stem).substr(begin, end - begin))};
}

bool is_osgb(const Path& path) {
  return storage::lower_extension(path) == kOsgbEnding;
}

/// Returns the first files of the tiles that lie in a folder, in the order of their names.
std::vector<Path> loose_tiles(storage::FileSystem& files, const Path& folder) {
  std::map<std::string, std::map<std::int64_t, std::vector<Path>>> tiles;
  constexpr std::int64_t kFirst = -1;
  for (const Path& child : files.children(folder)) {
    if (!is_osgb(child) || files.kind(folder / child.filename()) != storage::FileKind::regular)
      continue;
    const TileName name = split_name(child.stem().string());
    tiles[name.tile][name.level.value_or(kFirst)].push_back(folder / child.filename());
  }
  std::vector<Path> first;
  for (auto& [name, levels] : tiles)
    first.insert(first.end(), levels.begin()->second.begin(), levels.begin()->second.end());
  std::ranges::sort(first);
  return first;
}

bool can_look(storage::FileSystem& files, const Path& folder) {
  return files.is_directory(folder) && files.can_list(folder);
}

std::vector<Path> folders_in(storage::FileSystem& files, const Path& folder) {
  std::vector<Path> folders;
  for (const Path& child : files.children(folder)) {
    const std::string name = child.filename().string();
    if (!name.starts_with('.') && can_look(files, folder / name))
      folders.push_back(folder / name);
  }
  return folders;
}

[[noreturn]] void fail_several(const Path& folder, const std::vector<Path>& found) {
  constexpr std::size_t kLongest = 300;
  throw Error(
      ErrorCode::usage,
      fmt::format("{} has OSGB tiles in several folders, {} and {} among them: name one, or "
                  "list those to be joined",
                  plain_text(folder.string(), kLongest), plain_text(found[0].string(), kLongest),
                  plain_text(found[1].string(), kLongest)));
}

/// Folders with tiles on one level below a folder.
struct Found {
  std::vector<Path> folders, tiles;
};

Found tiles_on(storage::FileSystem& files, const std::vector<Path>& level) {
  Found found;
  for (const Path& folder : level) {
    if (std::vector<Path> tiles = find_osgb_tiles(files, folder); !tiles.empty()) {
      found.folders.push_back(folder);
      found.tiles = std::move(tiles);
    }
  }
  return found;
}

}  // namespace

std::vector<Path> osgb_tiles(storage::FileSystem& files, const Path& folder) {
  const auto has = [&](const Path& name) {
    return files.kind(folder / name) == storage::FileKind::regular;
  };
  if (const Path own = storage::without_last_slash(folder.lexically_normal()).filename();
      has(own.string() + kOsgbEnding))
    return {folder / (own.string() + kOsgbEnding)};
  std::vector<Path> tiles, without;
  for (const Path& child : files.children(folder)) {
    const Path name = child.filename() / (child.filename().string() + kOsgbEnding);
    if (has(name))
      tiles.push_back(folder / name);
    else
      without.push_back(folder / child.filename());
  }
  if (tiles.empty())
    return loose_tiles(files, folder);
  for (const Path& child : without) {  // tiles whose first file is missing
    if (can_look(files, child)) {
      const std::vector<Path> loose = loose_tiles(files, child);
      tiles.insert(tiles.end(), loose.begin(), loose.end());
    }
  }
  std::ranges::sort(tiles);
  return tiles;
}

std::vector<Path> find_osgb_tiles(storage::FileSystem& files, const Path& folder) {
  for (const char* inner : {"Data", "terra_osgbs/Data", "terra_osgbs", "."}) {
    const Path place = *inner == '.' ? folder : folder / inner;
    if (!can_look(files, place))
      continue;
    if (std::vector<Path> tiles = osgb_tiles(files, place); !tiles.empty())
      return tiles;
  }
  return {};
}

std::vector<Path> osgb_tiles_below(storage::FileSystem& files, const Path& folder) {
  constexpr int kLevels = 5;  // Productions/Production_1/Data, models/pc/0/terra_osgbs/Data
  constexpr std::size_t kMostFolders = 1000;
  std::vector<Path> level{folder};
  for (int i = 0; i < kLevels; ++i) {
    std::vector<Path> below;
    for (const Path& above : level) {
      const std::vector<Path> inner = folders_in(files, above);
      below.insert(below.end(), inner.begin(), inner.end());
    }
    if (below.size() > kMostFolders)
      return {};
    Found found = tiles_on(files, below);
    if (found.folders.size() > 1)
      fail_several(folder, found.folders);
    if (!found.tiles.empty())
      return found.tiles;
    level = std::move(below);
  }
  return {};
}

std::vector<Path> osgb_maps(storage::FileSystem& files, const Path& tile) {
  for (const char* around : {".", "..", "../.."}) {
    const Path map = (tile.parent_path() / around / "metadata.xml").lexically_normal();
    if (files.kind(map) == storage::FileKind::regular)
      return {map};
  }
  return {};
}

std::vector<Path> osgb_family(storage::FileSystem& files, const Path& path) {
  const Path folder = path.parent_path();
  const Path looked = folder.empty() ? Path(".") : folder;
  if (!files.can_list(looked))
    return {};
  const std::string stem = path.stem().string();
  const bool is_own_folder = folder.filename() == stem;
  const std::string start = split_name(stem).tile + '_';
  std::vector<Path> family;
  for (const Path& child : files.children(looked)) {
    const std::string name = child.filename().string();
    if (is_osgb(child) && name != path.filename() && (is_own_folder || name.starts_with(start)))
      family.push_back(folder / name);
  }
  return family;
}

}  // namespace meshhier::mesh_io
