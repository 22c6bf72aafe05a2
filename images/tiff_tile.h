// Tiles of TIFF files, as they lie there: Adobe's DEFLATE (compression 8) behind a predictor.
//
// Problem. libtiff packs one tile of a file at a time, on one thread.
// Idea. A tile's bytes depend on its samples alone, so any thread packs any tile, into memory; the
// file is put together later (tiff_layout.h). The predictors are those of TIFF 6.0 (differences of
// neighbours, 2) and of Adobe's Technical Note 3 (bytes of floats by their weight, 3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshhier::images {

/// The side of all tiles that are written, in pixels.
inline constexpr std::uint32_t kTiffTileSide = 512;

/// The kind of a raster's pixels; a row of kTiffPixels.
enum class TiffPixel : std::uint8_t {
  rgba,   ///< red, green, blue, alpha (not premultiplied): 8 bits each
  height  ///< a float
};
/// Both have so many bytes.
inline constexpr std::size_t kTiffPixelBytes = 4;
inline constexpr std::size_t kTiffTileBytes = kTiffPixelBytes * kTiffTileSide * kTiffTileSide;

/// Returns the bytes of a tile in a file. `pixels`: kTiffTileBytes, row by row from the top, floats
/// little endian. Deterministic for one zlib. Thread-safe, as unpack_tile().
std::vector<std::byte> pack_tile(TiffPixel kind, std::span<const std::byte> pixels);

/// Undoes pack_tile(). `pixels`: kTiffTileBytes. Throws Error(corrupt) that starts with `name` if
/// `packed` are other bytes.
void unpack_tile(TiffPixel kind, std::span<const std::byte> packed, std::span<std::byte> pixels,
                 const std::string& name);

}  // namespace meshhier::images
