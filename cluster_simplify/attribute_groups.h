// Which wedges that come together show one normal, or one colour.
#pragma once

#include "cluster_simplify/attribute_metric.h"
#include "cluster_simplify/tile_wedges.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// A wedge of a cluster.
struct ClusterWedge {
  std::uint32_t wedge = 0;
  double area = 0;        ///< of the triangles that have it, twice
  bool survives = false;  ///< one of these does
  bool at_place = false;  ///< it lies where its cluster comes to lie
};

/// Groups by the leader algorithm (Hartigan 1975): what is apart from all leaders becomes one.
/// `Kind`: distance(point, point) and limit().
template <class Kind>
class Leaders {
 public:
  /// More are not looked through for every wedge.
  static constexpr std::size_t kMost = 32;

  explicit Leaders(const Kind& kind) : kind_(kind) {}

  void offer(const AttributePoint& point) {
    if (points_.size() < kMost && !(nearest(point).distance <= kind_.limit()))
      points_.push_back(point);
  }

  struct Nearest {
    std::uint32_t leader = 0;
    double distance = std::numeric_limits<double>::infinity();
  };
  /// The first of equally near ones.
  Nearest nearest(const AttributePoint& point) const {
    Nearest best;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const double distance = kind_.distance(points_[i], point);
      if (distance < best.distance)
        best = {i, distance};
    }
    return best;
  }

  std::size_t size() const { return points_.size(); }

 private:
  const Kind& kind_;
  std::vector<AttributePoint> points_;
};

struct AttributeGroups {
  std::vector<std::uint32_t> group_of;       ///< of each wedge of the cluster
  std::vector<std::array<float, 4>> values;  ///< of each group; at least one
};

/// Groups the wedges of a cluster by one of their attributes. Surviving wedges are offered by
/// `order`: the first becomes the first leader. A group's value is the mean of those that are near
/// its leader, by the areas that show them: history counts places, and does not know one wedge of a
/// place from another. If some of them lie at the new place it is their mean; if they are equal
/// they keep their numbers, so that an original vertex that stays keeps its own. Wedges that say
/// nothing go to the first group. O(n), with Leaders::kMost.
AttributeGroups group_attributes(const AttributeMetric& metric, const TileWedges& wedges,
                                 std::span<const ClusterWedge> cluster,
                                 std::span<const std::uint32_t> order);

}  // namespace meshhier::cluster_simplify
