// kmeans_parts(): clusters of points around their means.
#include "bench/noise.h"
#include "bench/partitioners.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace meshhier::bench {
namespace {

/// Names the random sequence of the seeding; any would do.
constexpr std::uint64_t kSeed = 1;

/// What a computed distance may be off by, relatively: some units in the last place.
constexpr double kSlack = 1e-12;

double squared_distance(Vec3d a, Vec3d b) {
  const Vec3d d = a - b;
  return dot(d, d);
}

class KMeans {
 public:
  explicit KMeans(std::span<const Vec3f> points) : points_(points), part_of_(points.size()) {}

  /// Each further mean is a point drawn with the probability of its squared distance to those
  /// there are. Leaves every point with the nearest of them, the first of equally near ones.
  void seed(std::uint32_t count) {
    std::vector<double> squared(points_.size(), std::numeric_limits<double>::infinity());
    auto drawn =
        static_cast<std::size_t>(uniform_at(kSeed, 0) * static_cast<double>(points_.size()));
    while (means_.size() < count) {
      add_mean(to_double(points_[drawn]), squared);
      double total = 0;
      for (const double s : squared)
        total += s;
      if (!(total > 0))
        return;  // every point is a mean already
      double left = uniform_at(kSeed, means_.size()) * total;
      for (drawn = 0; drawn + 1 < squared.size() && left >= squared[drawn]; ++drawn)
        left -= squared[drawn];
    }
  }

  /// One iteration: means of the parts, then the nearest mean of every point. Returns whether a
  /// point changed its part.
  bool iterate() {
    move_means();
    order_neighbours();
    bool changed = false;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const std::uint32_t nearest = nearest_mean(to_double(points_[i]), part_of_[i]);
      changed = changed || nearest != part_of_[i];
      part_of_[i] = nearest;
    }
    return changed;
  }

  Parts take() {
    return without_empty_parts(std::move(part_of_), static_cast<std::uint32_t>(means_.size()));
  }

 private:
  struct Neighbour {
    double distance = 0;
    std::uint32_t mean = 0;
    friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
  };

  void add_mean(Vec3d position, std::vector<double>& squared) {
    const auto mean = static_cast<std::uint32_t>(means_.size());
    means_.push_back(position);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double s = squared_distance(to_double(points_[i]), position);
      if (s < squared[i]) {
        squared[i] = s;
        part_of_[i] = mean;
      }
    }
  }

  /// A mean without points stays where it is.
  void move_means() {
    std::vector<Vec3d> sums(means_.size());
    std::vector<std::uint64_t> sizes(means_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      sums[part_of_[i]] = sums[part_of_[i]] + to_double(points_[i]);
      ++sizes[part_of_[i]];
    }
    for (std::size_t m = 0; m < means_.size(); ++m) {
      if (sizes[m] > 0)
        means_[m] = sums[m] * (1.0 / static_cast<double>(sizes[m]));
    }
  }

  void order_neighbours() {
    neighbours_.resize(means_.size());
    for (std::size_t m = 0; m < means_.size(); ++m) {
      neighbours_[m].clear();
      for (std::uint32_t n = 0; n < means_.size(); ++n) {
        if (n != m)
          neighbours_[m].push_back({std::sqrt(squared_distance(means_[m], means_[n])), n});
      }
      std::sort(neighbours_[m].begin(), neighbours_[m].end());
    }
  }

  /// The first of the nearest means. A mean farther from `guess` than twice the point's distance to
  /// `guess` is farther from the point than `guess` is.
  std::uint32_t nearest_mean(Vec3d point, std::uint32_t guess) const {
    double best = squared_distance(point, means_[guess]);
    std::uint32_t nearest = guess;
    const double reach = 2 * std::sqrt(best) * (1 + kSlack);
    for (const Neighbour& n : neighbours_[guess]) {
      if (n.distance > reach)
        break;
      const double s = squared_distance(point, means_[n.mean]);
      if (s < best || (s == best && n.mean < nearest)) {
        best = s;
        nearest = n.mean;
      }
    }
    return nearest;
  }

  std::span<const Vec3f> points_;
  std::vector<std::uint32_t> part_of_;
  std::vector<Vec3d> means_;
  std::vector<std::vector<Neighbour>> neighbours_;  ///< of a mean, nearest first
};

}  // namespace

KMeansParts kmeans_parts(std::span<const Vec3f> points, std::uint32_t count, int most_iterations) {
  check_part_count(points.size(), count);
  KMeans kmeans(points);
  kmeans.seed(count);
  KMeansParts result;
  while (!result.converged && result.iterations < most_iterations) {
    result.converged = !kmeans.iterate();
    ++result.iterations;
  }
  result.parts = kmeans.take();
  return result;
}

}  // namespace meshhier::bench
