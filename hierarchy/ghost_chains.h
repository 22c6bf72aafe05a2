// Where the ghosts of a tile lead as their tiles are shown coarser.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier {

/// The indices of a ghost's vertex from its own tile upwards: level l, l-1, ... down to the level
/// below the common ancestor (Tree::chain_length entries). [0] equals the ghost's GhostRef::index.
using GhostChain = std::span<const std::uint16_t>;

/// A chain a ghost, one after another in one array: tiles in which almost every vertex is a ghost
/// are no slower to read than others. Fewer than 2^32 entries.
class GhostChains {
 public:
  std::size_t size() const { return ends_.size(); }
  GhostChain operator[](std::size_t ghost) const {
    return GhostChain(entries_).subspan(begin(ghost), ends_[ghost] - begin(ghost));
  }
  std::span<std::uint16_t> operator[](std::size_t ghost) {
    return std::span(entries_).subspan(begin(ghost), ends_[ghost] - begin(ghost));
  }
  /// All of them, one after another.
  std::span<const std::uint16_t> entries() const { return entries_; }

  void reserve(std::size_t ghosts, std::size_t entries) {
    ends_.reserve(ghosts);
    entries_.reserve(entries);
  }
  void add(GhostChain chain) {
    entries_.insert(entries_.end(), chain.begin(), chain.end());
    ends_.push_back(static_cast<std::uint32_t>(entries_.size()));
  }

  friend bool operator==(const GhostChains&, const GhostChains&) = default;

 private:
  std::size_t begin(std::size_t ghost) const { return ghost == 0 ? 0 : ends_[ghost - 1]; }

  std::vector<std::uint16_t> entries_;
  std::vector<std::uint32_t> ends_;
};

}  // namespace meshhier
