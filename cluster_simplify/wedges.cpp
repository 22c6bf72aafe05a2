#include "cluster_simplify/wedges.h"

#include "base/vec.h"
#include "cluster_simplify/attribute_groups.h"
#include "cluster_simplify/attribute_metric.h"
#include "cluster_simplify/texture_charts.h"
#include "cluster_simplify/tile_wedges.h"
#include "cluster_simplify/wedge_clusters.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

// New wedges that an old one without a triangle is compared with: no more, where a place has very
// many.
constexpr std::size_t kMostCompared = 64;

/// How triangles use wedges.
struct WedgeUse {
  std::vector<double> areas;   ///< of the triangles around each, twice
  std::vector<char> survives;  ///< whether one of them does
};

double doubled_area(const TileWedges& wedges, const WedgeTriangle& t) {
  const Vec3d a = to_double(wedges.position_of(t[0]));
  const Vec3d b = to_double(wedges.position_of(t[1]));
  const Vec3d c = to_double(wedges.position_of(t[2]));
  return length(cross(b - a, c - a));
}

WedgeUse use_of(const TileWedges& wedges, const WedgeClusters& clusters) {
  WedgeUse use{std::vector<double>(wedges.count()), std::vector<char>(wedges.count())};
  for (const WedgeTriangle& t : wedges.triangles()) {
    const double area = doubled_area(wedges, t);
    const bool survives = clusters.survives(t);
    for (const std::uint32_t wedge : t) {
      use.areas[wedge] += area;
      use.survives[wedge] |= static_cast<char>(survives);
    }
  }
  return use;
}

/// Marks the clusters whose wedges are looked at: not those with one wedge a place, in one chart,
/// of one object; the method knew all there is.
std::vector<char> wanted_clusters(const TileWedges& wedges, const WedgeClusters& clusters,
                                  const WedgeUse& use, std::span<const std::uint32_t> charts,
                                  const ValueMixer& values) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<char> wanted(clusters.count());
  std::vector<std::uint32_t> shown(clusters.count(), kNone);  // a chart that survives
  std::vector<std::uint32_t> firsts(clusters.count(), kNone);
  const auto object_at = [&](std::uint32_t place) {
    return values.object_of(wedges.attributes_of(place).data());
  };
  for (std::uint32_t place = 0; place < wedges.own_place_count(); ++place) {
    const std::uint32_t cluster = clusters.of(place);
    if (firsts[cluster] == kNone)
      firsts[cluster] = place;
    if (wedges.count_at(place) > 1 || object_at(place) != object_at(firsts[cluster]))
      wanted[cluster] = 1;
    if (use.survives[place] == 0)
      continue;
    if (shown[cluster] != kNone && shown[cluster] != charts[place])
      wanted[cluster] = 1;
    shown[cluster] = charts[place];
  }
  return wanted;
}

/// A corner shows one of each.
struct Combination {
  std::uint32_t chart;
  std::array<std::uint32_t, kMeasuredKinds> groups;  ///< of each metric
  std::uint32_t labels;
  friend auto operator<=>(const Combination&, const Combination&) = default;
};

/// The combination of a cluster's wedge.
struct Shown {
  Combination what;
  std::uint32_t member;  ///< which wedge of the cluster
  friend auto operator<=>(const Shown&, const Shown&) = default;
};

/// The first of each combination; `shown` ascends.
std::vector<Shown> firsts_of(std::span<const Shown> shown) {
  std::vector<Shown> firsts;
  std::unique_copy(shown.begin(), shown.end(), std::back_inserter(firsts),
                   [](const Shown& a, const Shown& b) { return a.what == b.what; });
  return firsts;
}

bool has_lesser_bits(std::span<const float> a, std::span<const float> b) {
  const auto x = std::as_bytes(a);
  const auto y = std::as_bytes(b);
  return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
}

/// For each combination the first one with equal attributes, bit for bit, `first` the one with the
/// least member.
std::vector<std::uint32_t> equal_firsts(std::span<const Shown> combinations,
                                        const VertexArray& attributes) {
  std::vector<std::uint32_t> order(combinations.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto is_less = [&](std::uint32_t a, std::uint32_t b) {
    return has_lesser_bits(attributes.attributes_of(a), attributes.attributes_of(b));
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return is_less(a, b) || (!is_less(b, a) && combinations[a].member < combinations[b].member);
  });
  std::vector<std::uint32_t> firsts(order.size());
  std::uint32_t first = order[0];
  for (const std::uint32_t i : order) {
    if (is_less(first, i))
      first = i;
    firsts[i] = first;
  }
  return firsts;
}

/// Combinations in the order of their members, those of equal attributes as one.
struct Numbering {
  std::vector<std::uint32_t> number_of;     ///< of each combination
  std::vector<std::uint32_t> combinations;  ///< of each number, the first
};

Numbering number(std::span<const Shown> combinations, const VertexArray& attributes) {
  const std::vector<std::uint32_t> firsts = equal_firsts(combinations, attributes);
  Numbering numbering{std::vector<std::uint32_t>(combinations.size()), {}};
  for (std::uint32_t i = 0; i < combinations.size(); ++i) {
    if (firsts[i] == i)
      numbering.combinations.push_back(i);
  }
  std::ranges::sort(numbering.combinations, {},
                    [&](std::uint32_t i) { return combinations[i].member; });
  for (std::uint32_t k = 0; k < numbering.combinations.size(); ++k)
    numbering.number_of[numbering.combinations[k]] = k;
  for (std::uint32_t i = 0; i < combinations.size(); ++i)
    numbering.number_of[i] = numbering.number_of[firsts[i]];
  return numbering;
}

/// The wedges of one new place.
struct NewWedges {
  VertexArray vertices;                  ///< empty if no triangle shows any
  std::vector<std::uint32_t> number_of;  ///< which of them stands for each wedge of the cluster
};

class WedgeContraction {
 public:
  WedgeContraction(const BuildTile& joined, const Contraction& contraction,
                   const AttributeRules& rules, const WedgeOptions& options)
      : representatives_(contraction.representatives),
        rules_(rules),
        texcoords_(rules.part(AttributeKind::texcoords)),
        metrics_(metrics_of(rules, options)),
        wedges_(joined.mesh),
        clusters_(wedges_, contraction),
        use_(use_of(wedges_, clusters_)),
        charts_(texture_charts(wedges_, clusters_, texcoords_)),
        wanted_(wanted_clusters(wedges_, clusters_, use_, charts_, rules.values())),
        coordinates_(chart_coordinates(wedges_, clusters_, charts_, representatives_.positions,
                                       wanted_, texcoords_)) {}

  ContractedWedges run() const {
    ContractedWedges result;
    result.attributes = representatives_.attributes;
    result.copies.vertices.channels = representatives_.channels;
    std::vector<std::uint32_t> number_of(wedges_.count());
    for (std::uint32_t c = 0; c < clusters_.count(); ++c) {
      if (wanted_[c] == 0)
        continue;
      const std::vector<ClusterWedge> cluster = wedges_of(c);
      const NewWedges made = new_wedges(cluster, c);
      put(made.vertices, c, result);
      for (std::size_t i = 0; i < made.number_of.size(); ++i)
        number_of[cluster[i].wedge] = made.number_of[i];
    }
    result.map = map_of(number_of);
    return result;
  }

 private:
  /// By place, then number.
  std::vector<ClusterWedge> wedges_of(std::uint32_t c) const {
    std::vector<ClusterWedge> cluster;
    for (const std::uint32_t place : clusters_.places(c)) {
      const bool at_place = wedges_.position_of(place) == representatives_.positions[c];
      for (std::uint32_t k = 0; k < wedges_.count_at(place); ++k) {
        const std::uint32_t wedge = wedges_.at(place, k);
        cluster.push_back({wedge, use_.areas[wedge], use_.survives[wedge] != 0, at_place});
      }
    }
    return cluster;
  }

  /// Those that survive, by descending area: what shows most leads its group.
  static std::vector<std::uint32_t> largest_first(std::span<const ClusterWedge> cluster) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < cluster.size(); ++i) {
      if (cluster[i].survives)
        order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return cluster[a].area > cluster[b].area;
    });
    return order;
  }

  const float* channels_of_wedge(const ClusterWedge& wedge) const {
    return wedges_.attributes_of(wedge.wedge).data();
  }

  /// For each wedge of the cluster a number of what labels it has: `order` are those that count.
  /// All of too many have the number of the first of their object.
  std::vector<std::uint32_t> label_groups(std::span<const ClusterWedge> cluster,
                                          std::span<const std::uint32_t> order) const {
    std::vector<std::uint32_t> group_of(cluster.size());
    std::map<double, std::vector<std::uint32_t>> firsts_of_objects;
    std::uint32_t groups = 0;
    for (const std::uint32_t i : order) {
      const float* channels = channels_of_wedge(cluster[i]);
      std::vector<std::uint32_t>& firsts = firsts_of_objects[rules_.values().object_of(channels)];
      const auto known = std::ranges::find_if(firsts, [&](std::uint32_t first) {
        return rules_.values().have_equal_labels(channels_of_wedge(cluster[first]), channels);
      });
      if (known != firsts.end()) {
        group_of[i] = group_of[*known];
      } else if (firsts.size() < Leaders<AttributeMetric>::kMost) {
        group_of[i] = groups++;
        firsts.push_back(i);
      } else {
        group_of[i] = group_of[firsts[0]];
      }
    }
    return group_of;
  }

  NewWedges new_wedges(std::span<const ClusterWedge> cluster, std::uint32_t c) const {
    const std::vector<std::uint32_t> order = largest_first(cluster);
    if (order.empty())
      return {};
    std::vector<AttributeGroups> groups;
    for (const AttributeMetric& metric : metrics_)
      groups.push_back(group_attributes(metric, wedges_, cluster, order));
    const std::vector<std::uint32_t> labels = label_groups(cluster, order);
    std::vector<Shown> shown;
    for (const std::uint32_t i : order) {
      Combination what{charts_[cluster[i].wedge], {}, labels[i]};
      for (std::size_t k = 0; k < groups.size(); ++k)
        what.groups[k] = groups[k].group_of[i];
      shown.push_back({what, i});
    }
    std::sort(shown.begin(), shown.end());
    const std::vector<Shown> combinations = firsts_of(shown);
    VertexArray vertices{{}, {}, representatives_.channels};
    auto of = shown.begin();
    for (const auto& [what, member] : combinations) {
      std::vector<WeightedVertex> members;
      for (; of != shown.end() && of->what == what; ++of)
        members.push_back({channels_of_wedge(cluster[of->member]), cluster[of->member].area});
      vertices.append(representatives_.positions[c], combined(what, groups, members));
    }
    return numbered(cluster, shown, combinations, vertices);
  }

  /// The attributes of a combination. `groups`: of each metric.
  std::vector<float> combined(const Combination& what, std::span<const AttributeGroups> groups,
                              std::span<const WeightedVertex> members) const {
    std::vector<float> attributes(rules_.channels());
    const auto put = [&](const AttributePart& part, const auto& numbers) {
      std::copy_n(numbers.begin(), part.count, part.of(std::span(attributes)).begin());
    };
    for (std::size_t k = 0; k < groups.size(); ++k)
      put(metrics_[k].channels(), groups[k].values[what.groups[k]]);
    rules_.values().mix(members, attributes.data());
    if (texcoords_.count > 0)
      put(texcoords_, coordinates_[what.chart]);
    return attributes;
  }

  NewWedges numbered(std::span<const ClusterWedge> cluster, std::span<const Shown> shown,
                     std::span<const Shown> combinations, const VertexArray& vertices) const {
    const Numbering numbering = number(combinations, vertices);
    NewWedges made{{{}, {}, vertices.channels}, std::vector<std::uint32_t>(cluster.size())};
    made.vertices.append(vertices, numbering.combinations);
    std::size_t i = 0;
    for (const Shown& s : shown) {
      i += std::size_t{s.what != combinations[i].what};
      made.number_of[s.member] = numbering.number_of[i];
    }
    for (std::uint32_t m = 0; m < cluster.size(); ++m) {
      if (!cluster[m].survives)
        made.number_of[m] = numbering.number_of[nearest(cluster[m].wedge, combinations, vertices)];
    }
    return made;
  }

  /// The combination nearest to an old wedge: of its chart, or of all if that shows nothing.
  std::size_t nearest(std::uint32_t wedge, std::span<const Shown> combinations,
                      const VertexArray& vertices) const {
    const auto chart_of = [](const Shown& shown) { return shown.what.chart; };
    const auto begin = std::ranges::lower_bound(combinations, charts_[wedge], {}, chart_of);
    const auto end = std::ranges::upper_bound(combinations, charts_[wedge], {}, chart_of);
    const bool any = begin != end;
    const auto first = any ? static_cast<std::size_t>(begin - combinations.begin()) : 0;
    const auto count = any ? static_cast<std::size_t>(end - begin) : combinations.size();
    std::size_t best = first;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = first; i < first + std::min(count, kMostCompared); ++i) {
      const double difference =
          squared_difference(rules_, wedges_.attributes_of(wedge), vertices.attributes_of(i));
      if (difference < least) {
        least = difference;
        best = i;
      }
    }
    return best;
  }

  /// The first wedge of a place, and its copies.
  static void put(const VertexArray& vertices, std::uint32_t place, ContractedWedges& result) {
    if (vertices.size() == 0)
      return;
    const auto first = vertices.attributes_of(0);
    std::copy(first.begin(), first.end(),
              result.attributes.begin() + static_cast<std::ptrdiff_t>(place * first.size()));
    result.copies.vertices.append(vertices, 1, vertices.size());
    result.copies.places.insert(result.copies.places.end(), vertices.size() - 1, place);
  }

  /// `number_of`: of each wedge.
  WedgeMap map_of(std::span<const std::uint32_t> number_of) const {
    WedgeMap map;
    const std::uint32_t own_count = wedges_.own_place_count();
    map.firsts.assign(number_of.begin(), number_of.begin() + own_count);
    for (std::uint32_t place = 0; place < own_count; ++place) {
      for (std::uint32_t k = 1; k < wedges_.count_at(place); ++k) {
        map.copies.push_back(number_of[wedges_.at(place, k)]);
        map.places.push_back(place);
      }
    }
    return map;
  }

  const VertexArray& representatives_;
  const AttributeRules& rules_;
  AttributePart texcoords_;
  std::vector<AttributeMetric> metrics_;
  TileWedges wedges_;
  WedgeClusters clusters_;
  WedgeUse use_;
  std::vector<std::uint32_t> charts_;            ///< of each wedge
  std::vector<char> wanted_;                     ///< of each cluster
  std::vector<TextureCoordinates> coordinates_;  ///< of each chart
};

/// Without attributes all wedges of a place are equal: one of them stays.
ContractedWedges one_wedge_a_place(const TileMesh& joined) {
  const std::size_t own_copies = joined.copies.first_of(joined.own_count);
  ContractedWedges result;
  result.map.firsts.resize(joined.own_count);
  result.map.copies.resize(own_copies);
  result.map.places.assign(joined.copies.places.begin(),
                           joined.copies.places.begin() + static_cast<std::ptrdiff_t>(own_copies));
  return result;
}

}  // namespace

ContractedWedges contract_wedges(const BuildTile& joined, const Contraction& contraction,
                                 const AttributeRules& rules, const WedgeOptions& options) {
  if (contraction.representatives.channels == 0)
    return one_wedge_a_place(joined.mesh);
  return WedgeContraction(joined, contraction, rules, options).run();
}

}  // namespace meshhier::cluster_simplify
