// A monotone-friendly priority queue of edges by cost, in buckets of the cost's float bits.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Holds each of n items at most once. Items whose costs differ by less than a sixteenth of a
/// factor two share a bucket; the last one in is the first one out.
///
/// A bucket is a stack of blocks as large as a cache line. What is erased stays there and is
/// dropped when its turn comes: an item is in the queue if it knows its bucket.
class CollapseQueue {
 public:
  explicit CollapseQueue(std::uint32_t item_count)
      : tops_(kBuckets, kNone), bucket_of_item_(item_count, kNowhere), lowest_(kBuckets) {}

  /// The bucket of a cost; costs are >= 0 and not NaN, infinity is the last.
  static std::uint32_t bucket_of(float cost) {
    return std::bit_cast<std::uint32_t>(cost) >> kShift;
  }

  bool contains(std::uint32_t item) const { return bucket_of_item_[item] != kNowhere; }

  /// Requires !contains(item).
  void push(std::uint32_t item, float cost) {
    const std::uint32_t bucket = bucket_of(cost);
    bucket_of_item_[item] = static_cast<std::uint16_t>(bucket);
    std::uint32_t& top = tops_[bucket];
    top = top % kBlock == kBlock - 1 ? begin_block(top) : top + 1;
    places_[top] = item;
    lowest_ = std::min(lowest_, bucket);
  }

  void erase(std::uint32_t item) { bucket_of_item_[item] = kNowhere; }

  /// Takes up to items.size() items, one at least, of the lowest bucket in use; none if the queue
  /// is empty.
  std::span<std::uint32_t> pop(std::span<std::uint32_t> items) {
    std::size_t count = 0;
    for (; lowest_ < kBuckets; ++lowest_) {
      while (count < items.size() && tops_[lowest_] != kNone) {
        const std::uint32_t item = take_top();
        if (bucket_of_item_[item] != lowest_)
          continue;  // erased
        erase(item);
        items[count++] = item;
      }
      if (count > 0)
        break;
    }
    return items.first(count);
  }

  /// Where the items last taken lay.
  std::uint32_t lowest() const { return lowest_; }

 private:
  // Sign (never set), eight bits of exponent, four of mantissa: 16 buckets a factor of two.
  static constexpr int kShift = 19;
  static constexpr std::uint32_t kBuckets = 1U << (31 - kShift);
  static constexpr std::uint16_t kNowhere = std::numeric_limits<std::uint16_t>::max();
  /// Places of a block; the first leads to the bucket's top before the block was begun.
  static constexpr std::uint32_t kBlock = 16;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static_assert(kNone % kBlock == kBlock - 1, "an empty bucket begins a block, too");

  std::uint32_t begin_block(std::uint32_t below) {
    std::uint32_t block;
    if (free_.empty()) {
      block = static_cast<std::uint32_t>(places_.size());
      places_.resize(places_.size() + kBlock);
    } else {
      block = free_.back();
      free_.pop_back();
    }
    places_[block] = below;
    return block + 1;
  }

  std::uint32_t take_top() {
    std::uint32_t& top = tops_[lowest_];
    const std::uint32_t item = places_[top];
    if (top % kBlock == 1) {
      free_.push_back(top - 1);
      top = places_[top - 1];
    } else {
      --top;
    }
    return item;
  }

  std::vector<std::uint32_t> places_;
  std::vector<std::uint32_t> free_;  ///< blocks no longer in use
  std::vector<std::uint32_t> tops_;  ///< per bucket, the place of the last one in
  std::vector<std::uint16_t> bucket_of_item_;
  std::uint32_t lowest_;
};

}  // namespace meshhier::cluster_simplify
