// The texels of a picture as a material shows them.
#pragma once

#include "images/image.h"
#include "images/image_store.h"
#include "images/material_list.h"

#include <array>
#include <cstdint>

namespace meshhier::images {

/// Reads part of a picture with a material's wraps, factor and light. Alpha is full where the
/// material is opaque; that of a mask is scaled so that its cutoff becomes 0.5, glTF's own.
/// Requires a material with a picture.
class MaterialTexels {
 public:
  MaterialTexels(const Material& material, const ImageStore& pictures);

  /// Reads the rectangle of a level that has (x, y) as its upper left texel, into `into` at (at_x,
  /// at_y), as ImageStore::read(). Thread-safe.
  void read(std::uint32_t level, std::int64_t x, std::int64_t y, std::uint32_t width,
            std::uint32_t height, Image& into, std::uint32_t at_x, std::uint32_t at_y) const;

 private:
  void tint(Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t width,
            std::uint32_t height) const;

  const ImageStore& pictures_;
  std::uint32_t image_;
  Wrap wrap_u_, wrap_v_;
  std::uint32_t tinted_channels_ = 0;  ///< a bit each: channels that the factor or the light change
  std::array<std::array<std::uint8_t, 256>, 4> tinted_{};  ///< by channel and value
};

}  // namespace meshhier::images
