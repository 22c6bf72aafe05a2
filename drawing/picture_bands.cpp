#include "drawing/picture_bands.h"

#include <algorithm>
#include <utility>

namespace meshhier::drawing {

PictureBands::PictureBands(const images::WrittenImage& picture, std::uint32_t side,
                           images::ByteSink sink)
    : picture_(picture),
      writer_(images::open_row_writer(picture, std::move(sink))),
      band_(band_bytes(picture, side)) {}

std::uint64_t PictureBands::band_bytes(const images::WrittenImage& picture, std::uint32_t side) {
  return std::uint64_t{picture.width} * std::min(side, picture.height) * picture.channels;
}

void PictureBands::put(const render::PlanWindow& window, std::span<const std::uint8_t> pixels) {
  const std::size_t channels = picture_.channels, row_bytes = channels * picture_.width;
  for (std::size_t row = 0; row < window.height; ++row) {
    std::uint8_t* to = &band_[row * row_bytes + channels * window.column];
    const std::uint8_t* from = &pixels[4 * row * window.width];
    for (std::size_t i = 0; i < window.width; ++i, to += channels, from += 4)
      std::copy_n(from, channels, to);
  }
  if (window.column + window.width < picture_.width)
    return;
  for (std::size_t row = 0; row < window.height; ++row)
    writer_->write_row(&band_[row * row_bytes]);
}

}  // namespace meshhier::drawing
