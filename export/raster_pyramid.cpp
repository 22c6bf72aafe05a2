#include "export/raster_pyramid.h"

#include "execution/parallel.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace meshhier::exporting {
namespace {

using images::kTiffPixelBytes;
using images::kTiffTileBytes;
using images::kTiffTileSide;

constexpr std::size_t kTileRow = kTiffPixelBytes * kTiffTileSide;
constexpr std::size_t kHalf = kTiffTileSide / 2;

/// Repeats the last column and row of the part that counts, so that means at the border are those
/// of pixels that are there, and that the rest packs well.
void extend(std::span<std::byte> pixels, std::size_t width, std::size_t height) {
  for (std::size_t y = 0; y < height; ++y) {
    std::byte* const row = pixels.data() + y * kTileRow;
    for (std::size_t x = width; x < kTiffTileSide; ++x)
      std::memcpy(row + x * kTiffPixelBytes, row + (width - 1) * kTiffPixelBytes, kTiffPixelBytes);
  }
  for (std::size_t y = height; y < kTiffTileSide; ++y)
    std::memcpy(pixels.data() + y * kTileRow, pixels.data() + (height - 1) * kTileRow, kTileRow);
}

/// Writes the means of pixels of two rows.
void halve_heights(const std::byte* above, const std::byte* below, std::byte* means) {
  for (std::size_t x = 0; x < kHalf; ++x) {
    const std::size_t at = 2 * x * kTiffPixelBytes;
    double sum = 0;
    int count = 0;
    for (const std::byte* from :
         {above + at, above + at + kTiffPixelBytes, below + at, below + at + kTiffPixelBytes}) {
      const auto height = storage::load_little<float>(from);
      if (height == kNoHeight)
        continue;
      sum += height;
      ++count;
    }
    storage::store_little(count == 0 ? kNoHeight : static_cast<float>(sum / count),
                          means + x * kTiffPixelBytes);
  }
}

void halve_rows(images::TiffPixel kind, const std::byte* above, const std::byte* below,
                std::byte* means) {
  if (kind == images::TiffPixel::height)
    return halve_heights(above, below, means);
  images::halve_rows(reinterpret_cast<const std::uint8_t*>(above),
                     reinterpret_cast<const std::uint8_t*>(below), kTiffTileSide, kTiffPixelBytes,
                     reinterpret_cast<std::uint8_t*>(means));
}

}  // namespace

RasterPyramid::RasterPyramid(images::TiffPixel kind, images::TexelSize size,
                             storage::ScratchFile& scratch)
    : kind_(kind) {
  for (;;) {
    const std::size_t tiles =
        std::size_t{images::tiff_tiles(size.width)} * images::tiff_tiles(size.height);
    layers_.push_back({size, storage::BlobStore(scratch, tiles)});
    if (tiles == 1)
      break;
    size = images::level_size(size, 1);
  }
}

std::vector<std::byte> RasterPyramid::tile_of(const Layer& layer, std::size_t index) const {
  std::vector<std::byte> pixels(kTiffTileBytes);
  images::unpack_tile(kind_, layer.tiles.view(index).bytes(), pixels, "the scratch file");
  return pixels;
}

void RasterPyramid::put(std::uint32_t column, std::uint32_t row, std::vector<std::byte> pixels) {
  put(layers_.front(), column, row, std::move(pixels));
}

void RasterPyramid::put(Layer& layer, std::uint32_t column, std::uint32_t row,
                        std::vector<std::byte> pixels) {
  extend(pixels, std::min(kTiffTileSide, layer.size.width - column * kTiffTileSide),
         std::min(kTiffTileSide, layer.size.height - row * kTiffTileSide));
  layer.tiles.put(std::size_t{row} * layer.columns() + column, images::pack_tile(kind_, pixels));
}

std::size_t RasterPyramid::overview_tiles() const {
  std::size_t tiles = 0;
  for (const Layer& layer : std::span(layers_).subspan(1))
    tiles += layer.tiles.count();
  return tiles;
}

/// Returns the tile of the next level that four tiles make.
std::vector<std::byte> RasterPyramid::halved(const Layer& finer, std::uint32_t column,
                                             std::uint32_t row) const {
  std::vector<std::byte> pixels(kTiffTileBytes);
  for (const auto& [right, down] : {std::pair{0U, 0U}, {1U, 0U}, {0U, 1U}, {1U, 1U}}) {
    const std::uint32_t c = 2 * column + right, r = 2 * row + down;
    if (c >= finer.columns() || r >= finer.rows())
      continue;
    const std::vector<std::byte> from = tile_of(finer, std::size_t{r} * finer.columns() + c);
    for (std::size_t y = 0; y < kHalf; ++y) {
      const std::byte* const above = from.data() + 2 * y * kTileRow;
      halve_rows(kind_, above, above + kTileRow,
                 pixels.data() + (down * kHalf + y) * kTileRow + right * kHalf * kTiffPixelBytes);
    }
  }
  return pixels;
}

void RasterPyramid::make_overviews(const execution::CancelToken& cancel,
                                   const std::function<void()>& step) {
  for (std::size_t i = 1; i < layers_.size(); ++i) {
    Layer& layer = layers_[i];
    execution::parallel_for(layer.tiles.count(), [&](std::size_t index) {
      cancel.check();
      const auto column = static_cast<std::uint32_t>(index % layer.columns());
      const auto row = static_cast<std::uint32_t>(index / layer.columns());
      put(layer, column, row, halved(layers_[i - 1], column, row));
      step();
    });
  }
}

void RasterPyramid::write(storage::File& file, std::span<const images::TiffField> fields,
                          const execution::CancelToken& cancel) const {
  std::vector<images::TiffRaster> rasters;
  for (const Layer& layer : layers_) {
    images::TiffRaster raster{layer.size.width, layer.size.height, {}};
    for (std::size_t i = 0; i < layer.tiles.count(); ++i)
      raster.tile_bytes.push_back(layer.tiles.size(i));
    rasters.push_back(std::move(raster));
  }
  const std::vector<std::byte> head = images::tiff_head(kind_, rasters, fields);
  file.write_at(0, head);
  std::uint64_t at = head.size();
  for (std::size_t level = layers_.size(); level-- > 0;) {
    for (std::size_t i = 0; i < layers_[level].tiles.count(); ++i) {
      cancel.check();
      const storage::BlobView tile = layers_[level].tiles.view(i);
      file.write_at(at, tile.bytes());
      at += tile.bytes().size();
    }
  }
}

}  // namespace meshhier::exporting
