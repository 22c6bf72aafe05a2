// Records of a block told apart by where they go, without moving them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::partition {

/// Records of numbered buckets. Used again and again, it keeps its memory.
template <class Record>
class Bucketed {
 public:
  /// Forgets all records. O(buckets).
  void clear(std::size_t buckets) {
    last_.assign(buckets, kNone);
    links_.clear();
  }
  void add(std::uint32_t bucket, const Record& record) {
    links_.push_back({record, last_[bucket]});
    last_[bucket] = static_cast<std::uint32_t>(links_.size() - 1);
  }

  /// In all buckets.
  std::size_t size() const { return links_.size(); }
  bool has(std::uint32_t bucket) const { return last_[bucket] != kNone; }

  /// Calls visit(record) for those of a bucket, the last one first.
  template <class Visit>
  void for_each(std::uint32_t bucket, const Visit& visit) const {
    for (std::uint32_t i = last_[bucket]; i != kNone; i = links_[i].before)
      visit(links_[i].record);
  }

 private:
  static constexpr std::uint32_t kNone = ~0U;
  struct Link {
    Record record;
    std::uint32_t before;  ///< in the same bucket
  };
  std::vector<std::uint32_t> last_;  ///< per bucket
  std::vector<Link> links_;
};

}  // namespace meshhier::partition
