// Takes a picture row by row, and writes it with its pyramid to scratch space, block by block.
//
// Idea. All levels are open at once. A row of a level goes into the level's strip of blocks; of
// every second one, together with the row before it, a row of the next level is made:
//
//       level 0   row 0   row 1   row 2   row 3   row 4   row 5   ...
//                   waits   |       waits   |       waits   |
//       level 1           row 0           row 1           row 2
//                           waits           |               waits
//       level 2                           row 0
//
// A strip is written when it has 64 rows, or the level's last one. An odd last row stands for two.
//
// Cost. O(texels) time, O(width) memory: a strip of 64 rows and two rows a level.
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

  /// Takes the next row from the top: width * channels bytes. Throws Error(io).
  void put_row(const std::uint8_t* row) { put_row(0, row); }
  /// Returns the picture's facts. Requires that all rows came.
  StoredImage finish();

  /// Returns the memory that a writer holds, in bytes.
  static std::uint64_t bytes(TexelSize picture, std::uint32_t channels);

 private:
  /// A level at work.
  struct OpenLevel {
    TexelSize size;
    std::uint32_t rows = 0;            ///< rows that it has so far
    std::vector<std::uint8_t> strip;   ///< the rows of a strip, in blocks
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
