// Joins stretches of lines, each with a beginning and an end, into chains.
//
//     ends are numbers: stretch i begins at 2 i and ends at 2 i + 1
//
//        0 --> 1  3 <-- 2  4 --> 5          other(1) = 3, other(2) = 4: one open chain of three,
//                                           the second one backwards
//
// Invariant. The chains, their order and their directions depend on the pairs alone: a chain stands
// where its least stretch does, and runs in the direction of that.
//
// Cost. Linear; 8 bytes a stretch, and a bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::drawing {

class LineChains {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Requires count < 2^31.
  explicit LineChains(std::size_t count) : others_(2 * count, kNone) {}

  /// Joins ends that meet in one point: beginnings with ends in their order, as neighbours with one
  /// sense of turn have them, then what is left of either kind among itself. An odd one stays open.
  void meet(std::span<const std::uint32_t> ends);

  /// Returns the end that it is joined with; kNone: it is open.
  std::uint32_t other(std::uint32_t end) const { return others_[end]; }

  /// Calls visit(entry, is_closed) for each chain; `entry`: the end of the stretch where it starts.
  template <class Visit>
  void for_each_chain(const Visit& visit) const {
    std::vector<bool> is_done(others_.size() / 2);
    for (std::uint32_t i = 0; i < is_done.size(); ++i) {
      if (is_done[i])
        continue;
      const std::uint32_t entry = start_of(2 * i);
      for_each_stretch(entry, [&](std::uint32_t at) { is_done[at / 2] = true; });
      visit(entry, others_[entry] != kNone);
    }
  }

  /// Calls visit(end) for each stretch of a chain in its order, with the end where it is entered.
  template <class Visit>
  void for_each_stretch(std::uint32_t entry, const Visit& visit) const {
    std::uint32_t at = entry;
    do {
      visit(at);
      at = others_[at ^ 1];
    } while (at != kNone && at != entry);
  }

 private:
  /// Walks back from an end to where its chain starts; a closed one starts here.
  std::uint32_t start_of(std::uint32_t end) const {
    std::uint32_t at = end;
    while (others_[at] != kNone) {
      at = others_[at] ^ 1;
      if (at == end)
        break;
    }
    return at;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    others_[a] = b;
    others_[b] = a;
  }

  std::vector<std::uint32_t> others_;
};

}  // namespace meshhier::drawing
