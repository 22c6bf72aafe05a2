// Two axes at right angles to a direction.
#pragma once

#include "base/vec.h"

#include <cmath>

namespace meshhier {

/// Two axes of length one, with `n` a right-handed frame (u, v, n). Without roots or branches (Duff
/// et al., Building an Orthonormal Basis, Revisited, 2017).
template <class Scalar>
struct TangentFrame {
  Vec3<Scalar> u, v;

  /// `n`: of length one.
  explicit TangentFrame(Vec3<Scalar> n) {
    const Scalar sign = std::copysign(Scalar{1}, n.z);
    const Scalar a = -1 / (sign + n.z);
    const Scalar b = n.x * n.y * a;
    u = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    v = {b, sign + n.y * n.y * a, -n.y};
  }
};

}  // namespace meshhier
