// Pictures in the formats of files (formats.h).
#pragma once

#include "hierarchy/texture.h"
#include "images/image.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::images {

/// Gives encoded bytes: reads up to `into.size()` bytes at `offset` and returns how many there
/// were; 0 only at the end. May throw.
using ByteSource = std::function<std::size_t(std::uint64_t offset, std::span<std::byte> into)>;

/// The longest side of a picture that is read, in texels.
inline constexpr std::uint32_t kMaxSourceSide = 65535;

/// The facts in a picture's head, known before anything is decoded.
struct ImageInfo {
  ImageFormat format = ImageFormat::jpeg;
  std::uint32_t width = 0, height = 0;  ///< 1 ... kMaxSourceSide each
  std::uint32_t channels = 3;           ///< channels that come out: 3, or 4 if it may have alpha
  /// The memory that decoding holds at once, besides the rows that are read: little if the format
  /// gives its rows one by one (baseline JPEG, PNG without interlace), else the whole picture or
  /// all of its coefficients (progressive JPEG, interlaced PNG, WebP, KTX2).
  std::uint64_t decoder_bytes = 0;
  friend bool operator==(const ImageInfo&, const ImageInfo&) = default;
};

/// Gives the rows of a picture from the top. CMYK and YCCK, greys, palettes, transparency, 1 to 16
/// bits a channel become 8 bits red, green, blue [, alpha]; orientation marks and colour profiles
/// are ignored. For one thread.
class ImageReader {
 public:
  virtual ~ImageReader() = default;
  virtual const ImageInfo& info() const = 0;
  /// Says in a sentence what keeps this machine from decoding the rows, and what to do; empty: it
  /// can.
  virtual std::string missing() const { return {}; }
  /// Reads the next `count` rows, each width * channels bytes; all calls together at most
  /// info().height rows. Throws Error(input) that starts with the picture's name if it is broken or
  /// ends early, and what the source throws.
  virtual void read_rows(std::uint8_t* rows, std::uint32_t count) = 0;
};

/// Reads the head of a picture; the content tells the format. No memory is sized by the head before
/// it is checked. Throws Error(input) that starts with `name` if it is no picture of these formats,
/// broken, or larger than kMaxSourceSide on a side (JPEG 65500, WebP 16383); and what the source
/// throws.
std::unique_ptr<ImageReader> open_image(ByteSource source, const std::string& name);

/// Decodes a whole picture from memory. Throws as open_image() and read_rows(), and Error(input) if
/// it has more than `most_texels`. Thread-safe.
Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                   std::uint64_t most_texels);

/// Encodes a picture; deterministic for one version of the library. `quality`: 1 ... kBestQuality;
/// for jpeg (4:4:4 from 90 on, below it 4:2:0), webp (the best one loses nothing) and ktx2 (ETC1S,
/// the best one UASTC); without effect on png. Requires sides up to FormatCoders::most_side, for
/// ktx2 multiples of 4, and no alpha if the format has none. Besides the picture it holds the
/// encoded bytes, and FormatCoders::encoder_bytes(). Thread-safe.
std::vector<std::byte> encode_image(const Image& image, ImageFormat format, int quality);

/// Encodes directions instead of colours: a jpeg keeps red and green, which say nearly all, as
/// exactly as `quality` has it and with all of their texels, and blue coarsely; a viewer
/// decodes it as any RGB picture. `quality` has no effect on png and webp, which lose nothing, and
/// on ktx2, which is UASTC. Requires 3 channels.
std::vector<std::byte> encode_normal_map(const Image& image, const NormalMapFormat& format);

}  // namespace meshhier::images
