// How much of the sky the places of a picture see: hollows and what lies behind edges are darker
// (Bavoil, Sainz & Dimitrov, Image-space horizon-based ambient occlusion, 2008).
#pragma once

#include "render/raster.h"

#include <cstdint>
#include <vector>

namespace meshhier::render {

/// What is seen of the sky, 0 (none) to 1 (all), from places of a picture.
class Occlusion {
 public:
  /// `raster`: the whole picture, or the same with fewer pixels. `relief`: heights count as if they
  /// were so many times as high. A pure function; 4 bytes a sample, about 60 samples looked at for
  /// each. Requires at least one pixel.
  Occlusion(const Raster& raster, double relief);

  /// At a place of the picture, its left upper corner (0, 0), its right lower one (1, 1): mixed
  /// from the four nearest samples.
  double sky_at(double across, double down) const;

 private:
  std::uint32_t columns_, rows_;
  std::vector<float> sky_;
};

}  // namespace meshhier::render
