#include "mesh_io/height_mask.h"

#include "mesh_io/input_error.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace meshhier::mesh_io {

HeightMask::HeightMask(const storage::File& file, std::uint64_t directory)
    : pixels_(file, directory),
      source_{this, pixels_.layout().block_bytes(),
              [this](std::uint64_t block, std::span<std::byte> into) {
                const std::uint32_t columns = pixels_.layout().columns();
                pixels_.read_block({static_cast<std::uint32_t>(block % columns),
                                    static_cast<std::uint32_t>(block / columns)},
                                   into);
              }},
      blocks_(2 * row_bytes()) {
  const images::TiffLayout& layout = pixels_.layout();
  if (layout.bands != 1 || (layout.bits != 1 && layout.bits != 8))
    fail_file(file.path(), "has a mask that is not of one band of 1 or 8 bits");
}

std::uint64_t HeightMask::row_bytes() const {
  return pixels_.layout().block_bytes() * pixels_.layout().columns();
}

void HeightMask::hide(std::uint32_t row, std::uint32_t first, std::span<double> heights) const {
  const images::TiffLayout& layout = pixels_.layout();
  const std::uint64_t band = std::uint64_t{row / layout.block_height} * layout.columns();
  const std::uint64_t in_block = row % layout.block_height * layout.block_stride();
  for (std::size_t done = 0; done < heights.size();) {
    const auto column = static_cast<std::uint32_t>(first + done);
    const std::uint32_t begin = column % layout.block_width;
    const std::size_t count =
        std::min<std::size_t>(heights.size() - done, layout.block_width - begin);
    const auto block =
        blocks_.get(source_, band + column / layout.block_width, band + layout.columns());
    const std::byte* const bytes = block->data() + in_block;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = begin + i;
      const bool is_seen =
          layout.bits == 1 ? (std::to_integer<unsigned>(bytes[at / 8]) >> (7 - at % 8) & 1U) != 0
                           : bytes[at] != std::byte{0};
      if (!is_seen)
        heights[done + i] = std::numeric_limits<double>::quiet_NaN();
    }
    done += count;
  }
}

}  // namespace meshhier::mesh_io
