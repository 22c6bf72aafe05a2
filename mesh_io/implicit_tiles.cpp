#include "mesh_io/implicit_tiles.h"

#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr const char* kSubtreesPlace = ".implicitTiling.subtrees";

/// A tileset has up to a million names made of one.
constexpr std::size_t kLongestTemplate = 1024;

void replace_all(std::string& text, std::string_view word, std::uint64_t number) {
  const std::string digits = std::to_string(number);
  for (std::size_t at = text.find(word); at != std::string::npos;
       at = text.find(word, at + digits.size()))
    text.replace(at, word.size(), digits);
}

std::string name_of_cell(std::string text, const TileCell& cell) {
  constexpr std::array<std::string_view, 3> kAxes{"{x}", "{y}", "{z}"};
  replace_all(text, "{level}", cell.level);
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis)
    replace_all(text, kAxes[axis], cell.at[axis]);
  return text;
}

TileCell child_of(const TileCell& cell, std::uint32_t child) {
  TileCell below{.level = cell.level + 1};
  for (std::size_t axis = 0; axis < below.at.size(); ++axis)
    below.at[axis] = 2 * cell.at[axis] + (child >> axis & 1U);
  return below;
}

/// The expansion of one tile.
class ImplicitTree {
 public:
  ImplicitTree(TilesetDocument& document, const ImplicitTiling& tiling, const TilesetRoom& room,
               const OpenNamed& open)
      : document_(document), tiling_(tiling), room_(room), open_(open) {
    TilesetTile& root = document_.tiles[tiling_.tile];
    templates_.assign(document_.contents.begin() + root.first_content,
                      document_.contents.begin() + root.end_content);
    root.end_content = root.first_content;
    require_short(tiling_.subtrees);
    for (const TileContentName& name : templates_)
      require_short(name.uri.value_or(""));
  }

  void expand() {
    waiting_.push_back({{}, tiling_.tile});
    for (; !waiting_.empty(); waiting_.pop_front())
      add_subtree(waiting_.front());
  }

 private:
  /// The root of a subtree.
  struct Waiting {
    TileCell cell;
    std::uint32_t parent;  ///< number of the tile above; of the first one the tile itself
    std::uint32_t child = 0;
  };
  /// A tile of the subtree at work.
  struct Placed {
    std::uint64_t index;  ///< along the level's curve
    TileCell cell;
    std::uint32_t tile;
  };

  void require_short(const std::string& name) const {
    if (name.size() > kLongestTemplate)
      fail_file(document_.path, fmt::format("names implicit tiles by a template of {} bytes, up to "
                                            "{} are read",
                                            name.size(), kLongestTemplate));
  }

  void add_subtree(const Waiting& waiting) {
    const std::string uri = name_of_cell(tiling_.subtrees, waiting.cell);
    const auto file = open_(document_.path.parent_path(), uri,
                            place_of(document_, {{}, tiling_.tile, kSubtreesPlace}));
    const Subtree subtree =
        read_subtree(*file, tiling_.shape, templates_.size(), room_.json_bytes, open_);
    if (!subtree.tiles.at(0))
      fail_file(file->path(), "is a subtree without its root");
    std::vector<Placed> level{{0, waiting.cell, add_root(waiting)}};
    add_contents(subtree, 0, level[0]);
    for (std::uint32_t below = 1; below <= tiling_.shape.levels; ++below) {
      if (waiting.cell.level + below >= tiling_.levels)
        return;
      level = add_level(subtree, below, level);
    }
  }

  std::uint32_t add_root(const Waiting& waiting) {
    const bool is_first = waiting.cell.level == 0;
    return is_first ? waiting.parent : add_tile(waiting.cell, waiting.parent, waiting.child);
  }

  /// Adds the tiles of a level of the subtree; below its last one, the subtrees wait.
  std::vector<Placed> add_level(const Subtree& subtree, std::uint32_t below,
                                const std::vector<Placed>& parents) {
    const bool is_within = below < tiling_.shape.levels;
    const std::uint64_t first = is_within ? tiling_.shape.first_of(below) : 0;
    const Availability& there = is_within ? subtree.tiles : subtree.children;
    std::vector<Placed> level;
    for (const Placed& parent : parents) {
      for (std::uint32_t child = 0; child < tiling_.shape.children(); ++child) {
        const std::uint64_t index = parent.index * tiling_.shape.children() + child;
        if (!there.at(first + index))
          continue;
        document_.tiles[parent.tile].is_leaf = false;
        const TileCell cell = child_of(parent.cell, child);
        if (!is_within) {
          require_room();
          waiting_.push_back({cell, parent.tile, child});
          continue;
        }
        level.push_back({index, cell, add_tile(cell, parent.tile, child)});
        add_contents(subtree, first + index, level.back());
      }
    }
    return level;
  }

  /// Each subtree that waits makes a tile.
  void require_room() const {
    if (document_.tiles.size() + waiting_.size() > room_.tiles)
      room_.refuse(document_.path, fmt::format("has more than {} tiles", room_.tiles));
  }

  std::uint32_t add_tile(const TileCell& cell, std::uint32_t parent, std::uint32_t child) {
    require_room();
    document_.tiles.push_back({.parent = parent, .number = child});
    if (tiling_.volume)
      document_.tiles.back().volume = tiling_.volume->part(cell, tiling_.shape.is_octree).ball();
    return static_cast<std::uint32_t>(document_.tiles.size() - 1);
  }

  void add_contents(const Subtree& subtree, std::uint64_t bit, const Placed& placed) {
    TilesetTile& tile = document_.tiles[placed.tile];
    tile.first_content = static_cast<std::uint32_t>(document_.contents.size());
    for (std::size_t i = 0; i < subtree.contents.size(); ++i) {
      if (!subtree.contents[i].at(bit))
        continue;
      TileContentName name = templates_[i];
      if (name.uri)
        name.uri = name_of_cell(*std::move(name.uri), placed.cell);
      name.tile = placed.tile;
      if (document_.contents.size() >= room_.tiles)
        room_.refuse(document_.path, fmt::format("has more than {} contents", room_.tiles));
      document_.contents.push_back(std::move(name));
    }
    tile.end_content = static_cast<std::uint32_t>(document_.contents.size());
  }

  TilesetDocument& document_;
  const ImplicitTiling& tiling_;
  TilesetRoom room_;
  const OpenNamed& open_;
  std::vector<TileContentName> templates_;
  std::deque<Waiting> waiting_;
};

}  // namespace

void expand_implicit_tiles(TilesetDocument& document, const TilesetRoom& room,
                           const OpenNamed& open) {
  for (const ImplicitTiling& tiling : document.implicit)
    ImplicitTree(document, tiling, room, open).expand();
}

}  // namespace meshhier::mesh_io
