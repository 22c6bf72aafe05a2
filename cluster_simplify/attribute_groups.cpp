#include "cluster_simplify/attribute_groups.h"

#include <optional>

namespace meshhier::cluster_simplify {
namespace {

using Part = std::span<const float>;

/// The mean of a group, of those at the new place if there are any.
class GroupMean {
 public:
  void add(Part part, const AttributePoint& summand, const ClusterWedge& wedge) {
    if (wedge.at_place && !at_place_)
      *this = {};
    else if (at_place_ && !wedge.at_place)
      return;
    at_place_ = wedge.at_place;
    if (part_.empty())
      part_ = part;
    are_equal_ = are_equal_ && std::ranges::equal(part_, part);
    weight_ += wedge.area;
    for (std::size_t k = 0; k < summand.size(); ++k)
      sum_[k] += wedge.area * summand[k];
  }

  std::array<float, 4> value(const AttributeMetric& metric) const {
    std::array<float, 4> value{};
    const std::optional<AttributePoint> mean = metric.mean(sum_, weight_);
    if (are_equal_ || !mean)
      std::ranges::copy(part_, value.begin());
    else
      std::ranges::transform(*mean, value.begin(), [](double x) { return static_cast<float>(x); });
    return value;
  }

 private:
  Part part_;  ///< of the first
  bool are_equal_ = true;
  bool at_place_ = false;
  AttributePoint sum_{};
  double weight_ = 0;
};

}  // namespace

AttributeGroups group_attributes(const AttributeMetric& metric, const TileWedges& wedges,
                                 std::span<const ClusterWedge> cluster,
                                 std::span<const std::uint32_t> order) {
  const auto part = [&](std::size_t i) {
    return metric.part(wedges.attributes_of(cluster[i].wedge));
  };
  Leaders<AttributeMetric> leaders(metric);
  for (const std::uint32_t i : order) {
    if (const std::optional<AttributePoint> point = metric.point(part(i)))
      leaders.offer(*point);
  }
  AttributeGroups groups;
  groups.group_of.resize(cluster.size());
  std::vector<GroupMean> means(leaders.size());
  for (std::size_t i = 0; i < cluster.size() && !means.empty(); ++i) {
    const std::optional<AttributePoint> point = metric.point(part(i));
    if (!point)
      continue;
    const auto [leader, distance] = leaders.nearest(*point);
    groups.group_of[i] = leader;
    if (distance <= metric.limit())
      means[leader].add(part(i), metric.summand(*point), cluster[i]);
  }
  for (const GroupMean& mean : means)
    groups.values.push_back(mean.value(metric));
  if (means.empty()) {  // nobody says anything: as the first says it
    groups.values.emplace_back();
    std::ranges::copy(part(order.front()), groups.values[0].begin());
  }
  return groups;
}

}  // namespace meshhier::cluster_simplify
