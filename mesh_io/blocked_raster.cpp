#include "mesh_io/blocked_raster.h"

#include "mesh_io/coordinate_range.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {

void BlockedRaster::set(RasterHead head, const Blocks& blocks) {
  head_ = std::move(head);
  blocks_ = blocks;
  block_columns_ = (head_.columns - 1) / blocks.width + 1;
  source_ = {this, blocks.bytes(), [this](std::uint64_t block, std::span<std::byte> into) {
               decode({static_cast<std::uint32_t>(block % block_columns_),
                       static_cast<std::uint32_t>(block / block_columns_)},
                      into);
             }};
}

void BlockedRaster::read(DecodedBlocks& blocks, std::uint32_t row, std::uint32_t first,
                         std::span<double> heights) const {
  const std::uint64_t band = std::uint64_t{row / blocks_.height} * block_columns_;
  const std::size_t in_block = std::size_t{row % blocks_.height} * blocks_.width;
  std::uint32_t column = first;
  for (std::span<double> left = heights; !left.empty();) {
    const std::uint32_t begin = column % blocks_.width;
    const auto part = left.first(std::min<std::size_t>(left.size(), blocks_.width - begin));
    const auto block = blocks.get(source_, band + column / blocks_.width, band + block_columns_);
    convert(block->data() + (in_block + begin) * blocks_.sample_bytes, part);
    left = left.subspan(part.size());
    column += static_cast<std::uint32_t>(part.size());
  }
  hide(row, first, heights);
  const auto bad = std::ranges::find_if(
      heights, [](double height) { return !std::isnan(height) && !is_coordinate(height); });
  if (bad != heights.end()) {
    fail_file(head_.path,
              fmt::format("column {}, row {}: expected {}, found {}; if it stands for no height, "
                          "say so by `gdal_translate -a_nodata {}`",
                          first + (bad - heights.begin()), row, kCoordinateRange, *bad, *bad));
  }
}

std::uint32_t rows_of_block(std::uint32_t rows, std::uint64_t row_bytes) {
  constexpr std::uint64_t kBlockBytes = std::uint64_t{1} << 18;
  return static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(kBlockBytes / std::max<std::uint64_t>(row_bytes, 1), 1, rows));
}

}  // namespace meshhier::mesh_io
