// The texels of a picture as a material shows them.
#pragma once

#include "images/image.h"
#include "images/image_store.h"
#include "images/material_list.h"

#include <array>
#include <cstdint>

namespace meshhier::images {

/// Reads part of a picture with a material's wraps and factor. Requires a material with a picture.
class MaterialTexels {
 public:
  MaterialTexels(const Material& material, const ImageStore& pictures);

  /// Of a level of the picture the rectangle that has (x, y) as its upper left texel, into `into`
  /// at (at_x, at_y), as ImageStore::read().
  void read(std::uint32_t level, std::int64_t x, std::int64_t y, std::uint32_t width,
            std::uint32_t height, Image& into, std::uint32_t at_x, std::uint32_t at_y) const;

 private:
  void tint(std::uint8_t* texel, std::uint32_t channels) const {
    for (std::uint32_t c = 0; c < channels; ++c)
      texel[c] = tinted_[c][texel[c]];
  }

  const ImageStore& pictures_;
  std::uint32_t image_;
  Wrap wrap_u_, wrap_v_;
  bool is_tinted_;
  std::array<std::array<std::uint8_t, 256>, 4> tinted_{};  ///< by channel and value
};

}  // namespace meshhier::images
