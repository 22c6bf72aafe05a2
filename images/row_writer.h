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

/// The picture that is written; format and quality as encode_image() has them.
struct WrittenImage {
  ImageFormat format = ImageFormat::jpeg;  ///< for open_row_writer(): jpeg or png
  int quality = 90;
  std::uint32_t width = 0, height = 0;  ///< 1 ... FormatCoders::most_side each
  std::uint32_t channels = 3;           ///< 3; formats other than jpeg: or 4
  std::uint32_t dots_per_metre = 0;     ///< of its print, as a png tells it; 0: not told
};

/// Writes a picture from the top. Without finish() the file is not whole. For one thread.
class RowWriter {
 public:
  virtual ~RowWriter() = default;
  /// Takes the next row from the top: width * channels bytes. Throws what the sink throws.
  virtual void write_row(const std::uint8_t* row) = 0;
  /// Required after the last row. Throws what the sink throws.
  virtual void finish() = 0;
};

/// Opens a writer that holds O(width) memory. Requires a format with FormatCoders::open_rows. A
/// JPEG decodes to the same picture as that of encode_image(), and is larger by some percent: its
/// codes are the standard's.
std::unique_ptr<RowWriter> open_row_writer(const WrittenImage& image, ByteSink sink);

/// Opens a writer for any format. Pictures of formats without rows, and small ones in jpeg, are
/// held whole and written at the end, as encode_image() does.
std::unique_ptr<RowWriter> open_picture_writer(const WrittenImage& image, ByteSink sink);
/// Returns the memory that open_picture_writer()'s writer holds at most, besides the sink's bytes.
std::uint64_t held_bytes(const WrittenImage& image);

}  // namespace meshhier::images
