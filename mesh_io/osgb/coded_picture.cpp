#include "mesh_io/osgb/coded_picture.h"

#include "images/image_codec.h"
#include "mesh_io/osgb/kept_scene.h"
#include "mesh_io/osgb/stored_png.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace meshhier::mesh_io::osgb {
namespace {

/// A format of texels in memory: how many bytes one has, and which are red, green, blue, alpha.
struct TexelRow {
  GLenum format;
  std::uint32_t bytes;
  std::uint32_t channels;
  std::array<std::uint32_t, 4> from;
};

constexpr std::array kTexels{
    TexelRow{GL_RGB, 3, 3, {0, 1, 2, 0}},       TexelRow{GL_RGBA, 4, 4, {0, 1, 2, 3}},
    TexelRow{GL_BGR, 3, 3, {2, 1, 0, 0}},       TexelRow{GL_BGRA, 4, 4, {2, 1, 0, 3}},
    TexelRow{GL_LUMINANCE, 1, 3, {0, 0, 0, 0}}, TexelRow{GL_LUMINANCE_ALPHA, 2, 4, {0, 0, 0, 1}},
    TexelRow{GL_RED, 1, 3, {0, 0, 0, 0}},
};

images::Image plain(const osg::Image& image, const TexelRow& row) {
  images::Image made(static_cast<std::uint32_t>(image.s()), static_cast<std::uint32_t>(image.t()),
                     row.channels);
  for (std::uint32_t y = 0; y < made.height; ++y) {
    const unsigned char* from = image.data(0, made.height - 1 - y);
    std::uint8_t* to = made.at(0, y);
    for (std::uint32_t x = 0; x < made.width; ++x, from += row.bytes, to += row.channels) {
      for (std::uint32_t k = 0; k < row.channels; ++k)
        to[k] = from[row.from[k]];
    }
  }
  return made;
}

// ---- DXT (S3TC): blocks of 4 x 4 texels, row by row
//
//   8 bytes   two colours of 5, 6 and 5 bits; 16 numbers of 2 bits, of the palette between them
//   8 before  of DXT3: 16 alphas of 4 bits; of DXT5: two alphas, 16 numbers of 3 bits

struct DxtRow {
  GLenum format;
  std::uint32_t block_bytes;
  std::uint32_t channels;
  bool has_ramp;  ///< of alpha: DXT5
};

constexpr std::array kDxt{
    DxtRow{GL_COMPRESSED_RGB_S3TC_DXT1_EXT, 8, 3, false},
    DxtRow{GL_COMPRESSED_RGBA_S3TC_DXT1_EXT, 8, 4, false},
    DxtRow{GL_COMPRESSED_RGBA_S3TC_DXT3_EXT, 16, 4, false},
    DxtRow{GL_COMPRESSED_RGBA_S3TC_DXT5_EXT, 16, 4, true},
};

using Texel = std::array<std::uint8_t, 4>;
using Block = std::array<Texel, 16>;

Texel expanded(std::uint32_t colour) {
  const std::uint32_t r = colour >> 11, g = colour >> 5 & 63, b = colour & 31;
  return {static_cast<std::uint8_t>(r << 3 | r >> 2), static_cast<std::uint8_t>(g << 2 | g >> 4),
          static_cast<std::uint8_t>(b << 3 | b >> 2), 255};
}

/// Returns (a * wa + b * wb) / (wa + wb) of the colours.
Texel mixed(const Texel& a, unsigned wa, const Texel& b, unsigned wb) {
  Texel all{0, 0, 0, 255};
  for (std::size_t k = 0; k < 3; ++k)
    all[k] = static_cast<std::uint8_t>((a[k] * wa + b[k] * wb) / (wa + wb));
  return all;
}

void read_colours(const unsigned char* bytes, bool is_dxt1, Block& block) {
  const std::uint32_t first = bytes[0] | bytes[1] << 8, second = bytes[2] | bytes[3] << 8;
  std::array<Texel, 4> palette{expanded(first), expanded(second)};
  if (!is_dxt1 || first > second) {
    palette[2] = mixed(palette[0], 2, palette[1], 1);
    palette[3] = mixed(palette[0], 1, palette[1], 2);
  } else {
    palette[2] = mixed(palette[0], 1, palette[1], 1);
    palette[3] = {0, 0, 0, 0};
  }
  for (std::size_t i = 0; i < block.size(); ++i)
    block[i] = palette[bytes[4 + i / 4] >> i % 4 * 2 & 3];
}

void read_alphas(const unsigned char* bytes, Block& block) {
  for (std::size_t i = 0; i < block.size(); ++i)
    block[i][3] = static_cast<std::uint8_t>((bytes[i / 2] >> i % 2 * 4 & 15) * 17);
}

void read_ramp(const unsigned char* bytes, Block& block) {
  const unsigned a = bytes[0], b = bytes[1];
  std::array<std::uint8_t, 8> ramp{bytes[0], bytes[1]};
  const unsigned steps = a > b ? 7 : 5;
  for (unsigned i = 1; i < steps; ++i)
    ramp[i + 1] = static_cast<std::uint8_t>(((steps - i) * a + i * b) / steps);
  if (steps == 5) {
    ramp[6] = 0;
    ramp[7] = 255;
  }
  std::uint64_t numbers = 0;
  for (std::size_t i = 0; i < 6; ++i)
    numbers |= std::uint64_t{bytes[2 + i]} << 8 * i;
  for (std::size_t i = 0; i < block.size(); ++i)
    block[i][3] = ramp[numbers >> 3 * i & 7];
}

images::Image from_dxt(const osg::Image& image, const DxtRow& row) {
  images::Image made(static_cast<std::uint32_t>(image.s()), static_cast<std::uint32_t>(image.t()),
                     row.channels);
  const unsigned char* bytes = image.data();
  for (std::uint32_t y0 = 0; y0 < made.height; y0 += 4) {
    for (std::uint32_t x0 = 0; x0 < made.width; x0 += 4, bytes += row.block_bytes) {
      Block block{};
      read_colours(bytes + (row.block_bytes - 8), row.block_bytes == 8, block);
      if (row.block_bytes == 16)
        row.has_ramp ? read_ramp(bytes, block) : read_alphas(bytes, block);
      for (std::uint32_t i = 0; i < 16; ++i) {
        const std::uint32_t x = x0 + i % 4, y = y0 + i / 4;
        if (x < made.width && y < made.height)
          std::copy_n(block[i].data(), row.channels, made.at(x, made.height - 1 - y));
      }
    }
  }
  return made;
}

/// The format of an image's texels: one of the two.
struct Format {
  const TexelRow* texels = nullptr;
  const DxtRow* dxt = nullptr;
  std::uint32_t channels() const { return dxt != nullptr ? dxt->channels : texels->channels; }
};

Format format_of(const osg::Image& image) {
  const auto dxt = std::ranges::find(kDxt, image.getPixelFormat(), &DxtRow::format);
  if (dxt != kDxt.end())
    return {nullptr, &*dxt};
  const auto texels = std::ranges::find(kTexels, image.getPixelFormat(), &TexelRow::format);
  if (texels == kTexels.end() || image.getDataType() != GL_UNSIGNED_BYTE)
    throw std::runtime_error("a picture has texels of a format that is not read");
  return {&*texels, nullptr};
}

images::Image decoded(const osg::Image& image) {
  const Format format = format_of(image);
  return format.dxt != nullptr ? from_dxt(image, *format.dxt) : plain(image, *format.texels);
}

// ---- what an image of the library is

struct Source {
  std::string file{};  ///< as it lies in the OSGB; empty: it has texels
  osg::ref_ptr<const osg::Image> texels{};
};

bool is_side(int side) {
  return side > 0 && static_cast<std::uint32_t>(side) <= images::kMaxSourceSide;
}

Source source_of(const osg::Image& image) {
  const auto* const kept = dynamic_cast<const KeptImage*>(&image);
  if (kept == nullptr)
    return {{}, &image};
  const osg::ref_ptr<osg::Image> dds = decode_dds(kept->bytes);
  return dds ? Source{{}, dds} : Source{kept->bytes, {}};
}

bool has_texels(const osg::Image& image) {
  return image.data() != nullptr && is_side(image.s()) && is_side(image.t());
}

PngSize size_of(const osg::Image& image) {
  return {static_cast<std::uint32_t>(image.s()), static_cast<std::uint32_t>(image.t()),
          format_of(image).channels()};
}

}  // namespace

std::string picture_start(const osg::Image& image) {
  const Source source = source_of(image);
  if (!source.texels)
    return source.file;
  return has_texels(*source.texels) ? png_start(size_of(*source.texels)) : "";
}

std::string coded_picture(const osg::Image& image) {
  const Source source = source_of(image);
  if (!source.texels)
    return source.file;
  return has_texels(*source.texels) ? png_of(decoded(*source.texels)) : "";
}

}  // namespace meshhier::mesh_io::osgb
