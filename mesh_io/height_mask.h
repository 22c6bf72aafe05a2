// Which cells of a raster are seen: the mask that lies in its file as an image of its own.
#pragma once

#include "images/tiff_pixels.h"
#include "mesh_io/decoded_blocks.h"
#include "storage/io/file.h"

#include <cstdint>
#include <span>

namespace meshhier::mesh_io {

/// Thread-safe.
class HeightMask {
 public:
  /// `directory`: where the mask's tags stand. `file` must outlive this. Throws as
  /// images::TiffPixels, and Error(input) if it is no mask of one band of 1 or 8 bits.
  HeightMask(const storage::File& file, std::uint64_t directory);

  /// Takes away the heights of a row, from column `first` on, that are not seen: NaN.
  void hide(std::uint32_t row, std::uint32_t first, std::span<double> heights) const;
  /// Returns the bytes of the decoded blocks that a row lies in.
  std::uint64_t row_bytes() const;

 private:
  images::TiffPixels pixels_;
  DecodedBlocks::Source source_;
  mutable DecodedBlocks blocks_;
};

}  // namespace meshhier::mesh_io
