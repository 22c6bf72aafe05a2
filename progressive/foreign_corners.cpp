#include "progressive/foreign_corners.h"

#include <algorithm>
#include <numeric>

namespace meshhier::progressive {

std::uint64_t ForeignCorners::memory_bytes(const LevelLists& level, std::size_t width) {
  // Each has a rank as it came and as it stays, a place twice, and its values.
  return level.foreign_ranks.size() * (24 + width * sizeof(float));
}

ForeignCorners::ForeignCorners(const LevelLists& level, std::size_t width) : width_(width) {
  const std::vector<std::uint32_t> ranks = level.foreign_ranks.read_all();
  values_ = level.foreign_values.read_all();
  places_.resize(ranks.size());
  std::iota(places_.begin(), places_.end(), std::size_t{0});
  std::ranges::stable_sort(places_, {}, [&](std::size_t place) { return ranks[place]; });
  const auto same = [&](std::size_t a, std::size_t b) { return ranks[a] == ranks[b]; };
  places_.erase(std::unique(places_.begin(), places_.end(), same), places_.end());
  for (const std::size_t place : places_)
    ranks_.push_back(ranks[place]);
}

std::size_t ForeignCorners::find(std::uint32_t rank) const {
  const auto place = std::ranges::lower_bound(ranks_, rank);
  const bool found = place != ranks_.end() && *place == rank;
  return found ? static_cast<std::size_t>(place - ranks_.begin()) : size();
}

}  // namespace meshhier::progressive
