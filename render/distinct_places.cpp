#include "render/distinct_places.h"

#include <bit>
#include <cstddef>
#include <limits>

namespace meshhier::render {
namespace {

constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

std::array<std::uint32_t, 3> bits_of(Vec3f place) {
  return std::bit_cast<std::array<std::uint32_t, 3>>(place);
}

std::size_t hash_of(Vec3f place) {
  constexpr std::uint64_t kFactor = 0x9E3779B97F4A7C15;  // 2^64 by the golden ratio
  std::uint64_t hash = 0;
  for (const std::uint32_t bits : bits_of(place))
    hash = (std::rotl(hash, 5) ^ bits) * kFactor;
  return static_cast<std::size_t>(hash >> 32);
}

}  // namespace

DistinctPlaces distinct_places(std::span<const Facet> facets) {
  DistinctPlaces distinct;
  distinct.corners.reserve(facets.size());
  // Each place has one slot where it may be remembered: another of the same slot takes it.
  std::vector<std::uint32_t> last(std::bit_ceil(facets.size() + 1), kUnused);
  const auto number_of = [&](Vec3f place) {
    std::uint32_t& known = last[hash_of(place) & (last.size() - 1)];
    if (known == kUnused || bits_of(distinct.places[known]) != bits_of(place)) {
      known = static_cast<std::uint32_t>(distinct.places.size());
      distinct.places.push_back(place);
    }
    return known;
  };
  for (const Facet& facet : facets) {
    auto& corners = distinct.corners.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = number_of(facet[i].position);
  }
  return distinct;
}

}  // namespace meshhier::render
