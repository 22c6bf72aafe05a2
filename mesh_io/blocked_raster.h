// A raster whose heights come in blocks: tiles, or runs of rows.
#pragma once

#include "mesh_io/decoded_blocks.h"
#include "mesh_io/height_raster.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace meshhier::mesh_io {

/// Reads rows from decoded blocks. A format derives from it.
class BlockedRaster : public HeightRaster {
 public:
  const RasterHead& head() const final { return head_; }
  void read(DecodedBlocks& blocks, std::uint32_t row, std::uint32_t first,
            std::span<double> heights) const final;
  std::uint64_t row_bytes() const override { return block_columns_ * blocks_.bytes(); }

 protected:
  /// The form of blocks. The last ones may reach beyond the raster.
  struct Blocks {
    std::uint32_t width = 0, height = 0;
    std::uint32_t sample_bytes = 0;

    std::uint64_t bytes() const { return std::uint64_t{width} * height * sample_bytes; }
  };
  /// A block by its column and row of blocks.
  struct BlockPlace {
    std::uint32_t column = 0, row = 0;
  };

  /// To be called once, when head and blocks are known.
  void set(RasterHead head, const Blocks& blocks);
  /// Fills a block: rows of width * sample_bytes. Thread-safe for different blocks.
  virtual void decode(const BlockPlace& place, std::span<std::byte> into) const = 0;
  /// Makes heights of samples. `from`: heights.size() samples.
  virtual void convert(const std::byte* from, std::span<double> heights) const = 0;
  /// Takes away heights of a row, from column `first` on, that are not seen. Thread-safe.
  virtual void hide(std::uint32_t /*row*/, std::uint32_t /*first*/,
                    std::span<double> /*heights*/) const {}

  RasterHead head_;

 private:
  Blocks blocks_;
  std::uint32_t block_columns_ = 0;
  DecodedBlocks::Source source_;
};

/// Returns how many rows of so many bytes make a block where rows lie as they are.
std::uint32_t rows_of_block(std::uint32_t rows, std::uint64_t row_bytes);

}  // namespace meshhier::mesh_io
