#include "mesh_io/osgb/stored_png.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include <zlib.h>

namespace meshhier::mesh_io::osgb {
namespace {

constexpr std::size_t kBlockBytes = 65535;
constexpr std::size_t kLongestChunk = (std::size_t{1} << 31) - 1;

/// Appends a number, the first byte the highest.
void append_big(std::string& to, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8)
    to += static_cast<char>(number >> shift);
}

std::uint32_t sum_of(uLong (*sum)(uLong, const Bytef*, uInt), uLong start, const char* bytes,
                     std::size_t count) {
  return static_cast<std::uint32_t>(
      sum(start, reinterpret_cast<const Bytef*>(bytes), static_cast<uInt>(count)));
}

/// Appends the sum of a chunk whose kind begins at `begin`, and which ends here.
void append_sum(std::string& to, std::size_t begin) {
  append_big(to, sum_of(crc32, 0, to.data() + begin, to.size() - begin));
}

/// The rows of a picture with the filter's number before each.
std::size_t row_bytes(const PngSize& size) {
  return std::size_t{size.width} * size.channels + 1;
}

std::size_t packed_bytes(const PngSize& size) {
  const std::size_t rows = row_bytes(size) * size.height;
  return 2 + (rows + kBlockBytes - 1) / kBlockBytes * 5 + rows + 4;
}

std::string rows_of(const images::Image& image) {
  const std::size_t bytes = std::size_t{image.width} * image.channels;
  std::string rows;
  rows.reserve((bytes + 1) * image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    rows += '\0';  // no filter
    rows.append(reinterpret_cast<const char*>(image.at(0, y)), bytes);
  }
  return rows;
}

/// Appends a block of what is not packed: whether it is the last one, its size, that once more.
void append_block(std::string& to, const std::string& rows, std::size_t at) {
  const std::size_t count = std::min(kBlockBytes, rows.size() - at);
  const auto low = static_cast<char>(count), high = static_cast<char>(count >> 8);
  to += {at + count == rows.size() ? '\1' : '\0', low, high, static_cast<char>(~low),
         static_cast<char>(~high)};
  to.append(rows, at, count);
}

}  // namespace

std::string png_start(const PngSize& size) {
  constexpr char kDepth = 8, kRgb = 2, kRgba = 6;
  if (packed_bytes(size) > kLongestChunk)
    throw std::runtime_error("a picture has more texels than are read");
  std::string png = "\x89PNG\r\n\x1a\n";
  append_big(png, 13);
  const std::size_t head = png.size();
  png += "IHDR";
  append_big(png, size.width);
  append_big(png, size.height);
  png += {kDepth, size.channels == 4 ? kRgba : kRgb, 0, 0, 0};
  append_sum(png, head);
  append_big(png, static_cast<std::uint32_t>(packed_bytes(size)));
  return png + "IDAT";
}

std::string png_of(const images::Image& image) {
  const PngSize size{image.width, image.height, image.channels};
  const std::string rows = rows_of(image);
  std::string png = png_start(size);
  const std::size_t data = png.size() - 4;
  png.reserve(png.size() + packed_bytes(size) + 16);
  png += "\x78\x01";
  for (std::size_t at = 0; at < rows.size(); at += kBlockBytes)
    append_block(png, rows, at);
  append_big(png, sum_of(adler32, 1, rows.data(), rows.size()));
  append_sum(png, data);
  append_big(png, 0);
  const std::size_t end = png.size();
  png += "IEND";
  append_sum(png, end);
  return png;
}

}  // namespace meshhier::mesh_io::osgb
