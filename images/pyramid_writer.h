// Takes a picture row by row, and writes it with its pyramid to scratch space, block by block.
#pragma once

#include "images/block_grid.h"
#include "images/stored_image.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace meshhier::images {

class PyramidWriter {
 public:
  PyramidWriter(storage::ScratchFile& scratch, const ImageInfo& info);
  PyramidWriter(const PyramidWriter&) = delete;
  PyramidWriter& operator=(const PyramidWriter&) = delete;
  /// Gives back the scratch space of a picture that was not finished.
  ~PyramidWriter();

  /// The next row from the top.
  void put_row(const std::uint8_t* row) { put_row(0, row); }
  /// After the last row.
  StoredImage finish();

  /// What a writer holds.
  static std::uint64_t bytes(TexelSize picture, std::uint32_t channels);

 private:
  /// What is at work of a level.
  struct OpenLevel {
    TexelSize size;
    std::uint32_t rows = 0;            ///< that it has so far
    std::vector<std::uint8_t> strip;   ///< in blocks
    std::vector<std::uint8_t> above;   ///< an even row that waits for the odd one
    std::vector<std::uint8_t> halved;  ///< a row of the next level
  };
  void put_row(std::uint32_t level, const std::uint8_t* row);
  void add_to_strip(std::uint32_t level, const std::uint8_t* row);
  void write_strip(std::uint32_t level, std::uint32_t row);

  storage::ScratchFile& scratch_;
  BlockGrid grid_;
  StoredImage stored_;
  std::vector<OpenLevel> levels_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> written_;  ///< offsets and bytes
};

}  // namespace meshhier::images
