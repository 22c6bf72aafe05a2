#include "partition/coarsen.h"

#include <algorithm>
#include <memory>
#include <numeric>

namespace meshhier::partition {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

// A star's centre takes no more neighbours than this: two thirds more than most vertices have, but
// no hub makes a cluster that could not be balanced.
constexpr std::uint32_t kMostStar = 10;

/// Each vertex's triangles: those of v are [first[v], first[v + 1]) of `triangles`, in any order.
struct Incidence {
  std::vector<std::uint32_t> first;
  std::unique_ptr<std::uint32_t[]> triangles;

  explicit Incidence(const Surface& surface)
      : first(surface.size() + 2),
        triangles(std::make_unique_for_overwrite<std::uint32_t[]>(3 * surface.triangles.size())) {
    // Counted two places on, summed, and moved one place back while they are filled in.
    for (const auto& [a, b, c] : surface.triangles) {
      ++first[a + 2];
      ++first[b + 2];
      ++first[c + 2];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (std::uint32_t i = 0; i < surface.triangles.size(); ++i) {
      const auto& [a, b, c] = surface.triangles[i];
      triangles[first[a + 1]++] = i;
      triangles[first[b + 1]++] = i;
      triangles[first[c + 1]++] = i;
    }
  }
};

}  // namespace

Clusters star_clusters(const Surface& surface) {
  const Incidence incidence(surface);
  Clusters clusters{std::vector<std::uint32_t>(surface.size(), kNone), 0};
  std::vector<std::uint32_t> star;
  for (std::uint32_t v = 0; v < surface.size(); ++v) {
    if (clusters.of[v] != kNone)
      continue;
    clusters.of[v] = clusters.count;
    star.clear();
    for (std::uint32_t i = incidence.first[v]; i < incidence.first[v + 1]; ++i) {
      for (const std::uint32_t u : surface.triangles[incidence.triangles[i]]) {
        if (clusters.of[u] != kNone)
          continue;
        clusters.of[u] = clusters.count;
        star.push_back(u);
      }
    }
    if (star.size() > kMostStar) {
      std::nth_element(star.begin(), star.begin() + kMostStar, star.end());
      for (std::size_t i = kMostStar; i < star.size(); ++i)
        clusters.of[star[i]] = kNone;
    }
    ++clusters.count;
  }
  return clusters;
}

Clusters star_clusters(const Graph& graph) {
  Clusters clusters{std::vector<std::uint32_t>(graph.size(), kNone), 0};
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (clusters.of[v] != kNone)
      continue;
    clusters.of[v] = clusters.count;
    std::uint32_t left = kMostStar;
    for (const Graph::Arc& arc : graph.arcs_of(v)) {
      if (left > 0 && clusters.of[arc.to] == kNone) {
        clusters.of[arc.to] = clusters.count;
        --left;
      }
    }
    ++clusters.count;
  }
  return clusters;
}

Clusters matched_pairs(const Graph& graph, std::uint32_t most) {
  std::vector<std::uint32_t> mate(graph.size(), kNone);
  std::vector<std::uint32_t> waiting(graph.size(), kNone);  // for a mate, per heaviest neighbour
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (mate[v] != kNone)
      continue;
    float best_rating = 0;
    std::uint32_t best = kNone, heaviest = kNone, heaviest_weight = 0;
    for (const Graph::Arc& arc : graph.arcs_of(v)) {
      if (arc.weight > heaviest_weight) {
        heaviest_weight = arc.weight;
        heaviest = arc.to;
      }
      if (mate[arc.to] != kNone || graph.weight[v] + graph.weight[arc.to] > most)
        continue;
      const auto weight = static_cast<float>(arc.weight);
      const float rating = weight * weight / static_cast<float>(graph.weight[arc.to]);
      if (rating > best_rating) {
        best_rating = rating;
        best = arc.to;
      }
    }
    if (best == kNone && heaviest != kNone) {
      best = waiting[heaviest];
      waiting[heaviest] = kNone;
      if (best == kNone || mate[best] != kNone || graph.weight[v] + graph.weight[best] > most) {
        waiting[heaviest] = v;
        continue;
      }
    }
    if (best != kNone) {
      mate[v] = best;
      mate[best] = v;
    }
  }
  Clusters clusters{std::vector<std::uint32_t>(graph.size()), 0};
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    clusters.of[v] = mate[v] != kNone && mate[v] < v ? clusters.of[mate[v]] : clusters.count++;
  }
  return clusters;
}

}  // namespace meshhier::partition
