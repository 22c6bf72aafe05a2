// A picture as a texture: looked up with filtering (Williams, Pyramidal parametrics, 1983).
#pragma once

#include "hierarchy/texture.h"
#include "hierarchy/vec.h"
#include "images/image.h"

#include <cstdint>
#include <vector>

namespace meshhier::render {

struct Wraps {
  Wrap u = Wrap::repeat, v = Wrap::repeat;
};

/// The picture and its pyramid, 8 bits a channel, all in memory. Immutable, thread-safe.
class MipTexture {
 public:
  /// Alpha is left out. Requires a picture of a texel or more. O(texels).
  explicit MipTexture(images::Image picture, Wraps wraps = {});

  std::uint32_t width() const { return levels_.front().width; }
  std::uint32_t height() const { return levels_.front().height; }

  /// Linear light, 0 to 1: mixed from four texels of each of two levels of the pyramid. `level`: 0
  /// is the picture itself, each further one has half of its width and height. What is no number is
  /// looked up at 0.
  Vec3f light_at(Vec2f texcoord, double level) const;

 private:
  Vec3d light_on(std::uint32_t level, Vec2f texcoord) const;

  std::vector<images::Image> levels_;
  Wraps wraps_;
};

/// Level at which a texel has as much area as a sample, of a facet on which a sample covers so many
/// texels: half of their logarithm to base 2, between powers of 2 by straight lines. 0 of what is
/// below 1, or no number.
double level_for(double texels_a_sample);

}  // namespace meshhier::render
