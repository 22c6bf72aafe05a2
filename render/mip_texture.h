// A picture as a texture: looked up with filtering (Williams, Pyramidal parametrics, 1983).
#pragma once

#include "base/vec.h"
#include "hierarchy/texture.h"
#include "images/image.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::render {

struct Wraps {
  Wrap u = Wrap::repeat, v = Wrap::repeat;
};

/// The meaning of texels: light of a screen, or the numbers of a normal map.
enum class TexelKind { light, numbers };

/// The picture and its pyramid, 8 bits a channel, all in memory. Immutable, thread-safe.
class MipTexture {
 public:
  /// Alpha is left out if it is opaque. Requires a picture of a texel or more. O(texels).
  explicit MipTexture(images::Image picture, Wraps wraps = {}, AlphaMode alpha = AlphaMode::opaque,
                      TexelKind kind = TexelKind::light);

  std::uint32_t width() const { return levels_.front().width; }
  std::uint32_t height() const { return levels_.front().height; }
  bool is_opaque() const { return alpha_ == AlphaMode::opaque; }

  /// Linear light (or numbers), 0 to 1: mixed from four texels of each of two levels of the
  /// pyramid. `level`: 0 is the picture itself, each further one has half of its width and height.
  /// A coordinate that is no number counts as 0.
  Vec3f light_at(Vec2f texcoord, double level) const;

  /// Whether a sample is seen at a place: of a mask where alpha is 0.5 or more, of what is to blend
  /// where alpha is more than `threshold`, 0 to 1, different for each sample of a pixel.
  bool is_seen_at(Vec2f texcoord, double level, double threshold) const;

  /// Two texels side by side, and the share of the second one.
  struct TexelPair {
    std::array<std::uint32_t, 2> texels{};
    double share = 0;
  };

 private:
  /// The four around a place.
  struct TexelSquare {
    TexelPair across, down;
  };
  TexelSquare square_on(std::uint32_t level, Vec2f texcoord) const;
  double alpha_on(std::uint32_t level, Vec2f texcoord) const;
  Vec3d light_on(std::uint32_t level, Vec2f texcoord) const;
  template <class Texel>
  static Vec3d mixed(const images::Image& image, const TexelSquare& square, const Texel& texel);

  std::vector<images::Image> levels_;
  Wraps wraps_;
  AlphaMode alpha_;
  TexelKind kind_;
};

/// Level at which a texel has as much area as a sample, of a facet on which a sample covers so many
/// texels: half of their logarithm to base 2, between powers of 2 by straight lines. 0 of what is
/// below 1, or no number.
double level_for(double texels_a_sample);

}  // namespace meshhier::render
