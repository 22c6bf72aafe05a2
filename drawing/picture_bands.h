// A picture that is written from the top, band by band, of windows that come row by row: no more
// than a band of it is in memory.
#pragma once

#include "images/row_writer.h"
#include "render/plan_raster.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::drawing {

/// For one thread.
class PictureBands {
 public:
  /// Windows of `side` pixels, but for the last ones; `picture`: its channels are 3 or 4.
  PictureBands(const images::WrittenImage& picture, std::uint32_t side, images::ByteSink sink);

  /// Returns the memory of a band.
  static std::uint64_t band_bytes(const images::WrittenImage& picture, std::uint32_t side);

  /// Takes the next window, row by row of windows from the left; red, green, blue and alpha.
  void put(const render::PlanWindow& window, std::span<const std::uint8_t> pixels);
  /// Required after the last one.
  void finish() { writer_->finish(); }

 private:
  images::WrittenImage picture_;
  std::unique_ptr<images::RowWriter> writer_;
  std::vector<std::uint8_t> band_;
};

}  // namespace meshhier::drawing
