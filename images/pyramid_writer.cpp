#include "images/pyramid_writer.h"

#include "storage/io/hash.h"

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace meshhier::images {

PyramidWriter::PyramidWriter(storage::ScratchFile& scratch, const ImageInfo& info)
    : scratch_(scratch), grid_({info.width, info.height}, info.channels) {
  stored_.info = info;
  stored_.strips.resize(grid_.strips());
  written_.reserve(grid_.strips());
  levels_.resize(grid_.levels());
  for (std::uint32_t i = 0; i < levels_.size(); ++i) {
    OpenLevel& level = levels_[i];
    level.size = grid_.size(i);
    level.strip.resize(grid_.strip_bytes(i, 0));
    if (i + 1 == levels_.size())
      break;
    level.above.resize(std::size_t{level.size.width} * info.channels);
    level.halved.resize(std::size_t{grid_.size(i + 1).width} * info.channels);
  }
}

PyramidWriter::~PyramidWriter() {
  for (const auto& [offset, bytes] : written_)
    scratch_.release(offset, bytes);
}

StoredImage PyramidWriter::finish() {
  assert(levels_.back().rows == levels_.back().size.height);
  written_.clear();
  return std::move(stored_);
}

std::uint64_t PyramidWriter::bytes(TexelSize picture, std::uint32_t channels) {
  const BlockGrid grid(picture, channels);
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < grid.levels(); ++i)
    bytes += grid.strip_bytes(i, 0) + std::uint64_t{2} * grid.size(i).width * channels;
  return bytes;
}

void PyramidWriter::put_row(std::uint32_t number, const std::uint8_t* row) {
  OpenLevel& level = levels_[number];
  add_to_strip(number, row);
  const bool is_even = level.rows % 2 == 0;
  ++level.rows;
  const bool is_last = level.rows == level.size.height;
  if (is_last || level.rows % BlockGrid::kBlockSide == 0)
    write_strip(number, (level.rows - 1) / BlockGrid::kBlockSide);
  if (number + 1 == levels_.size())
    return;
  // An even row waits for the next one; without a next one it stands for both.
  if (is_even && !is_last) {
    std::memcpy(level.above.data(), row, level.above.size());
    return;
  }
  halve_rows(is_even ? row : level.above.data(), row, level.size.width, grid_.channels(),
             level.halved.data());
  put_row(number + 1, level.halved.data());
}

void PyramidWriter::add_to_strip(std::uint32_t number, const std::uint8_t* row) {
  OpenLevel& level = levels_[number];
  const std::uint32_t block_row = level.rows / BlockGrid::kBlockSide;
  const std::uint32_t row_in_block = level.rows % BlockGrid::kBlockSide;
  for (std::uint32_t x = 0; x < level.size.width; x += BlockGrid::kBlockSide) {
    const std::uint32_t column = x / BlockGrid::kBlockSide;
    const std::size_t row_bytes = std::size_t{grid_.columns(number, column)} * grid_.channels();
    std::memcpy(
        level.strip.data() + grid_.offset(number, column, block_row) + row_in_block * row_bytes,
        row + std::size_t{x} * grid_.channels(), row_bytes);
  }
}

void PyramidWriter::write_strip(std::uint32_t number, std::uint32_t row) {
  const auto bytes =
      std::as_bytes(std::span(levels_[number].strip)).first(grid_.strip_bytes(number, row));
  const std::uint64_t offset = scratch_.append(bytes);
  written_.emplace_back(offset, bytes.size());
  stored_.strips[grid_.first_strip(number) + row] = {offset, storage::checksum(bytes)};
}

}  // namespace meshhier::images
