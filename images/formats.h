// The formats of pictures, a row each: functions that read and write it, limits and costs. Their
// names, endings and media types stand in hierarchy/image_format.h.
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

/// The costs of a texel of a tile, about.
struct TexelCosts {
  double file_bytes;
  double device_bytes;  ///< on a graphics device that knows blocks, without smaller pictures
  double seconds;  ///< CPU time of coding KTX2; that of other formats is little beside the baking
};

/// Processes that code what no library does.
struct CoderProcesses {
  /// Says in a sentence what keeps this machine from coding, and what to do; empty: it can.
  /// Thread-safe.
  std::string (*missing)();
  /// Returns the memory of a process that codes a picture, which it keeps for the next one.
  std::uint64_t (*bytes)(std::uint64_t texels);
  /// Ends the processes that wait for pictures. Thread-safe.
  void (*end)();
};

/// A format. All functions are thread-safe for different pictures.
struct FormatCoders {
  ImageFormat format;
  /// Reads the head; as open_image(), once the format is known.
  std::unique_ptr<ImageReader> (*open)(ByteSource source, const std::string& name);
  /// Encode a whole picture, as encode_image() and encode_normal_map() say.
  std::vector<std::byte> (*encode)(const Image& image, int quality);
  std::vector<std::byte> (*encode_directions)(const Image& image, int quality);
  /// Writes rows as they come, as open_row_writer() says; null: all rows wait for the last one.
  std::unique_ptr<RowWriter> (*open_rows)(const WrittenImage& image, ByteSink sink);
  std::uint64_t most_held_texels;  ///< rows of pictures up to this size wait all the same
  /// Returns the memory of encoding, besides the picture.
  std::uint64_t (*encoder_bytes)(std::uint64_t texels, int quality);
  std::uint32_t most_side;  ///< the longest side that is written
  /// Costs at a quality of 90, at the best quality, and of normal maps.
  TexelCosts colours, best_colours, directions;
  /// Returns the processes that code pictures of a quality; null: this process does.
  const CoderProcesses* (*processes)(int quality);
};

/// Return the row of a format, and the costs of a texel in pictures and in normal maps.
const FormatCoders& coders_of(ImageFormat format);
const TexelCosts& costs_of(const TextureFormat& textures);
const TexelCosts& costs_of(const NormalMapFormat& maps);

/// Return CoderProcesses::missing() and bytes() of a format; "" and 0 if this process codes it.
/// Normal maps are all coded in it.
std::string missing_coder(const TextureFormat& textures);
std::uint64_t coder_bytes(const TextureFormat& textures, std::uint64_t texels);
/// Ends the waiting processes of all formats. Thread-safe.
void end_coders();

}  // namespace meshhier::images
