// Textures: coordinates, and the picture that a tile shows on its triangles.
#pragma once

#include "base/named_value.h"
#include "hierarchy/image_format.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier {

/// A texture coordinate as glTF has it: (0, 0) is the upper left corner of a picture, (1, 1) the
/// lower right one.
struct Vec2f {
  float u = 0, v = 0;
  friend constexpr bool operator==(const Vec2f&, const Vec2f&) = default;
};
static_assert(sizeof(Vec2f) == 8);

/// How a picture goes on beyond 0 ... 1.
enum class Wrap : std::uint8_t { repeat, mirrored, clamp };

/// The meaning of alpha. Ordered: the last one of several in a tile counts.
enum class AlphaMode : std::uint8_t { opaque, mask, blend };
/// As glTF calls them.
inline constexpr std::array kAlphaModes{NamedValue{"OPAQUE", AlphaMode::opaque},
                                        NamedValue{"MASK", AlphaMode::mask},
                                        NamedValue{"BLEND", AlphaMode::blend}};

/// The picture of a tile, as its file has it.
struct TileImage {
  ImageFormat format = ImageFormat::jpeg;
  AlphaMode alpha = AlphaMode::opaque;  ///< other than opaque: `format` has alpha
  std::uint32_t width = 0, height = 0;  ///< texels, 1 ... kMaxImageSide; 0: there is none
  std::vector<std::byte> bytes;         ///< encoded

  bool empty() const { return width == 0; }
  friend bool operator==(const TileImage&, const TileImage&) = default;
};
/// No picture of a tile is larger: WebP has no larger ones, and many GPUs neither.
inline constexpr std::uint32_t kMaxImageSide = 8192;

/// The format of all pictures of a hierarchy's tiles.
struct TextureFormat {
  ImageFormat format = ImageFormat::jpeg;  ///< see stored_format()
  int quality = 90;                        ///< 1 ... kBestQuality
  bool unlit = true;                       ///< colours have their light already
  friend constexpr bool operator==(const TextureFormat&, const TextureFormat&) = default;
};

/// The format of all normal maps of a hierarchy's tiles.
struct NormalMapFormat {
  ImageFormat format = ImageFormat::jpeg;  ///< jpeg: of red, green and blue as they are
  int quality = 85;                        ///< 1 ... kBestQuality, if graded_maps
  friend constexpr bool operator==(const NormalMapFormat&, const NormalMapFormat&) = default;
};

/// How a picture of that alpha is stored: as PNG if the format has none.
constexpr ImageFormat stored_format(const TextureFormat& textures, AlphaMode alpha) {
  const bool lacks_alpha = alpha != AlphaMode::opaque && !row_of(textures.format).has_alpha;
  return lacks_alpha ? ImageFormat::png : textures.format;
}

}  // namespace meshhier
