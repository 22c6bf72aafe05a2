// A set of objects that tells the place of each among its members: a bit each, and a count before
// every 64 of them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier {

class ObjectSet {
 public:
  /// Objects are below `objects`.
  explicit ObjectSet(std::uint32_t objects) : words_((std::size_t{objects} + 63) / 64) {}

  void add(std::uint32_t object) { words_[object / 64] |= bit_of(object); }
  bool has(std::uint32_t object) const { return (words_[object / 64] & bit_of(object)) != 0; }

  /// Ends adding: the next three need it.
  void close() {
    std::uint32_t count = 0;
    for (const std::uint64_t word : words_) {
      before_.push_back(count);
      count += static_cast<std::uint32_t>(std::popcount(word));
    }
    before_.push_back(count);
  }
  std::uint32_t size() const { return before_.back(); }
  /// Returns how many members are smaller. O(1).
  std::uint32_t place_of(std::uint32_t object) const {
    const std::uint64_t smaller = words_[object / 64] & (bit_of(object) - 1);
    return before_[object / 64] + static_cast<std::uint32_t>(std::popcount(smaller));
  }
  /// Calls visit(object) for each member, ascending.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      for (std::uint64_t left = words_[i]; left != 0; left &= left - 1)
        visit(static_cast<std::uint32_t>(64 * i) +
              static_cast<std::uint32_t>(std::countr_zero(left)));
    }
  }

 private:
  static std::uint64_t bit_of(std::uint32_t object) { return std::uint64_t{1} << (object % 64); }

  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;
};

}  // namespace meshhier
