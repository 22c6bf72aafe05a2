#include "cluster_simplify/motion.h"

#include "base/widest_corner.h"
#include "cluster_simplify/area_mean.h"
#include "cluster_simplify/nearest.h"
#include "hierarchy/triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

constexpr double kSumRounding = 0x1p-22;  // of floats that hold what was summed up in double

/// Triangles by their edges: with each vertex those of higher number that it has an edge to.
class EdgeSet {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  EdgeSet(std::span<const Triangle<std::uint32_t>> triangles, std::size_t vertex_count)
      : begins_(vertex_count + 1), at_(vertex_count, kNone) {
    for_each_edge(triangles,
                  [&](std::uint32_t low, std::uint32_t, std::uint32_t) { ++begins_[low + 1]; });
    for (std::size_t v = 0; v < vertex_count; ++v)
      begins_[v + 1] += begins_[v];
    ends_.resize(begins_[vertex_count]);
    std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
    for_each_edge(triangles, [&](std::uint32_t low, std::uint32_t high, std::uint32_t t) {
      ends_[next[low]++] = {high, t};
      at_[low] = std::min(at_[low], t);
      at_[high] = std::min(at_[high], t);
    });
    for (std::size_t v = 0; v < vertex_count; ++v)
      std::sort(ends_.begin() + begins_[v], ends_.begin() + begins_[v + 1]);
  }

  /// The first triangle at the edge, or at the vertex if they are one; kNone if there is none.
  std::uint32_t triangle_at(std::uint32_t a, std::uint32_t b) const {
    if (a == b)
      return at_[a];
    const auto [low, high] = std::minmax(a, b);
    const auto end = ends_.begin() + begins_[low + 1];
    const auto found = std::lower_bound(ends_.begin() + begins_[low], end, End{high, 0});
    return found != end && found->vertex == high ? found->triangle : kNone;
  }

 private:
  struct End {
    std::uint32_t vertex, triangle;
    friend constexpr auto operator<=>(const End&, const End&) = default;
  };

  template <class Visit>
  static void for_each_edge(std::span<const Triangle<std::uint32_t>> triangles,
                            const Visit& visit) {
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(triangles[i][k], triangles[i][(k + 1) % 3]);
        visit(low, high, i);
      }
    }
  }

  std::vector<std::uint32_t> begins_;
  std::vector<End> ends_;
  std::vector<std::uint32_t> at_;  ///< the first triangle at a vertex
};

// Much of the motion is within the surface: on scans its mean is 10 to 100 times the measured
// distance. Over area half of it counts, so that theirs stays what their vertices say.
constexpr double kAcross = 0.5;

class Motion {
 public:
  Motion(const BuildTile& joined, const Contraction& contraction)
      : mesh_(joined.mesh),
        contraction_(contraction),
        moved_(joined.mesh.vertices.size()),
        weights_(joined.mesh.own_count),
        places_(contraction.representatives.positions),
        drawn_(contraction.representatives.size() + joined.mesh.ghosts.size()) {
    places_.insert(places_.end(), mesh_.vertices.positions.begin() + mesh_.own_count,
                   mesh_.vertices.positions.end());
    deviation_.around.resize(contraction.representatives.size());
    for (std::uint32_t v = 0; v < mesh_.own_count; ++v) {
      moved_[v] = length(to_double(mesh_.vertices.positions[v]) -
                         to_double(places_[contraction.parent_of[v]]));
    }
    weigh(mesh_.interior, joined.history.weights);
    weigh(mesh_.border, joined.history.weights);
    drawn_mean_ = DrawnMean(over_vertices());
    for (const TileTriangle& t : mesh_.interior)
      deviation_.interior = std::max(deviation_.interior, add(t));
    for (const TileTriangle& t : mesh_.border)
      add(t);
    measure_lost();
    deviation_.mean_square = mean_square();
  }

  Deviation take() { return std::move(deviation_); }

 private:
  /// Representatives, then ghosts.
  std::uint32_t image(TileVertex v) const {
    return mesh_.is_own(v) ? contraction_.parent_of[raw(v)]
                           : raw(v) - mesh_.own_count +
                                 static_cast<std::uint32_t>(contraction_.representatives.size());
  }

  float deviation_of(const TileTriangle& t) const {
    const double farthest = std::max({moved_[raw(t[0])], moved_[raw(t[1])], moved_[raw(t[2])]});
    return static_cast<float>(farthest * (1 + kSumRounding));
  }

  void show(const Triangle<std::uint32_t>& images, float deviation) {
    shown_.push_back(images);
    drawn_mean_.add(double{deviation}, [&] {
      return std::array{places_[images[0]], places_[images[1]], places_[images[2]]};
    });
  }

  void raise(std::uint32_t image, float deviation) {
    if (image < deviation_.around.size())
      deviation_.around[image] = std::max(deviation_.around[image], deviation);
  }

  float add(const TileTriangle& t) {
    const float deviation = deviation_of(t);
    const Triangle<std::uint32_t> images{image(t[0]), image(t[1]), image(t[2])};
    const bool is_drawn =
        images[0] != images[1] && images[1] != images[2] && images[2] != images[0];
    if (is_drawn)
      show(images, deviation);
    else
      folded_.push_back(t);
    for (const std::uint32_t v : images) {
      raise(v, deviation);
      drawn_[v] = drawn_[v] || is_drawn;
    }
    return deviation;
  }

  void weigh(std::span<const TileTriangle> triangles, std::span<const float> weights) {
    for (const TileTriangle& t : triangles) {
      for (const TileVertex v : t) {
        if (mesh_.is_own(v))
          weights_[raw(v)] = weights[raw(v)];
      }
    }
  }

  /// A triangle whose image has no area lies in a corner or edge of one that is drawn, and brings
  /// its deviation along. False if there is none.
  bool lands(const EdgeSet& edges, const TileTriangle& t) {
    const std::uint32_t a = image(t[0]);
    const std::uint32_t b = image(t[1]) != a ? image(t[1]) : image(t[2]);
    const std::uint32_t onto = edges.triangle_at(a, b);
    if (onto == EdgeSet::kNone)
      return false;
    const float deviation = deviation_of(t);
    for (const std::uint32_t v : shown_[onto])
      raise(v, deviation);
    return true;
  }

  /// Takes note of a triangle that is drawn no more, and how far it is from what is; returns that.
  double lose(const TileTriangle& t, double away) {
    const auto at = [&](TileVertex v) { return mesh_.vertices.positions[raw(v)]; };
    lost_areas_.push_back({doubled_area(at(t[0]), at(t[1]), at(t[2])), away});
    return away;
  }

  double farthest_corner(const TileTriangle& t, std::uint32_t from) const {
    double most = 0;
    for (const TileVertex v : t) {
      most = std::max(
          most, length(to_double(mesh_.vertices.positions[raw(v)]) - to_double(places_[from])));
    }
    return most;
  }

  std::vector<std::uint32_t> drawn_images() const {
    std::vector<std::uint32_t> drawn;
    for (std::uint32_t v = 0; v < drawn_.size(); ++v) {
      if (drawn_[v])
        drawn.push_back(v);
    }
    return drawn;
  }

  /// Own vertices of triangles, as numbers, whose image is not drawn; some more than once.
  std::vector<std::uint32_t> lost_vertices() const {
    std::vector<std::uint32_t> lost;
    for (const TileTriangle& t : folded_) {
      for (const TileVertex v : t) {
        if (mesh_.is_own(v) && !drawn_[image(v)])
          lost.push_back(raw(v));
      }
    }
    return lost;
  }

  /// Triangles whose image neither lies in what is drawn nor has a corner that is. Of those that
  /// have one, `farthest` is told how far that is.
  std::vector<TileTriangle> lost_triangles(double& farthest) {
    const EdgeSet edges(shown_, drawn_.size());
    std::vector<TileTriangle> lost;
    for (const TileTriangle& t : folded_) {
      if (lands(edges, t))
        continue;
      double least = std::numeric_limits<double>::infinity();
      for (const TileVertex v : t) {
        if (drawn_[image(v)])
          least = std::min(least, farthest_corner(t, image(v)));
      }
      if (std::isfinite(least))
        farthest = std::max(farthest, lose(t, least));
      else
        lost.push_back(t);
    }
    return lost;
  }

  /// Measures triangles whose image is drawn nowhere: to a corner of it that is drawn, or else to
  /// the drawn vertex nearest to it; infinite if there is none. Vertices whose image is not drawn
  /// have moved to the drawn one nearest to it.
  void measure_lost() {
    double farthest = 0;
    const std::vector<TileTriangle> triangles = lost_triangles(farthest);
    const std::vector<std::uint32_t> vertices = lost_vertices();
    if (!triangles.empty() || !vertices.empty()) {
      const NearestDrawn nearest(places_, drawn_images());
      for (const TileTriangle& t : triangles) {
        const double away = nearest.from(
            places_[image(t[0])], [&](std::uint32_t drawn) { return farthest_corner(t, drawn); });
        farthest = std::max(farthest, lose(t, away));
      }
      for (const std::uint32_t v : vertices) {
        moved_[v] = nearest.from(places_[contraction_.parent_of[v]], [&](std::uint32_t drawn) {
          return length(to_double(mesh_.vertices.positions[v]) - to_double(places_[drawn]));
        });
      }
    }
    deviation_.lost = static_cast<float>(farthest * (1 + kSumRounding));
  }

  /// The mean square of the distances from vertices to their images.
  double over_vertices() const {
    double sum = 0;
    double whole = 0;
    for (std::uint32_t v = 0; v < mesh_.own_count; ++v) {
      if (weights_[v] > 0) {
        sum += double{weights_[v]} * moved_[v] * moved_[v];
        whole += double{weights_[v]};
      }
    }
    return whole > 0 ? sum / whole : 0;
  }

  /// As large as the vertices, the surface as it was, or as it is drawn have it.
  double mean_square() const {
    const double vertices = over_vertices();
    const double joined = mean_over_joined(mesh_, moved_, lost_areas_, vertices);
    return std::max({vertices, kAcross * kAcross * joined, drawn_mean_.value()});
  }

  const TileMesh& mesh_;
  const Contraction& contraction_;
  std::vector<double> moved_;   ///< ghosts: 0
  std::vector<float> weights_;  ///< of own vertices; 0 of those without triangles
  std::vector<Vec3f> places_;   ///< of images
  std::vector<char> drawn_;     ///< image: has a triangle
  std::vector<Triangle<std::uint32_t>> shown_;
  std::vector<TileTriangle> folded_;  ///< whose images have no area
  std::vector<LostArea> lost_areas_;
  DrawnMean drawn_mean_{0};
  Deviation deviation_;
};

}  // namespace

Deviation motion_of(const BuildTile& joined, const Contraction& contraction) {
  return Motion(joined, contraction).take();
}

}  // namespace meshhier::cluster_simplify
