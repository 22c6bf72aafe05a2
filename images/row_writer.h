// Pictures that are written row by row: of any size in little memory.
#pragma once

#include "hierarchy/texture.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace meshhier::images {

/// Takes the bytes of a file in their order. May throw.
using ByteSink = std::function<void(std::span<const std::byte>)>;

/// What is written, as encode_image() has it.
struct WrittenImage {
  ImageFormat format = ImageFormat::jpeg;  ///< of open_row_writer(): jpeg or png
  int quality = 90;
  std::uint32_t width = 0, height = 0;  ///< 1 ... 65500 each: more a JPEG cannot have
  std::uint32_t channels = 3;           ///< 3; not jpeg: or 4
};

class RowWriter {
 public:
  virtual ~RowWriter() = default;
  /// The next row from the top: width * channels bytes. Throws what the sink throws.
  virtual void write_row(const std::uint8_t* row) = 0;
  /// Required after the last row. Throws what the sink throws.
  virtual void finish() = 0;
};

/// O(width) memory. A JPEG decodes to the same picture as that of encode_image(), and is larger by
/// some percent: its codes are the standard's.
std::unique_ptr<RowWriter> open_row_writer(const WrittenImage& image, ByteSink sink);

/// In any format. What has no rows, and pictures in jpeg that are small enough, are held whole and
/// written at the end, as encode_image() does.
std::unique_ptr<RowWriter> open_picture_writer(const WrittenImage& image, ByteSink sink);
/// What it holds at most, besides the sink's bytes.
std::uint64_t held_bytes(const WrittenImage& image);

}  // namespace meshhier::images
