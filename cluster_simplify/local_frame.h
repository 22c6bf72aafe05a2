// A tile's own coordinates: single precision, about its middle, of size one.
#pragma once

#include "hierarchy/vec.h"

#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Products of six coordinates overflow for meshes given in nanometres or light years, and lose
/// digits far from zero. Scaled by a power of two and shifted, they do neither.
class LocalFrame {
 public:
  /// `positions`: finite, may be empty.
  explicit LocalFrame(std::span<const Vec3f> positions);

  std::vector<Vec3f> to_local(std::span<const Vec3f> positions) const;
  /// Places beyond the largest float come to lie on it.
  Vec3f to_global(Vec3f local) const;

 private:
  Vec3d middle_;
  double scale_ = 1;
};

}  // namespace meshhier::cluster_simplify
