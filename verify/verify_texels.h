// Proves that the partitions of a textured hierarchy show the input's texels.
#pragma once

#include "verify/verify_parts.h"

#include <memory>
#include <span>

namespace meshhier::importing {
class MeshInput;
}

namespace meshhier::verifying {

/// A corner of a triangle of the input, as the hierarchy stores its position.
struct InputCorner {
  Vec3f position;
  Vec2f texcoord;
  std::uint32_t material = 0;
  friend bool operator==(const InputCorner&, const InputCorner&) = default;
};

/// Takes the input's triangles, then compares their texels with those of the tiles. For one thread.
class TexelCheck {
 public:
  /// Requires that `input` has been imported; both must outlive it.
  TexelCheck(const VerifyJob& job, const importing::MeshInput& input);
  ~TexelCheck();

  void add(const Triangle<InputCorner>& triangle);
  /// Compares, and adds problems and checks to the job's.
  void compare();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshhier::verifying
