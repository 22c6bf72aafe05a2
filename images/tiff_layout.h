// The head of a tiled TIFF with overviews, and where its tiles lie (TIFF 6.0; BigTIFF).
//
// Problem. Programs that read a TIFF by ranges, from a web server, want all directories at its
// beginning and the coarse pictures before the fine ones ("cloud optimized"); libtiff writes
// directories behind their tiles.
// Idea. All tiles are packed before the file begins, so its head can be written first, and the rest
// is one sequence of bytes: a file or a stream.
//
//   header | picture: entries, values | overview 1: ... | overview 2: ... | ... |
//          | tiles of the last overview | ... | tiles of overview 1 | tiles of the picture
//
// Invariant. Entries ascend by tag; values begin at even offsets. A file of 4 GB or more is a
// BigTIFF, whose offsets have 8 bytes.
#pragma once

#include "images/tiff_tile.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace meshhier::images {

/// A tag with its values, as they lie in the file.
struct TiffField {
  std::uint16_t tag = 0;
  std::uint16_t type = 0;  ///< by TIFF's numbers
  std::uint64_t count = 0;
  std::vector<std::byte> bytes;
};
TiffField tiff_shorts(std::uint16_t tag, std::span<const std::uint16_t> values);
TiffField tiff_longs(std::uint16_t tag, std::span<const std::uint32_t> values);
TiffField tiff_doubles(std::uint16_t tag, std::span<const double> values);
/// A zero byte ends it.
TiffField tiff_text(std::uint16_t tag, std::string_view text);

/// A raster, or one of its overviews.
struct TiffRaster {
  std::uint32_t width = 0, height = 0;    ///< pixels, 1 or more
  std::vector<std::uint64_t> tile_bytes;  ///< of its packed tiles, row by row from the top
};

/// Returns the tiles that a side of so many pixels takes.
constexpr std::uint32_t tiff_tiles(std::uint32_t pixels) {
  return pixels / kTiffTileSide + (pixels % kTiffTileSide == 0 ? 0 : 1);
}

/// Returns all bytes before the first tile. `rasters`: the picture, then its overviews, each half
/// of the one before. `fields`: further tags of the picture, with tags above 330 and not those of
/// tiles. The tiles of the last raster come first, those of the picture last.
std::vector<std::byte> tiff_head(TiffPixel kind, std::span<const TiffRaster> rasters,
                                 std::span<const TiffField> fields);

}  // namespace meshhier::images
