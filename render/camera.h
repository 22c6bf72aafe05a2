// Where a picture is taken from: parallel lines stay parallel (an orthographic view).
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <cstdint>

namespace meshhier::render {

struct View {
  Vec3d direction{0, 0, -1};  ///< from the viewer to the model, not 0
  Vec3d up{0, 1, 0};          ///< an axis takes its place if it is parallel to `direction`
};

struct Framing {
  std::uint32_t width = 512, height = 512;  ///< pixels, 1 to kMostPixels
  std::uint32_t samples = 2;                ///< a pixel has samples x samples, 1 or more
  double margin = 0.04;  ///< left free on each side, of the shorter side; below 0.5
};
inline constexpr std::uint32_t kMostPixels = 8192;

/// Axes of a view, each of length 1.
struct ViewAxes {
  Vec3d right, up, back;  ///< back: to the viewer
};
ViewAxes axes_of(const View& view);

/// How far a box reaches in a view.
struct ViewExtent {
  double across = 0, upright = 0;
};
ViewExtent extent_of(const BoundsD& box, const ViewAxes& axes);

/// Maps space to the grid of samples: x to the right, y down, sample (i, j) in the middle of
/// [i, i + 1] x [j, j + 1]; z away from the viewer, in the same unit.
class Camera {
 public:
  /// Shows all of the box, as large as the frame takes it. Requires a finite box, not empty.
  Camera(const View& view, const BoundsD& box, const Framing& framing);

  /// Shows what is around `centre`; `pixel`: its size, above 0. The margin does not count.
  Camera(const View& view, Vec3d centre, double pixel, const Framing& framing);

  /// The same view in another frame; the part of space that the rows show stays.
  Camera with(const Framing& framing) const;

  const Framing& framing() const { return framing_; }
  std::uint32_t columns() const { return framing_.width * framing_.samples; }
  std::uint32_t rows() const { return framing_.height * framing_.samples; }

  /// Its size, in units of space.
  double pixel() const { return framing_.samples / scale_; }

  Vec3d on_grid(Vec3f position) const {
    const Vec3d p = (to_double(position) - centre_) * scale_;
    return {columns() / 2.0 + dot(axes_.right, p), rows() / 2.0 - dot(axes_.up, p),
            -dot(axes_.back, p)};
  }
  /// A direction by the view's axes: x to the right, y up, z to the viewer.
  Vec3f turned(Vec3f direction) const {
    const Vec3d d = to_double(direction);
    return to_float({dot(axes_.right, d), dot(axes_.up, d), dot(axes_.back, d)});
  }

 private:
  Framing framing_;
  ViewAxes axes_;
  Vec3d centre_;
  double scale_ = 1;  ///< samples a unit
};

}  // namespace meshhier::render
