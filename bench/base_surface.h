// Smooth closed base shapes made of square patches.
#pragma once

#include "base/vec.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace meshhier::bench {

enum class BaseShape {
  sphere,  ///< genus 0, exactly round
  torus,   ///< genus 1
  genus5,  ///< a plate with five holes
  shells   ///< two concentric spheres; the inner one, of 0.6 times the radius, faces inwards
};

/// Returns the shape of that name; nothing if there is none.
std::optional<BaseShape> shape_named(std::string_view name);
std::string_view name_of(BaseShape shape);

/// A closed, manifold, consistently oriented mesh of quads (seen from outside: counter-clockwise).
struct QuadMesh {
  std::vector<Vec3d> vertices;
  std::vector<std::array<std::uint32_t, 4>> faces;
};

/// Side s of a face runs from its corner s to its corner (s + 1) % 4.
struct PatchSide {
  std::uint32_t face = 0;
  std::uint32_t side = 0;
};

/// Returns for every side of every face the same edge as a side of the other face. Requires a
/// closed mesh.
std::vector<std::array<PatchSide, 4>> opposite_sides(const QuadMesh& mesh);

/// Does one step of Catmull & Clark, Recursively generated B-spline surfaces, 1978. Face f becomes
/// the faces 4f .. 4f + 3.
QuadMesh subdivided(const QuadMesh& mesh);

struct SurfacePoint {
  Vec3d position;
  Vec3d normal;  ///< unit length, outwards
};

/// One bicubic patch a quad, after Loop & Schaefer, Approximating Catmull-Clark Subdivision
/// Surfaces with Bicubic Patches, 2008. Fits the cube [-1, 1]^3. Immutable, thread-safe.
class BaseSurface {
 public:
  explicit BaseSurface(BaseShape shape);

  const QuadMesh& patches() const { return cage_; }

  /// The point (u, v) in [0, 1]^2 of patch `face`; corners 0, 1, 2, 3 are at (0, 0), (1, 0), (1,
  /// 1), (0, 1). Neighbouring patches agree along their common side up to rounding.
  SurfacePoint at(std::uint32_t face, double u, double v) const;

  /// Returns the mean length of a patch's side, roughly.
  double patch_size() const { return patch_size_; }

  /// Returns half of the thickness between opposite parts of the surface: a relief below it does
  /// not pierce.
  double thickness() const { return thickness_; }

 private:
  using ControlNet = std::array<Vec3d, 16>;  ///< row by row, v upwards

  void fit_control_nets();

  QuadMesh cage_;
  std::vector<double> radius_;  ///< a patch; 0: not on a sphere. Negative: faces inwards
  std::vector<ControlNet> nets_;
  double patch_size_ = 0;
  double thickness_ = 0;
};

}  // namespace meshhier::bench
