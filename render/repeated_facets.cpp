#include "render/repeated_facets.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace meshhier::render {
namespace {

/// Each facet has one place where it may be remembered.
constexpr std::size_t kRemembered = 4096;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

std::size_t place_of(const Facet& facet) {
  constexpr std::uint64_t kFactor = 0x9E3779B97F4A7C15;  // 2^64 by the golden ratio
  std::uint64_t hash = 0;
  for (const FacetCorner& corner : facet) {
    for (const float value : {corner.position.x, corner.position.y, corner.position.z})
      hash = (std::rotl(hash, 5) ^ std::bit_cast<std::uint32_t>(value)) * kFactor;
  }
  return static_cast<std::size_t>(hash >> 32) % kRemembered;
}

bool lies_on(const Facet& a, const Facet& b) {
  return a[0].position == b[0].position && a[1].position == b[1].position &&
         a[2].position == b[2].position;
}

}  // namespace

void drop_repeated(std::vector<Facet>& facets, std::vector<Skin>& skins) {
  std::vector<std::size_t> remembered(kRemembered, kNone);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    std::size_t& place = remembered[place_of(facets[i])];
    if (place != kNone && lies_on(facets[place], facets[i]))
      continue;
    place = kept;
    facets[kept] = facets[i];
    if (!skins.empty())
      skins[kept] = skins[i];
    ++kept;
  }
  facets.resize(kept);
  if (!skins.empty())
    skins.resize(kept);
}

}  // namespace meshhier::render
