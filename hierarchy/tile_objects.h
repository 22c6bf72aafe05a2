// The objects of a tile, with what other viewers show of them: a table in the tile's own file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier {

/// A row for each object that a vertex of the tile belongs to. Names and properties lie column
/// after column, as storage/format/tile_object_table.h says.
struct TileObjects {
  std::vector<std::uint32_t> objects;     ///< ascending
  std::uint32_t columns = 0;              ///< of the table; 0: the tile has none
  std::vector<std::uint64_t> text_bytes;  ///< of each column of texts
  std::vector<std::byte> table;

  bool empty() const { return columns == 0; }
  friend bool operator==(const TileObjects&, const TileObjects&) = default;
};

}  // namespace meshhier
