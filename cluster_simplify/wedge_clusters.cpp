#include "cluster_simplify/wedge_clusters.h"

#include <numeric>

namespace meshhier::cluster_simplify {

WedgeClusters::WedgeClusters(const TileWedges& wedges, const Contraction& contraction)
    : wedges_(wedges),
      parent_of_(contraction.parent_of),
      ends_(contraction.representatives.size() + 2),
      places_(contraction.parent_of.size()) {
  for (const std::uint32_t cluster : parent_of_)
    ++ends_[cluster + 2];
  std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
  // Where a cluster begins is at [cluster + 1] until its places are put, its end afterwards.
  for (std::uint32_t place = 0; place < parent_of_.size(); ++place)
    places_[ends_[parent_of_[place] + 1]++] = place;
}

}  // namespace meshhier::cluster_simplify
