#include "tests/images/samples.h"

#include "base/error.h"
#include "tests/support/error_message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <gtest/gtest.h>
#include <jpeglib.h>
#include <png.h>
#include <webp/encode.h>

namespace meshhier::images {
namespace {

std::uint32_t next_random(std::uint32_t& state) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

/// A wave between 20 and 235, of straight lines.
std::uint32_t wave(std::uint32_t x, std::uint32_t period) {
  const std::uint32_t place = x % (2 * period);
  return 20 + 215 * (place < period ? place : 2 * period - 1 - place) / period;
}

J_COLOR_SPACE stored_space(const JpegKind& kind) {
  if (kind.components == 1)
    return JCS_GRAYSCALE;
  if (kind.components == 3)
    return kind.separate ? JCS_RGB : JCS_YCbCr;
  return kind.separate ? JCS_CMYK : JCS_YCCK;
}

/// A row of what goes into the library.
std::vector<std::uint8_t> samples_of(const Image& image, std::uint32_t y, const JpegKind& kind) {
  std::vector<std::uint8_t> row;
  for (std::uint32_t x = 0; x < image.width; ++x) {
    const std::uint8_t* texel = image.at(x, y);
    for (int c = 0; c < std::min(kind.components, 3); ++c)
      row.push_back(kind.components == 4 && !kind.adobe ? static_cast<std::uint8_t>(255 - texel[c])
                                                        : texel[c]);
    if (kind.components == 4)
      row.push_back(kind.adobe ? 255 : 0);
  }
  return row;
}

}  // namespace

Image waves(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image(width, height, channels);
  std::uint32_t state = 12345;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::array<std::uint32_t, 4> colour{wave(x + y, 40), wave(x + 2 * y + 30, 90),
                                                wave(3 * x + y + 7, 120), wave(x + y, 17)};
      for (std::uint32_t c = 0; c < channels; ++c)
        image.at(x, y)[c] = static_cast<std::uint8_t>(colour[c] + next_random(state) % 4);
    }
  }
  return image;
}

Image smooth(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image(width, height, channels);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      for (std::uint32_t k = 0; k < channels; ++k)
        image.at(x, y)[k] = static_cast<std::uint8_t>(128 + 100 * std::sin(0.05 * x * (k + 1)) *
                                                                std::cos(0.04 * y + k));
    }
  }
  return image;
}

Image noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels, std::uint32_t seed) {
  Image image(width, height, channels);
  std::uint32_t state = 2654435761U * seed + 1;
  for (std::uint8_t& value : image.texels)
    value = static_cast<std::uint8_t>(next_random(state) >> 11);
  return image;
}

Bytes jpeg_file(const Image& image, const JpegKind& kind) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* file = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &file, &size);
  jpeg.image_width = image.width;
  jpeg.image_height = image.height;
  jpeg.input_components = kind.components;
  jpeg.in_color_space = kind.components == 1   ? JCS_GRAYSCALE
                        : kind.components == 3 ? JCS_RGB
                                               : JCS_CMYK;
  jpeg_set_defaults(&jpeg);
  jpeg_set_colorspace(&jpeg, stored_space(kind));
  jpeg_set_quality(&jpeg, kind.quality, TRUE);
  jpeg.write_Adobe_marker =
      kind.components == 4 ? (kind.adobe ? TRUE : FALSE) : jpeg.write_Adobe_marker;
  jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = kind.factor;
  jpeg.arith_code = kind.arithmetic ? TRUE : FALSE;
  jpeg.restart_in_rows = kind.restart;
  if (kind.progressive)
    jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    std::vector<std::uint8_t> row = samples_of(image, y, kind);
    JSAMPROW samples = row.data();
    jpeg_write_scanlines(&jpeg, &samples, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  const auto* first = reinterpret_cast<const std::byte*>(file);
  Bytes bytes(first, first + size);
  std::free(file);
  return bytes;
}

Bytes png_file(std::uint32_t width, std::uint32_t height, const PngKind& kind,
               const std::vector<std::uint8_t>& rows) {
  Bytes bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop head = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, std::size_t count) {
        const auto* first = reinterpret_cast<const std::byte*>(data);
        auto& file = *static_cast<Bytes*>(png_get_io_ptr(p));
        file.insert(file.end(), first, first + count);
      },
      [](png_structp) {});
  png_set_IHDR(png, head, width, height, kind.depth, kind.colour,
               kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
  std::vector<png_color> palette(kind.palette.size() / 3);
  for (std::size_t i = 0; i < palette.size(); ++i)
    palette[i] = {kind.palette[3 * i], kind.palette[3 * i + 1], kind.palette[3 * i + 2]};
  if (!palette.empty())
    png_set_PLTE(png, head, palette.data(), static_cast<int>(palette.size()));
  const auto& t = kind.transparency;
  png_color_16 key{};
  if (kind.colour == 0 && !t.empty())
    key.gray = static_cast<png_uint_16>(t[0] << 8 | t[1]);
  if (kind.colour == 2 && !t.empty())
    key = {0, static_cast<png_uint_16>(t[0] << 8 | t[1]),
           static_cast<png_uint_16>(t[2] << 8 | t[3]), static_cast<png_uint_16>(t[4] << 8 | t[5]),
           0};
  if (!t.empty() && kind.colour == 3)
    png_set_tRNS(png, head, t.data(), static_cast<int>(t.size()), nullptr);
  if (!t.empty() && kind.colour != 3)
    png_set_tRNS(png, head, nullptr, 1, &key);
  png_write_info(png, head);
  const std::size_t row_bytes = rows.size() / height;
  std::vector<png_bytep> pointers;
  for (std::uint32_t y = 0; y < height; ++y)
    pointers.push_back(const_cast<png_bytep>(rows.data()) + y * row_bytes);
  png_write_image(png, pointers.data());
  png_write_end(png, head);
  png_destroy_write_struct(&png, &head);
  return bytes;
}

Bytes webp_file(const Image& image, int quality) {
  std::uint8_t* file = nullptr;
  std::size_t size = 0;
  const auto* texels = image.texels.data();
  const auto width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const int stride = width * static_cast<int>(image.channels);
  const auto factor = static_cast<float>(quality);
  if (image.channels == 4) {
    size = quality == 100 ? WebPEncodeLosslessRGBA(texels, width, height, stride, &file)
                          : WebPEncodeRGBA(texels, width, height, stride, factor, &file);
  } else {
    size = quality == 100 ? WebPEncodeLosslessRGB(texels, width, height, stride, &file)
                          : WebPEncodeRGB(texels, width, height, stride, factor, &file);
  }
  const auto* first = reinterpret_cast<const std::byte*>(file);
  Bytes bytes(first, first + size);
  WebPFree(file);
  return bytes;
}

ByteSource source_of(const Bytes& bytes, std::size_t most_at_once) {
  return [&bytes, most_at_once](std::uint64_t offset, std::span<std::byte> into) {
    if (offset >= bytes.size())
      return std::size_t{0};
    const std::size_t count = std::min({into.size(), bytes.size() - offset, most_at_once});
    std::memcpy(into.data(), bytes.data() + offset, count);
    return count;
  };
}

Image decoded(const Bytes& bytes) {
  return decode_image(bytes, "sample", 1 << 24);
}

std::string refusal(const std::function<void()>& call) {
  return tests::error_message(ErrorCode::input, call);
}

int difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.texels.size(), b.texels.size());
  int most = 0;
  for (std::size_t i = 0; i < std::min(a.texels.size(), b.texels.size()); ++i)
    most = std::max(most, std::abs(a.texels[i] - b.texels[i]));
  return most;
}

std::vector<NamedFile> small_files() {
  const Image image = waves(21, 19), clear = waves(21, 19, 4);
  const auto png = [](const PngKind& kind, std::size_t row_bytes) {
    const Image rows = noise(static_cast<std::uint32_t>(row_bytes), 19, 1);
    return png_file(21, 19, kind, rows.texels);
  };
  const std::vector<std::uint8_t> palette = noise(16, 1).texels;
  return {
      {"jpeg_baseline", jpeg_file(image, {.factor = 2, .restart = 1, .quality = 80})},
      {"jpeg_progressive", jpeg_file(image, {.factor = 2, .progressive = true, .quality = 80})},
      {"jpeg_arithmetic", jpeg_file(image, {.arithmetic = true, .quality = 80})},
      {"jpeg_grey", jpeg_file(image, {.components = 1, .quality = 80})},
      {"jpeg_rgb", jpeg_file(image, {.separate = true, .quality = 80})},
      {"jpeg_cmyk", jpeg_file(image, {.components = 4, .separate = true, .quality = 80})},
      {"jpeg_ycck", jpeg_file(image, {.components = 4, .adobe = true, .quality = 80})},
      {"png_rgb", png({.colour = 2}, 63)},
      {"png_rgb_16_key", png({.colour = 2, .depth = 16, .transparency = {1, 2, 3, 4, 5, 6}}, 126)},
      {"png_rgba_interlaced", png({.colour = 6, .interlaced = true}, 84)},
      {"png_grey_1", png({.colour = 0, .depth = 1}, 3)},
      {"png_grey_alpha_16", png({.colour = 4, .depth = 16}, 84)},
      {"png_palette_4", png({.colour = 3, .depth = 4, .palette = palette}, 11)},
      {"png_palette_4_alpha",
       png({.colour = 3, .depth = 4, .palette = palette, .transparency = {0, 90, 180}}, 11)},
      {"webp_lossy", webp_file(image, 80)},
      {"webp_lossy_alpha", webp_file(clear, 80)},
      {"webp_lossless", webp_file(image, 100)},
      {"webp_lossless_alpha", webp_file(clear, 100)},
      {"ktx2_uastc", encode_image(waves(24, 20), ImageFormat::ktx2, kBestQuality)},
      {"ktx2_uastc_alpha", encode_image(waves(24, 20, 4), ImageFormat::ktx2, kBestQuality)}};
}

}  // namespace meshhier::images
