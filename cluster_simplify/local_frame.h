// A tile's own coordinates: single precision, about its middle, of size one.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Products of six coordinates overflow for meshes given in nanometres or light years, and lose
/// digits far from zero. Scaled by a power of two and shifted, they do neither.
class LocalFrame {
 public:
  /// `surface`: the box of what has triangles; may be empty. What lies far outside loses nothing
  /// that matters, and must not take the digits of what is drawn.
  explicit LocalFrame(const Bounds& surface);

  Vec3f to_local(Vec3f position) const;
  std::vector<Vec3f> to_local(std::span<const Vec3f> positions) const;
  /// Places beyond the largest float come to lie on it.
  Vec3f to_global(Vec3f local) const;
  /// A local length in the coordinates of the mesh.
  double to_global(double local) const { return local / scale_; }
  /// No position is moved farther by rounding on its way there and back.
  double rounding() const { return rounding_; }

 private:
  Vec3d middle_;
  double scale_ = 1;
  double rounding_ = 0;
};

}  // namespace meshhier::cluster_simplify
