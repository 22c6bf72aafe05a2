// Brings rows of a table to the tiles that ask for them, out of core.
//
// Problem. Rows are numbered by name, and names need not lie as tiles do: a tile asks for rows from
// all over the table, the next one for others from all over. Neither the table nor all that is
// asked fits in memory.
//
// Idea. Two sorts. What is asked is sorted by row, so that each row is looked up once, in the
// table's order; its bytes, in pieces of one length, are sorted by tile.
//
//     asked                 by row               by tile
//     tile 0: 7, 90         row  7: 0, 1         tile 0: row 7, row 90
//     tile 1: 7, 12    ->   row 12: 1       ->   tile 1: row 7, row 12
//     tile 2: 90            row 90: 0, 2         tile 2: row 90
//
// Invariant. The rows of a tile ascend, whatever the memory.
//
// Cost. O(n log n) for n pairs of a tile and a row: a record of 8 bytes each, then one of 32 for
// each 20 bytes of the row.
#pragma once

#include "partition/external_sort.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::partition {

/// For one thread. Call ask() for all tiles, fetch(), then take() for each tile, ascending.
class RowsByTile {
 public:
  using Bytes = std::span<const std::byte>;
  static constexpr std::size_t kMostRowBytes = UINT16_MAX;

  /// `memory_bytes`: of each of two sorts, of which both are at work in fetch() alone.
  RowsByTile(storage::ScratchFile& scratch, std::uint64_t memory_bytes);

  /// Says that a tile wants these rows, each once.
  void ask(std::uint32_t tile, std::span<const std::uint32_t> rows);

  /// Ends asking. Calls `bytes(row)` for all rows that are wanted, ascending, each once. What it
  /// returns, at most kMostRowBytes, must last until the next call.
  void fetch(const std::function<Bytes(std::uint32_t row)>& bytes);

  /// Calls `visit(row, bytes)` for the rows of a tile, ascending.
  void take(std::uint32_t tile, const std::function<void(std::uint32_t row, Bytes bytes)>& visit);

 private:
  struct Wish {
    std::uint32_t row, tile;
  };
  struct WishOrder {
    auto operator()(const Wish& wish) const { return std::pair(wish.row, wish.tile); }
  };
  struct Piece {
    std::uint32_t tile, row;
    std::uint16_t number;  ///< among those of the row
    std::uint16_t bytes;   ///< of the row, from here on: more than fit if others follow
    std::array<std::byte, 20> content;
  };
  struct PieceOrder {
    auto operator()(const Piece& piece) const {
      return std::pair(std::uint64_t{piece.tile} << 32 | piece.row, piece.number);
    }
  };
  static_assert(sizeof(Piece) == 32);

  void add(const Wish& wish, Bytes bytes);
  void move_on(std::size_t count);
  /// Returns the bytes of the row here, and goes on to the next.
  Bytes take_row();

  ExternalSort<Piece, PieceOrder> pieces_;
  std::optional<ExternalSort<Wish, WishOrder>> wishes_;  ///< until they are fetched
  std::span<const Piece> block_;
  std::vector<std::byte> row_;
};

}  // namespace meshhier::partition
