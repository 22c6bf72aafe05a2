// Which wedges of a joined tile come together at one place.
#pragma once

#include "cluster_simplify/seams.h"
#include "cluster_simplify/tile_wedges.h"
#include "hierarchy/triangle.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// The old own places by the representative that stands for them.
class WedgeClusters {
 public:
  /// Both outlive this. O(n).
  WedgeClusters(const TileWedges& wedges, const Contraction& contraction);

  std::uint32_t count() const { return static_cast<std::uint32_t>(ends_.size()) - 2; }
  /// Its places, ascending.
  std::span<const std::uint32_t> places(std::uint32_t cluster) const {
    return std::span(places_).subspan(ends_[cluster],
                                      std::size_t{ends_[cluster + 1]} - ends_[cluster]);
  }
  /// The wedge's cluster; of a ghost's a number that is its place's alone, count() or more.
  std::uint32_t of(std::uint32_t wedge) const {
    const std::uint32_t place = wedges_.place_of(wedge);
    return place < parent_of_.size() ? parent_of_[place] : count() + place;
  }
  /// Whether a triangle keeps three places.
  bool survives(const WedgeTriangle& t) const {
    return !is_degenerate(Triangle<std::uint32_t>{of(t[0]), of(t[1]), of(t[2])});
  }

 private:
  const TileWedges& wedges_;
  std::span<const std::uint32_t> parent_of_;
  std::vector<std::uint32_t> ends_, places_;
};

}  // namespace meshhier::cluster_simplify
