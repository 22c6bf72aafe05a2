#include "cluster_simplify/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

class MotionMeter {
 public:
  explicit MotionMeter(const DeviationInput& input)
      : input_(input), is_drawn_(input.coarse.positions.size()) {
    for (const auto triangles : {input.coarse.interior, input.coarse.border}) {
      for (const Triangle& t : triangles) {
        for (const TileVertex v : t)
          is_drawn_[raw(v)] = 1;
      }
    }
  }

  Deviation measure() const {
    Deviation result;
    for (std::uint32_t v = 0; v < input_.fine.own_count; ++v) {
      const double distance = distance_to_image(v, input_.coarse_of[v]);
      result.squared_sum += input_.weights[v] * distance * distance;
      result.weight_sum += input_.weights[v];
    }
    for (const auto triangles : {input_.fine.interior, input_.fine.border}) {
      for (const Triangle& t : triangles)
        add(t, result);
    }
    result.bound *= 1 + 0x1p-40;  // rounding
    return result;
  }

 private:
  double distance_to_image(std::uint32_t fine, std::uint32_t coarse) const {
    return length(to_double(input_.fine.positions[fine]) -
                  to_double(input_.coarse.positions[coarse]));
  }

  void add(const Triangle& t, Deviation& result) const {
    const auto is_own = [&](TileVertex v) { return raw(v) < input_.fine.own_count; };
    if (std::none_of(t.begin(), t.end(), is_own))
      return;
    const double distance = distance_of(t);
    if (distance == kInfinite)
      ++result.collapsed_triangles;
    else
      result.bound = std::max(result.bound, distance);
  }

  /// Infinite if nothing of the triangle's image is drawn.
  double distance_of(const Triangle& t) const {
    std::array<std::uint32_t, 3> image;
    for (std::size_t k = 0; k < 3; ++k)
      image[k] = input_.coarse_of[raw(t[k])];
    const bool known = image[0] != kNone && image[1] != kNone && image[2] != kNone;
    const bool has_area = image[0] != image[1] && image[1] != image[2] && image[2] != image[0];
    if (known && has_area) {
      double farthest = 0;
      for (std::size_t k = 0; k < 3; ++k)
        farthest = std::max(farthest, distance_to_image(raw(t[k]), image[k]));
      return farthest;
    }
    double least = kInfinite;
    for (const std::uint32_t corner : image) {
      if (corner == kNone || !is_drawn_[corner])
        continue;
      double farthest = 0;
      for (const TileVertex v : t)
        farthest = std::max(farthest, distance_to_image(raw(v), corner));
      least = std::min(least, farthest);
    }
    return least;
  }

  const DeviationInput& input_;
  std::vector<char> is_drawn_;
};

}  // namespace

Deviation measure_motion(const DeviationInput& input) {
  return MotionMeter(input).measure();
}

}  // namespace meshhier::cluster_simplify
