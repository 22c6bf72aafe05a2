#include "support/sample_texture.h"

#include "hierarchy/shown_corners.h"
#include "hierarchy/tangent_code.h"
#include "storage/format/tile_plan.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include <zlib.h>

namespace meshhier::tests {
namespace {

constexpr std::uint32_t kWidth = 16, kHeight = 8;

// Pictures of kWidth * kHeight texels, as libjpeg-turbo, libwebp and ktx2-encoder (ETC1S) made
// them.
constexpr std::string_view kJpeg =
    "ffd8ffe000104a46494600010100000100010000ffdb004300100b0c0e0c0a100e0d0e1211101318281a1816"
    "16183123251d283a333d3c3933383740485c4e404457453738506d51575f626768673e4d71797064785c6567"
    "63ffdb0043011112121815182f1a1a2f63423842636363636363636363636363636363636363636363636363"
    "6363636363636363636363636363636363636363636363636363ffc000110800080010030111000211010311"
    "01ffc4001500010100000000000000000000000000000003ffc4001410010000000000000000000000000000"
    "0000ffc4001501010100000000000000000000000000000005ffc40014110100000000000000000000000000"
    "000000ffda000c03010002110311003f00a232b00fffd9";
constexpr std::string_view kWebp =
    "524946461e000000574542505650384c110000002f0fc001000750bc2217a5ff8188e87f0000";
constexpr std::string_view kWebpAlpha =
    "5249464620000000574542505650384c130000002f0fc001100f3078833c28f31ff0a86a44ff0300";

constexpr std::string_view kKtx2 =
    "ab4b5458203230bb0d0a1a0a0000000001000000100000000800000000000000000000000100000005000000"
    "01000000c80000002c000000f4000000240000001801000000000000d800000000000000f401000000000000"
    "02000000000000000000000000000000f30100000000000001000000000000000000000000000000f2010000"
    "0000000001000000000000000000000000000000f10100000000000001000000000000000000000000000000"
    "f001000000000000010000000000000000000000000000002c0000000000000002002800a301020003030000"
    "080000000000000000003f000000000000000000ffffffff1f0000004b545877726974657200426173697320"
    "556e6976657273616c20322e35300000010001002b0000000500000030000000000000000000000000000000"
    "0200000000000000000000000000000000000000010000000000000000000000000000000000000001000000"
    "0000000000000000000000000000000001000000000000000000000000000000000000000100000000000000"
    "0000000001c004000000000000c2039812000000000082a203cc040013000000000000080260060000000000"
    "000964545555550500c1440000000040189643fe940758003001000000000080100226040800000000904c63"
    "00cc0000000000002005080000000001d700";
constexpr std::string_view kKtx2Alpha =
    "ab4b5458203230bb0d0a1a0a0000000001000000100000000800000000000000000000000100000005000000"
    "01000000c80000003c00000004010000240000002801000000000000f0000000000000002102000000000000"
    "060000000000000000000000000000001e02000000000000030000000000000000000000000000001c020000"
    "00000000020000000000000000000000000000001a0200000000000002000000000000000000000000000000"
    "1802000000000000020000000000000000000000000000003c0000000000000002003800a301020003030000"
    "080800000000000000003f000000000000000000ffffffff40003f0f0000000000000000ffffffff1f000000"
    "4b545877726974657200426173697320556e6976657273616c20322e35300000050004003200000011000000"
    "3500000000000000000000000000000002000000020000000400000000000000000000000100000001000000"
    "0200000000000000000000000100000001000000010000000000000000000000010000000100000001000000"
    "000000000000000001000000010000000100000020c084000100000000b244408028000200008020dacd464b"
    "540066000000000000907600440010000000847cc1d5009a6b76545555557d78787818181818000000000000"
    "c14400000000401896c3fd290358013001400000001004bd5404cc0d20000008068047be541ac1280c801900"
    "0000000000a40001000600de005e075200790345e5d801";

std::vector<std::byte> bytes_of(std::string_view digits) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes.push_back(
        static_cast<std::byte>(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16)));
  return bytes;
}

std::vector<std::byte> encoded(ImageFormat format, bool alpha) {
  if (format == ImageFormat::png)
    return sample_png(kWidth, kHeight, alpha);
  if (format == ImageFormat::ktx2)
    return bytes_of(alpha ? kKtx2Alpha : kKtx2);
  return bytes_of(format == ImageFormat::jpeg ? kJpeg : alpha ? kWebpAlpha : kWebp);
}

std::uint64_t hash_of(std::span<const std::uint64_t> numbers) {
  return storage::checksum(std::as_bytes(numbers));
}

void append_big(std::vector<std::byte>& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::byte>(value >> shift & 255));
}

void append_chunk(std::vector<std::byte>& png, std::string_view type,
                  std::span<const std::byte> content) {
  append_big(png, static_cast<std::uint32_t>(content.size()));
  const std::size_t begin = png.size();
  for (const char letter : type)
    png.push_back(static_cast<std::byte>(letter));
  png.insert(png.end(), content.begin(), content.end());
  const auto checked = std::span(png).subspan(begin);
  append_big(png,
             static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(checked.data()),
                                              static_cast<uInt>(checked.size()))));
}

/// Gives vertices and splits their own normals and texture coordinates.
class Unwrapper {
 public:
  explicit Unwrapper(const PublishedTile& tile)
      : shading_(tile.shading),
        vertices_(tile.mesh.vertices.size() + tile.mesh.copies.size()),
        looks_(vertices_),
        interior_(unwrapped(shown_interior(tile))),
        border_(unwrapped(shown_border(tile))) {}

  Shading shading() {
    Shading shading;
    for (std::uint32_t v = 0; v < vertices_; ++v)
      append(shading, looks_[v].empty() ? Look{own_normal(v), {}} : looks_[v].front());
    for (std::uint32_t v = 0; v < vertices_; ++v) {
      for (std::size_t i = 1; i < looks_[v].size(); ++i) {
        append(shading, looks_[v][i]);
        shading.split_of.push_back(v);
      }
    }
    if (!shading.split_of.empty()) {
      shading.interior = numbered(interior_);
      shading.border = numbered(border_);
    }
    return shading;
  }

 private:
  struct Look {
    NormalCode normal{};
    Vec2f texcoord;
    friend bool operator==(const Look&, const Look&) = default;
  };
  /// A vertex, and which of its looks.
  struct Corner {
    std::uint32_t vertex = 0;
    std::size_t look = 0;
  };
  using Corners = std::array<Corner, 3>;

  std::uint32_t vertex_of(TileVertex number) const {
    return raw(number) < vertices_ ? raw(number) : shading_.split_of[raw(number) - vertices_];
  }
  NormalCode own_normal(std::uint32_t number) const {
    return shading_.normals.empty() ? NormalCode{} : shading_.normals[number];
  }

  /// The same for triangles of the same vertices.
  static Vec2f texcoord_of(std::uint64_t triangle, std::uint64_t vertex) {
    const std::uint64_t choice = hash_of(std::array{triangle, vertex}) % (vertex % 3 + 1);
    const std::uint64_t bits = hash_of(std::array{vertex, choice});
    return {static_cast<float>(bits & 1023) / 1023, static_cast<float>(bits >> 10 & 1023) / 1023};
  }

  std::vector<Corners> unwrapped(const std::vector<TileTriangle>& triangles) {
    std::vector<Corners> corners;
    for (const TileTriangle& t : triangles) {
      std::uint64_t name = 0;  // however it is turned
      for (const TileVertex v : t)
        name += hash_of(std::array{std::uint64_t{vertex_of(v)}});
      Corners& of = corners.emplace_back();
      for (std::size_t c = 0; c < 3; ++c)
        of[c] =
            corner(vertex_of(t[c]), {own_normal(raw(t[c])), texcoord_of(name, vertex_of(t[c]))});
    }
    return corners;
  }

  Corner corner(std::uint32_t vertex, const Look& look) {
    std::vector<Look>& looks = looks_[vertex];
    const auto found = std::find(looks.begin(), looks.end(), look);
    const auto place = static_cast<std::size_t>(found - looks.begin());
    if (found == looks.end())
      looks.push_back(look);
    return {vertex, place};
  }

  void append(Shading& shading, const Look& look) const {
    shading.texcoords.push_back(look.texcoord);
    if (!shading_.normals.empty())
      shading.normals.push_back(look.normal);
  }

  std::vector<TileTriangle> numbered(const std::vector<Corners>& corners) const {
    std::vector<std::size_t> first{vertices_};  // split of each vertex
    for (const std::vector<Look>& looks : looks_)
      first.push_back(first.back() + (looks.empty() ? 0 : looks.size() - 1));
    std::vector<TileTriangle> triangles;
    for (const Corners& of : corners) {
      TileTriangle& t = triangles.emplace_back();
      for (std::size_t c = 0; c < 3; ++c)
        t[c] = static_cast<TileVertex>(of[c].look == 0 ? of[c].vertex
                                                       : first[of[c].vertex] + of[c].look - 1);
    }
    return triangles;
  }

  const Shading& shading_;
  std::size_t vertices_;
  std::vector<std::vector<Look>> looks_;  ///< looks of each vertex
  std::vector<Corners> interior_, border_;
};

}  // namespace

std::vector<std::byte> sample_png(std::uint32_t width, std::uint32_t height, bool alpha) {
  const std::uint32_t row = width * (alpha ? 4 : 3);
  std::vector<std::byte> rows;
  for (std::uint32_t y = 0; y < height; ++y) {
    rows.push_back(std::byte{0});  // no filter
    for (std::uint32_t x = 0; x < row; ++x)
      rows.push_back(
          static_cast<std::byte>(hash_of(std::array{std::uint64_t{x}, std::uint64_t{y}})));
  }
  std::vector<std::byte> packed(compressBound(rows.size()));
  uLongf size = packed.size();
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(rows.data()), rows.size(), 9) != Z_OK)
    throw std::runtime_error("zlib cannot be used");
  packed.resize(size);
  std::vector<std::byte> png = bytes_of("89504e470d0a1a0a");
  std::vector<std::byte> head;
  append_big(head, width);
  append_big(head, height);
  for (const int value : {8, alpha ? 6 : 2, 0, 0, 0})
    head.push_back(static_cast<std::byte>(value));
  append_chunk(png, "IHDR", head);
  append_chunk(png, "IDAT", packed);
  append_chunk(png, "IEND", {});
  return png;
}

TileImage sample_image(ImageFormat format, AlphaMode alpha) {
  return {format, alpha, kWidth, kHeight, encoded(format, alpha != AlphaMode::opaque)};
}

Shading with_sample_texcoords(const PublishedTile& tile) {
  return Unwrapper(tile).shading();
}

void add_texture(PublishedTile& tile, const TileImage& image) {
  if (tile.mesh.interior.empty() && tile.mesh.border.empty())
    return;
  tile.shading = with_sample_texcoords(tile);
  tile.image = image;
}

void add_normal_map(PublishedTile& tile, const TileImage& map) {
  if (tile.mesh.interior.empty() && tile.mesh.border.empty())
    return;
  tile.shading = with_sample_texcoords(tile);
  const auto on_grid = [](float part) {
    return storage::map_texcoord(storage::map_texcoord_number(part));
  };
  for (Vec2f& at : tile.shading.texcoords)
    at = {on_grid(at.u), on_grid(at.v)};
  add_relief(tile, map);
}

void add_relief(PublishedTile& tile, const TileImage& map) {
  for (const Vec2f& at : tile.shading.texcoords) {
    const bool is_odd = tile.shading.tangents.size() % 2 == 1;
    tile.shading.tangents.push_back(tangent_code({at.u, is_odd ? -1.0 : 0.5, at.v}, is_odd));
  }
  tile.normal_map = map;
}

void add_textures(Sample& sample, const TextureFormat& format, AlphaMode alpha) {
  sample.format.textures = sample.manifest.textures = format;
  sample.manifest.source.textures = SourceTextures{2, 1, 0, 128};
  for (PublishedTile& tile : sample.tiles) {
    add_texture(tile, sample_image(stored_format(format, alpha), alpha));
    TileRecord& record = sample.record(tile.node);
    record.split_count = static_cast<std::uint32_t>(tile.shading.split_of.size());
    record.image_width = tile.image.width;
    record.image_height = tile.image.height;
    record.texel = tile.image.empty() ? 0 : 0.25F;
  }
}

}  // namespace meshhier::tests
