// How a model stands in a picture: which of its axes is up, and how many times higher it is than
// wide (as viewer/src/scene/standing.ts has it).
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "hierarchy/frame.h"
#include "render/scene.h"

#include <array>
#include <string_view>

namespace meshhier::render {

/// Brings a model's coordinates to those of the page's world: y is up.
class Standing {
 public:
  /// `up`: "x" to "-z", any other word: as the file says; `stretch`: at least 1.
  Standing(std::string_view up, UpAxis of_file, double stretch);

  Vec3d upright(Vec3d place) const {
    return {dot(rows_[0], place), dot(rows_[1], place) * stretch_, dot(rows_[2], place)};
  }
  /// The direction that is up, in the model's coordinates.
  Vec3d upwards() const { return rows_[1]; }
  double stretch() const { return stretch_; }

  BoundsD upright(const BoundsD& box) const;
  void stand(SceneTile& tile) const;

 private:
  /// A normal stays across its surface.
  Vec3f upright_normal(Vec3f normal) const;

  std::array<Vec3d, 3> rows_;
  double stretch_;
};

}  // namespace meshhier::render
