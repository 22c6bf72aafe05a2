// The places of many facets' corners, each once: what is done for each place is done some six times
// less often then.
#pragma once

#include "base/vec.h"
#include "render/facet.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::render {

struct DistinctPlaces {
  std::vector<Vec3f> places;                          ///< some of them may be equal
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< of each facet, which of the places
};

/// Finds equal places by bits. Requires fewer than 2^32 / 3 facets. Linear.
DistinctPlaces distinct_places(std::span<const Facet> facets);

}  // namespace meshhier::render
