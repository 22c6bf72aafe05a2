// A raster with its overviews on its way into a file, tile by tile.
//
//   put() in any order  ->  packed tiles in scratch  ->  make_overviews()  ->  write()
//
// Memory holds a few tiles, and 50 bytes for each. The bytes do not depend on the order, nor on the
// number of threads.
#pragma once

#include "execution/cancel.h"
#include "images/pyramid.h"
#include "images/tiff_layout.h"
#include "images/tiff_tile.h"
#include "storage/io/blob_store.h"
#include "storage/io/output_file.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::exporting {

/// Height of pixels where nothing is, in the file.
inline constexpr float kNoHeight = -9999;

class RasterPyramid {
 public:
  /// `size`: of the raster, pixels; `scratch` must outlive it.
  RasterPyramid(images::TiffPixel kind, images::TexelSize size, storage::ScratchFile& scratch);

  /// Takes the tile at a column and row of tiles: images::kTiffTileBytes, of which those beyond the
  /// raster do not count. Threads may put different tiles at once.
  void put(std::uint32_t column, std::uint32_t row, std::vector<std::byte> pixels);

  /// Returns how many tiles the overviews have.
  std::size_t overview_tiles() const;
  /// Makes the overviews, each from the finer one, until one tile holds all. Requires all tiles.
  /// Means of colours are those of light, weighted by alpha; means of heights those of the heights
  /// that are there. `step` is called for each tile, by any thread.
  void make_overviews(const execution::CancelToken& cancel, const std::function<void()>& step);

  /// Writes the file: a GeoTIFF if `fields` make it one. Requires make_overviews().
  void write(storage::File& file, std::span<const images::TiffField> fields,
             const execution::CancelToken& cancel) const;

 private:
  struct Layer {
    images::TexelSize size;
    storage::BlobStore tiles;

    std::uint32_t columns() const { return images::tiff_tiles(size.width); }
    std::uint32_t rows() const { return images::tiff_tiles(size.height); }
  };
  void put(Layer& layer, std::uint32_t column, std::uint32_t row, std::vector<std::byte> pixels);
  std::vector<std::byte> tile_of(const Layer& layer, std::size_t index) const;
  std::vector<std::byte> halved(const Layer& finer, std::uint32_t column, std::uint32_t row) const;

  images::TiffPixel kind_;
  std::vector<Layer> layers_;  ///< the raster, then its overviews
};

}  // namespace meshhier::exporting
