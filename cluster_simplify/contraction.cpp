#include "cluster_simplify/contraction.h"

#include "base/error.h"
#include "base/vec.h"
#include "cluster_simplify/attribute_seams.h"
#include "cluster_simplify/cluster.h"
#include "cluster_simplify/edge_collapse.h"
#include "cluster_simplify/half_edge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

Contraction contract_places(const BuildTile& joined, std::uint32_t target,
                            const AttributeRules& rules, const ContractionOptions& options) {
  const auto seams = [&] { return attribute_seams(joined, rules, options.wedges); };
  switch (options.method) {
    case Method::cluster:
      return cluster(joined, target, rules, options.representative);
    case Method::edge_collapse:
      return edge_collapse(joined, target, rules, seams());
    case Method::half_edge:
      return half_edge(joined, target, options.cost, seams());
  }
  throw Error(ErrorCode::internal, "unknown contraction method");
}

/// Twice the area of the triangles around each own place.
std::vector<double> areas_around(const TileMesh& mesh) {
  std::vector<double> areas(mesh.own_count);
  const auto add = [&](const TileTriangle& t) {
    const auto place = [&](std::size_t k) { return to_double(mesh.vertices.positions[raw(t[k])]); };
    const double area = length(cross(place(1) - place(0), place(2) - place(0)));
    for (const TileVertex corner : t) {
      if (mesh.is_own(corner))
        areas[raw(corner)] += area;
    }
  };
  std::ranges::for_each(mesh.interior, add);
  std::ranges::for_each(mesh.border, add);
  return areas;
}

struct Vote {
  std::uint32_t representative;
  double label;
  double area;
  std::uint32_t place;
};

/// Gives each representative, of each label, the one that covers most of the surface of those that
/// it stands for: a triangle counts a third at each corner. Among equal areas that of most places,
/// then the least. Of places with copies the first wedge's counts. What is no number is no label.
/// O(n log n) a label.
void choose_majority_labels(const BuildTile& joined, const AttributeRules& rules,
                            Contraction& contraction) {
  const std::vector<double> areas = areas_around(joined.mesh);
  VertexArray& representatives = contraction.representatives;
  const auto channels = static_cast<std::size_t>(representatives.channels);
  for (const PlacedValue& value : rules.values().values()) {
    std::vector<Vote> votes;
    for (std::uint32_t place = 0; value.is_label && place < joined.mesh.own_count; ++place) {
      const double label = value.in(joined.mesh.vertices.attributes_of(place).data());
      if (!std::isnan(label))
        votes.push_back({contraction.parent_of[place], label, areas[place], place});
    }
    std::ranges::sort(votes, {},
                      [](const Vote& v) { return std::tuple(v.representative, v.label, v.place); });
    for (std::size_t i = 0; i < votes.size();) {
      const std::uint32_t representative = votes[i].representative;
      double best = votes[i].label, most_area = -1;
      std::size_t most_places = 0;
      while (i < votes.size() && votes[i].representative == representative) {
        const std::size_t first = i;
        double area = 0;
        for (; i < votes.size() && votes[i].representative == representative &&
               votes[i].label == votes[first].label;
             ++i)
          area += votes[i].area;
        if (std::tuple(area, i - first) > std::tuple(most_area, most_places)) {
          most_area = area;
          most_places = i - first;
          best = votes[first].label;
        }
      }
      put_value(value.type, best,
                representatives.attributes.data() + representative * channels + value.channel);
    }
  }
}

}  // namespace

Contraction contract(const BuildTile& joined, std::uint32_t target, const AttributeRules& rules,
                     const ContractionOptions& options) {
  Contraction contraction = contract_places(joined, target, rules, options);
  if (options.method != Method::half_edge && rules.values().has_labels())
    choose_majority_labels(joined, rules, contraction);
  return contraction;
}

}  // namespace meshhier::cluster_simplify
