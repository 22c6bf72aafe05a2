#include "partition/rows_by_tile.h"

#include <algorithm>
#include <cassert>

namespace meshhier::partition {

RowsByTile::RowsByTile(storage::ScratchFile& scratch, std::uint64_t memory_bytes)
    : pieces_(scratch, memory_bytes) {
  wishes_.emplace(scratch, memory_bytes);
}

void RowsByTile::ask(std::uint32_t tile, std::span<const std::uint32_t> rows) {
  for (const std::uint32_t row : rows)
    wishes_->add({row, tile});
}

void RowsByTile::fetch(const std::function<Bytes(std::uint32_t row)>& bytes) {
  wishes_->sort();
  std::optional<std::uint32_t> row;
  Bytes of_row;
  wishes_->for_each_block([&](std::span<const Wish> block) {
    for (const Wish& wish : block) {
      if (row != wish.row)
        of_row = bytes(wish.row);
      row = wish.row;
      add(wish, of_row);
    }
  });
  wishes_.reset();
  pieces_.sort();
  move_on(0);
}

/// A row without bytes has a piece, too.
void RowsByTile::add(const Wish& wish, Bytes bytes) {
  assert(bytes.size() <= kMostRowBytes);
  Piece piece{wish.tile, wish.row, 0, 0, {}};
  for (;; ++piece.number) {
    const Bytes here = bytes.first(std::min(bytes.size(), piece.content.size()));
    piece.bytes = static_cast<std::uint16_t>(bytes.size());
    std::ranges::copy(here, piece.content.begin());
    pieces_.add(piece);
    bytes = bytes.subspan(here.size());
    if (bytes.empty())
      return;
  }
}

void RowsByTile::take(std::uint32_t tile,
                      const std::function<void(std::uint32_t row, Bytes bytes)>& visit) {
  while (!block_.empty() && block_[0].tile == tile) {
    const std::uint32_t row = block_[0].row;
    visit(row, take_row());
  }
}

RowsByTile::Bytes RowsByTile::take_row() {
  row_.clear();
  for (bool is_last = false; !is_last; move_on(1)) {
    const Piece& piece = block_[0];
    is_last = piece.bytes <= piece.content.size();
    const auto here =
        std::span(piece.content).first(std::min<std::size_t>(piece.bytes, piece.content.size()));
    row_.insert(row_.end(), here.begin(), here.end());
  }
  return row_;
}

void RowsByTile::move_on(std::size_t count) {
  block_ = block_.subspan(count);
  if (block_.empty())
    block_ = pieces_.next_block();
}

}  // namespace meshhier::partition
