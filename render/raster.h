// Draws triangles into a grid of samples, each of which keeps what is nearest (a z-buffer).
#pragma once

#include "base/vec.h"
#include "render/camera.h"
#include "render/coverage.h"
#include "render/facet.h"
#include "render/run_depths.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::render {

struct DistinctPlaces;

/// The surface as it is seen at one place.
struct Sample {
  float depth = std::numeric_limits<float>::infinity();  ///< of Camera::on_grid()
  Vec3f normal;  ///< of length 1, by the view's axes, of the side that is seen; 0: nothing there
  Vec3f colour;  ///< linear light

  bool covered() const { return depth < std::numeric_limits<float>::infinity(); }
};

/// Rows of a picture's pixels, from the top.
struct PixelRows {
  std::uint32_t first = 0, count = 0;
};

/// A pure function of the camera and of the facets in their order; 29 bytes a sample. Many facets
/// behind others, as soup has them, cost little each. Not thread-safe.
class Raster {
 public:
  explicit Raster(const Camera& camera);
  /// Holds these rows of the picture only, the same as they are in the whole. Requires that it has
  /// them.
  Raster(const Camera& camera, PixelRows rows);

  /// The nearest facet is seen, of equally near ones the first. Depths, normals and colours are
  /// interpolated; normals are those of the side that is seen. Nothing is seen of a facet that is
  /// not finite. What reaches beyond the grid by more than 2^20 samples is moved there.
  void draw(const Facet& facet) { draw(facet, Skin{}); }
  /// Shows the texture, filtered for the area of a sample on it. It must live as long as the call.
  /// Where it is transparent, what is behind is seen; of what is to blend, in a share of a pixel's
  /// samples.
  void draw(const Facet& facet, const Skin& skin);
  void draw(std::span<const Facet> facets);
  /// The same, quicker for small facets. `distinct`: distinct_places() of them.
  void draw(std::span<const Facet> facets, const DistinctPlaces& distinct);

  const Framing& framing() const { return camera_.framing(); }
  std::uint32_t columns() const { return camera_.columns(); }
  /// Rows of samples: those of pixel_rows().
  std::uint32_t rows() const { return rows_.count * framing().samples; }
  PixelRows pixel_rows() const { return rows_; }
  /// Row by row, from the top left.
  std::span<const Sample> samples() const& { return samples_; }
  void samples() const&& = delete;  ///< it would outlive its array

 private:
  /// A place on the grid, counted from the first row that is here.
  GridPoint in_rows(Vec3d place) const {
    GridPoint point = snapped(place);
    point.y -= kSteps * rows_.first * framing().samples;
    return point;
  }
  /// `places`: of its corners on the grid; `corners`: the same as in_rows(), `box` around them, not
  /// empty.
  void draw(const Facet& facet, const Skin& skin, const std::array<Vec3d, 3>& places,
            const std::array<GridPoint, 3>& corners, const SampleBox& box);

  Camera camera_;
  PixelRows rows_;
  std::vector<Sample> samples_;
  RunDepths run_depths_;
};

}  // namespace meshhier::render
