#include "cluster_simplify/attribute_seams.h"

#include "cluster_simplify/attribute_metric.h"
#include "cluster_simplify/texture_charts.h"
#include "cluster_simplify/tile_wedges.h"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <iterator>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

/// A triangle's side, from the lower place to the higher.
struct Side {
  PlaceEdge places;
  std::array<std::uint32_t, 2> wedges;
  friend auto operator<=>(const Side&, const Side&) = default;
};

/// The sides between own places at which triangles may differ, ascending.
std::vector<Side> sides_of(const TileWedges& wedges) {
  std::vector<Side> sides;
  const auto may_differ = [&](std::uint32_t a, std::uint32_t b) {
    return wedges.is_own(a) && wedges.is_own(b) &&
           (wedges.count_at(wedges.place_of(a)) > 1 || wedges.count_at(wedges.place_of(b)) > 1);
  };
  for (const WedgeTriangle& t : wedges.triangles()) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<std::uint32_t, 2> ends{t[k], t[(k + 1) % 3]};
      if (!may_differ(ends[0], ends[1]))
        continue;
      if (wedges.place_of(ends[1]) < wedges.place_of(ends[0]))
        std::swap(ends[0], ends[1]);
      sides.push_back({{wedges.place_of(ends[0]), wedges.place_of(ends[1])}, ends});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// Tells wedges of one place apart.
class WedgeDifference {
 public:
  WedgeDifference(const TileWedges& wedges, const AttributeRules& rules,
                  const WedgeOptions& options)
      : wedges_(wedges),
        class_of_(texture_classes(wedges, rules.part(AttributeKind::texcoords))),
        metrics_(metrics_of(rules, options)),
        values_(rules.values()) {}

  bool operator()(std::uint32_t a, std::uint32_t b) const {
    const auto are_apart = [&](const AttributeMetric& metric) {
      return metric.are_apart(wedges_.attributes_of(a), wedges_.attributes_of(b));
    };
    return a != b && (class_of_[a] != class_of_[b] || std::ranges::any_of(metrics_, are_apart) ||
                      !values_.have_equal_labels(wedges_.attributes_of(a).data(),
                                                 wedges_.attributes_of(b).data()));
  }

 private:
  const TileWedges& wedges_;
  std::vector<std::uint32_t> class_of_;
  std::vector<AttributeMetric> metrics_;
  const ValueMixer& values_;
};

/// At which wedges of one place differ.
std::vector<PlaceEdge> wedge_seams(const TileWedges& wedges, const AttributeRules& rules,
                                   const WedgeOptions& options) {
  const WedgeDifference differ(wedges, rules, options);
  const std::vector<Side> sides = sides_of(wedges);
  std::vector<PlaceEdge> seams;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side& a = sides[i - 1];
    const Side& b = sides[i];
    if (a.places == b.places && (seams.empty() || seams.back() != a.places) &&
        (differ(a.wedges[0], b.wedges[0]) || differ(a.wedges[1], b.wedges[1])))
      seams.push_back(a.places);
  }
  return seams;
}

}  // namespace

std::vector<PlaceEdge> attribute_seams(const BuildTile& joined, const AttributeRules& rules,
                                       const WedgeOptions& options) {
  const bool has_labels = rules.values().has_labels();
  // Copies without attributes are equal.
  const bool may_differ = !joined.mesh.copies.empty() && rules.channels() > 0;
  if (!may_differ && !has_labels)
    return {};
  const TileWedges wedges(joined.mesh);
  std::vector<PlaceEdge> seams;
  if (may_differ)
    seams = wedge_seams(wedges, rules, options);
  if (!has_labels)
    return seams;
  const std::vector<PlaceEdge> borders = label_borders(wedges, rules);
  std::vector<PlaceEdge> all;
  std::ranges::set_union(seams, borders, std::back_inserter(all));
  return all;
}

std::vector<PlaceEdge> label_borders(const TileWedges& wedges, const AttributeRules& rules) {
  const ValueMixer& values = rules.values();
  const auto are_equal = [&](std::uint32_t a, std::uint32_t b) {
    return values.have_equal_labels(wedges.attributes_of(a).data(), wedges.attributes_of(b).data());
  };
  std::vector<PlaceEdge> borders;
  for (const WedgeTriangle& t : wedges.triangles()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], across = t[(k + 2) % 3];
      if (wedges.is_own(a) && wedges.is_own(b) && are_equal(a, b) && !are_equal(a, across))
        borders.push_back({std::min(wedges.place_of(a), wedges.place_of(b)),
                           std::max(wedges.place_of(a), wedges.place_of(b))});
    }
  }
  std::ranges::sort(borders);
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
  return borders;
}

}  // namespace meshhier::cluster_simplify
