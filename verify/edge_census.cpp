#include "verify/edge_census.h"

#include <algorithm>

namespace meshhier::verifying {
namespace {

/// Edges between own vertices that another tile draws a triangle at, by key, ascending.
std::vector<std::uint64_t> shared_edges(const PublishedTile& tile, std::uint32_t base,
                                        const std::vector<std::uint32_t>& left_out) {
  std::vector<std::uint64_t> keys;
  for (std::uint32_t place : left_out) {
    const TileTriangle& t = tile.mesh.border[place];
    for (std::size_t i = 0; i < 3; ++i) {
      const TileVertex a = t[i], b = t[(i + 1) % 3];
      if (!tile.mesh.is_own(a) || !tile.mesh.is_own(b))
        continue;
      keys.push_back(
          CutEdge{base + std::min(raw(a), raw(b)), base + std::max(raw(a), raw(b))}.key());
    }
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace

EdgeCensus::Use EdgeCensus::use_of(std::uint32_t from, std::uint32_t to) {
  if (from < to)
    return {{from, to}, 1};
  return {{to, from}, -1};
}

void EdgeCensus::add(const PublishedTile& tile, std::uint32_t base,
                     const exporting::DrawnTile& drawn) {
  const auto shared = shared_edges(tile, base, drawn.left_out);
  // Numbers below `base` wrap around and are foreign as well.
  const auto own = [&](std::uint32_t number) { return number - base < tile.mesh.own_count; };
  std::vector<Use> uses;
  uses.reserve(3 * drawn.triangles.size());
  for (const exporting::CutTriangle& t : drawn.triangles) {
    if (is_degenerate(t))
      continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      const Use use = use_of(from, to);
      const bool whole =
          own(from) && own(to) && !std::binary_search(shared.begin(), shared.end(), use.edge.key());
      if (whole) {
        uses.push_back(use);
      } else {
        seams_.add(use);
      }
    }
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& a, const Use& b) { return a.edge.key() < b.edge.key(); });
  for (const Use& use : uses)
    count(use);
  close();
}

void EdgeCensus::finish() {
  seams_.sort();
  seams_.for_each_block([this](std::span<const Use> uses) {
    for (const Use& use : uses)
      count(use);
  });
  close();
}

void EdgeCensus::count(const Use& use) {
  if (use.edge != current_.edge)
    close();
  current_.edge = use.edge;
  ++current_.triangles;
  current_.net += use.direction;
}

void EdgeCensus::close() {
  if (current_.triangles > 0 && (current_.is_border() || current_.is_unbalanced())) {
    visit_(current_);
  }
  current_ = {};
}

}  // namespace meshhier::verifying
