#include "cluster_simplify/texture_charts.h"

#include "base/closest_point.h"
#include "base/sort_few.h"
#include "base/union_find.h"

#include <algorithm>
#include <bit>
#include <compare>
#include <cstddef>
#include <limits>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

TextureCoordinates coordinates_of(const TileWedges& wedges, const AttributePart& texcoords,
                                  std::uint32_t wedge) {
  const auto uv = texcoords.of(wedges.attributes_of(wedge));
  return {uv[0], uv[1]};
}

/// Equal for equal coordinates; 0 and -0 are.
std::uint64_t key_of(TextureCoordinates uv) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(uv[0] + 0.0F)} << 32 |
         std::bit_cast<std::uint32_t>(uv[1] + 0.0F);
}

struct KeyedWedge {
  std::uint64_t key;
  std::uint32_t wedge;
};

/// The classes at one place.
void find_classes(std::vector<KeyedWedge>& at_place, std::vector<std::uint32_t>& class_of) {
  sort_few(std::span(at_place), [](const KeyedWedge& k) { return std::pair(k.key, k.wedge); });
  for (std::size_t i = 0, first = 0; i < at_place.size(); ++i) {
    if (at_place[i].key != at_place[first].key)
      first = i;
    class_of[at_place[i].wedge] = at_place[first].wedge;
  }
}

/// Puts together the wedges at the ends of edges that lie within clusters.
void join_charts(const TileWedges& wedges, const WedgeClusters& clusters, UnionFind& charts) {
  for (const WedgeTriangle& t : wedges.triangles()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = t[(k + 1) % 3];
      if (clusters.of(t[k]) == clusters.of(next))
        charts.join(t[k], next);
    }
  }
}

/// Marks the clusters that have several charts although their places have one wedge each.
std::vector<char> scattered_clusters(const TileWedges& wedges, const WedgeClusters& clusters,
                                     UnionFind& charts) {
  std::vector<char> scattered(clusters.count());
  for (std::uint32_t c = 0; c < clusters.count(); ++c) {
    const auto places = clusters.places(c);
    const auto is_other = [&](std::uint32_t p) { return charts.find(p) != charts.find(places[0]); };
    const auto has_copies = [&](std::uint32_t p) { return wedges.count_at(p) > 1; };
    scattered[c] =
        std::ranges::any_of(places, is_other) && std::ranges::none_of(places, has_copies) ? 1 : 0;
  }
  return scattered;
}

/// A wedge of a cluster with one beside it.
struct Neighbour {
  std::uint32_t cluster, neighbour, wedge;
  friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

/// Puts together what has a common neighbour: cells hold places that no edge connects. Not where
/// places have copies: around the end of a seam that would tie its two sides together.
void join_over_neighbours(const TileWedges& wedges, const WedgeClusters& clusters,
                          UnionFind& charts) {
  const std::vector<char> scattered = scattered_clusters(wedges, clusters, charts);
  std::vector<Neighbour> neighbours;
  for (const WedgeTriangle& t : wedges.triangles()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t cluster = clusters.of(t[k]);
      if (cluster >= clusters.count() || scattered[cluster] == 0)
        continue;
      neighbours.push_back({cluster, t[(k + 1) % 3], t[k]});
      neighbours.push_back({cluster, t[(k + 2) % 3], t[k]});
    }
  }
  std::sort(neighbours.begin(), neighbours.end());
  for (std::size_t i = 1; i < neighbours.size(); ++i) {
    const Neighbour& a = neighbours[i - 1];
    const Neighbour& b = neighbours[i];
    if (a.cluster == b.cluster && a.neighbour == b.neighbour)
      charts.join(a.wedge, b.wedge);
  }
}

/// A mean of three numbers, within them.
float weighted(const std::array<double, 3>& weights, const std::array<float, 3>& values) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k)
    sum +=
        weights[k] > 0 ? weights[k] * double{values[k]} : 0;  // what is not there may be infinite
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const auto mean = static_cast<float>(sum);
  return mean < *least ? *least : mean > *most ? *most : mean;
}

/// The triangles' points nearest to where charts come to lie, as far as they were offered.
class NearestPlaces {
 public:
  NearestPlaces(const TileWedges& wedges, const AttributePart& texcoords)
      : wedges_(wedges),
        texcoords_(texcoords),
        distances_(wedges.count(), std::numeric_limits<double>::infinity()),
        found_(wedges.count()) {}

  void offer(const WedgeTriangle& t, std::uint32_t chart, Vec3d to) {
    const auto corner = [&](std::size_t k) { return to_double(wedges_.position_of(t[k])); };
    const ClosestPoint closest = closest_point(to, {corner(0), corner(1), corner(2)});
    if (!(closest.squared_distance < distances_[chart]))
      return;
    distances_[chart] = closest.squared_distance;
    found_[chart] =
        coordinates_at({1 - closest.on_b - closest.on_c, closest.on_b, closest.on_c}, t);
  }

  std::vector<TextureCoordinates> take() { return std::move(found_); }

 private:
  TextureCoordinates coordinates_at(const std::array<double, 3>& weights,
                                    const WedgeTriangle& t) const {
    const std::array<TextureCoordinates, 3> uv{coordinates_of(wedges_, texcoords_, t[0]),
                                               coordinates_of(wedges_, texcoords_, t[1]),
                                               coordinates_of(wedges_, texcoords_, t[2])};
    return {weighted(weights, {uv[0][0], uv[1][0], uv[2][0]}),
            weighted(weights, {uv[0][1], uv[1][1], uv[2][1]})};
  }

  const TileWedges& wedges_;
  const AttributePart& texcoords_;
  std::vector<double> distances_;
  std::vector<TextureCoordinates> found_;
};

}  // namespace

std::vector<std::uint32_t> texture_classes(const TileWedges& wedges,
                                           const AttributePart& texcoords) {
  std::vector<std::uint32_t> class_of(wedges.count());
  std::vector<KeyedWedge> at_place;
  for (std::uint32_t place = 0; place < wedges.place_count(); ++place) {
    at_place.clear();
    for (std::uint32_t k = 0; k < wedges.count_at(place); ++k) {
      const std::uint32_t wedge = wedges.at(place, k);
      at_place.push_back(
          {texcoords.count > 0 ? key_of(coordinates_of(wedges, texcoords, wedge)) : 0, wedge});
    }
    find_classes(at_place, class_of);
  }
  return class_of;
}

std::vector<std::uint32_t> texture_charts(const TileWedges& wedges, const WedgeClusters& clusters,
                                          const AttributePart& texcoords) {
  UnionFind charts(wedges.count());
  const std::vector<std::uint32_t> class_of = texture_classes(wedges, texcoords);
  for (std::uint32_t wedge = 0; wedge < wedges.count(); ++wedge)
    charts.join(class_of[wedge], wedge);
  join_charts(wedges, clusters, charts);
  join_over_neighbours(wedges, clusters, charts);
  std::vector<std::uint32_t> names(wedges.count());
  for (std::uint32_t wedge = 0; wedge < wedges.count(); ++wedge)
    names[wedge] = charts.find(wedge);
  return names;
}

std::vector<TextureCoordinates> chart_coordinates(const TileWedges& wedges,
                                                  const WedgeClusters& clusters,
                                                  std::span<const std::uint32_t> charts,
                                                  std::span<const Vec3f> positions,
                                                  std::span<const char> wanted,
                                                  const AttributePart& texcoords) {
  if (texcoords.count == 0)
    return {};
  NearestPlaces nearest(wedges, texcoords);
  for (const WedgeTriangle& t : wedges.triangles()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t chart = charts[t[k]];
      const std::uint32_t cluster = clusters.of(t[k]);
      const bool is_known = (k > 0 && chart == charts[t[0]]) || (k > 1 && chart == charts[t[1]]);
      if (!is_known && cluster < clusters.count() && wanted[cluster] != 0)
        nearest.offer(t, chart, to_double(positions[cluster]));
    }
  }
  return nearest.take();
}

}  // namespace meshhier::cluster_simplify
