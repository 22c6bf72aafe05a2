// A picture with perspective, drawn by a camera that has none.
//
// Problem. The raster and its camera know parallel lines only: plans, portraits. What the page
// shows has perspective.
//
// Idea. A projective map bends space so that rays through the eye become parallel; it takes planes
// to planes, so triangles stay triangles, and what was behind something still is:
//
//        eye                                  |  |  |  |
//        / \            p' = p D / w          |  |  |  |    w: how far ahead of the eye p is
//       / # \           depth' = D - D² / w   |  # |  |     D: how far the target is, where all
//      /  #  \                                |  ##|  |        stays as large as it is
//     /-------\                               |--|--|--|
//
// Invariant. Edges and what hides what are exact. Colours are mixed along straight lines in the
// picture, so long edges that lead away are halved until that is not seen; whether an edge is
// halved depends on it alone, so neighbours fit.
//
// Cost. O(facets); a facet near the eye becomes some dozens.
#pragma once

#include "base/bounds.h"
#include "base/half_space.h"
#include "base/vec.h"
#include "render/camera.h"
#include "render/cut_facets.h"
#include "render/scene.h"

#include <array>
#include <optional>
#include <span>

namespace meshhier::render {

/// From where one looks, and at what; in a world with y up.
struct Pose {
  Vec3d position, target;
};

/// The angle from the lower edge of a picture to the upper one: a quarter of a turn by two.
inline constexpr double kViewAngle = 0.7853981633974483;

class Perspective {
 public:
  /// Requires that the two points of the pose differ.
  Perspective(const Pose& pose, const Framing& framing);

  /// Draws what project() has moved.
  const Camera& camera() const { return camera_; }
  const ViewAxes& axes() const { return axes_; }
  Vec3d eye() const { return eye_; }
  /// Moves the facets that may be seen; the others go.
  void project(SceneTile& tile) const;

  /// Whether anything of a box may be seen.
  bool sees(const BoundsD& box) const;
  /// The size of a pixel where a box is nearest, in units of space.
  double pixel_in(const BoundsD& box) const;
  /// Holds all that project() makes of what is in the box.
  Bounds projected(const BoundsD& box) const;

 private:
  /// To the right, up, and ahead of the eye.
  Vec3d seen(Vec3d place) const;
  Vec3d projected(Vec3d seen) const;
  bool is_long(const CutCorner& a, const CutCorner& b) const;
  void add(std::size_t facet, std::array<CutCorner, 3> corners, int depth, CutFacets& to) const;

  Vec3d eye_;
  double distance_, nearest_, pixel_;  ///< `pixel_`: its size at the target
  ViewAxes axes_;
  Camera camera_;
  std::array<HalfSpace, 5> frustum_;  ///< by seen(), wider than the picture
};

/// The camera of parallel rays whose picture is as high at the target as that in perspective.
/// Requires that the two points of the pose differ.
Camera parallel_camera(const Pose& pose, const Framing& framing);
ViewAxes parallel_axes(const Pose& pose);

enum class Rays { meet_in_the_eye, parallel };

/// The pose from which all points fill a picture of that aspect, with a margin. `direction`: to the
/// viewer; none: a little aside and above. `box`: around them, not empty.
Pose frame_whole(std::span<const Vec3d> points, const BoundsD& box, std::optional<Vec3d> direction,
                 double aspect, Rays rays = Rays::meet_in_the_eye);

/// The farthest points in directions that are spread evenly: a shape's outline, from wherever it is
/// seen. O(256 points).
std::vector<Vec3d> silhouette_of(std::span<const Vec3d> points);

}  // namespace meshhier::render
