// The formats of pictures: what reads and writes each, and what that costs. Their names:
// hierarchy/image_format.h.
#pragma once

#include "hierarchy/texture.h"
#include "images/image.h"
#include "images/image_codec.h"
#include "images/row_writer.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::images {

/// What a texel of a tile takes, about.
struct TexelCosts {
  double file_bytes;
  double device_bytes;  ///< on a graphics device that knows blocks, without smaller pictures
  double seconds;       ///< of other processes: what libraries take is little beside the baking
};

/// Processes that code a format for which there is no library.
struct CoderProcesses {
  /// What keeps this machine from coding, and what mends it, in a sentence; empty: nothing does.
  std::string (*missing)();
  /// Memory of a process that codes a picture, which it keeps for the next one.
  std::uint64_t (*bytes)(std::uint64_t texels);
  /// Ends those that wait for pictures. Thread-safe.
  void (*end)();
};

struct FormatRow {
  ImageFormat format;
  std::unique_ptr<ImageReader> (*open)(ByteSource source, const std::string& name);
  std::vector<std::byte> (*encode)(const Image& image, int quality);
  std::vector<std::byte> (*encode_directions)(const Image& image, int quality);
  /// Writes rows as they come; null: they all wait for the last one.
  std::unique_ptr<RowWriter> (*open_rows)(const WrittenImage& image, ByteSink sink);
  std::uint64_t most_held_texels;  ///< rows of pictures up to this size wait nevertheless
  std::uint64_t (*encoder_bytes)(std::uint64_t texels, int quality);  ///< besides the picture
  std::uint32_t most_side;                                            ///< that is written
  TexelCosts colours, best_colours, directions;
  const CoderProcesses* processes;  ///< null: libraries do it
};

const FormatRow& coders_of(ImageFormat format);
const TexelCosts& costs_of(const TextureFormat& textures);
const TexelCosts& costs_of(const NormalMapFormat& maps);

/// As CoderProcesses has them; formats without have nothing missing and take no memory.
std::string missing_coder(ImageFormat format);
std::uint64_t coder_bytes(ImageFormat format, std::uint64_t texels);
/// Of all formats.
void end_coders();

}  // namespace meshhier::images
