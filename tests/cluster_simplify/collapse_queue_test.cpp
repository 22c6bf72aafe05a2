#include "cluster_simplify/collapse_queue.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using Limits = std::numeric_limits<float>;

/// Costs of all magnitudes from 0 to infinity, ascending.
std::vector<float> many_costs() {
  std::vector<float> costs = {0, Limits::denorm_min(), Limits::min(),     Limits::epsilon(),
                              1, Limits::max(),        Limits::infinity()};
  const std::uint32_t infinity = std::bit_cast<std::uint32_t>(Limits::infinity());
  for (std::uint32_t bits = 1; bits < infinity; bits += 7'919 * 13)
    costs.push_back(std::bit_cast<float>(bits));
  std::ranges::sort(costs);
  return costs;
}

/// The same promises kept the slow way.
class Reference {
 public:
  void push(std::uint32_t item, float cost) {
    buckets_[CollapseQueue::bucket_of(cost)].push_back(item);
  }
  void erase(std::uint32_t item) {
    for (auto entry = buckets_.begin(); entry != buckets_.end(); ++entry) {
      if (std::erase(entry->second, item) == 0)
        continue;
      if (entry->second.empty())
        buckets_.erase(entry);
      return;
    }
  }
  std::uint32_t top() const {
    return buckets_.empty() ? CollapseQueue::kNone : buckets_.begin()->second.back();
  }

 private:
  std::map<std::uint32_t, std::vector<std::uint32_t>> buckets_;
};

std::uint32_t pick(std::uint64_t index, std::uint64_t stream, std::uint32_t count) {
  return std::min(count - 1, static_cast<std::uint32_t>((tests::hash_noise(index, stream) + 1) / 2 *
                                                        static_cast<float>(count)));
}

float random_cost(std::uint64_t step) {
  switch (pick(step, 3, 8)) {
    case 0:
      return 0;
    case 1:
      return Limits::infinity();
    case 2:
      return Limits::denorm_min() * static_cast<float>(pick(step, 4, 1000));
    case 3:
      return 1;  // many in one bucket
    default:
      return std::exp2(60 * tests::hash_noise(step, 5));
  }
}

TEST(CollapseQueueTest, BucketsAscendWithCosts) {
  const std::vector<float> costs = many_costs();
  ASSERT_GT(costs.size(), 10'000U);
  for (std::size_t i = 1; i < costs.size(); ++i) {
    ASSERT_LE(CollapseQueue::bucket_of(costs[i - 1]), CollapseQueue::bucket_of(costs[i]))
        << costs[i - 1] << " and " << costs[i];
  }
}

TEST(CollapseQueueTest, CostsInOneBucketAreWithinASixteenth) {
  const std::vector<float> costs = many_costs();
  for (std::size_t i = 1; i < costs.size(); ++i) {
    const float low = costs[i - 1];
    if (low >= Limits::min() &&
        CollapseQueue::bucket_of(low) == CollapseQueue::bucket_of(costs[i])) {
      ASSERT_LE(costs[i], low * (1 + 1.0F / 16));
    }
  }
  for (float cost = Limits::min() * 4; cost < Limits::max() / 4; cost *= 2)
    ASSERT_EQ(CollapseQueue::bucket_of(2 * cost), CollapseQueue::bucket_of(cost) + 16);
}

TEST(CollapseQueueTest, NothingFiniteCostsAsMuchAsInfinity) {
  EXPECT_LT(CollapseQueue::bucket_of(Limits::max()), CollapseQueue::bucket_of(Limits::infinity()));
  EXPECT_EQ(CollapseQueue::bucket_of(0), 0U);
}

TEST(CollapseQueueTest, EveryCostHasItsPlace) {
  const std::vector<float> costs = many_costs();
  CollapseQueue queue(static_cast<std::uint32_t>(costs.size()));
  for (std::size_t i = costs.size(); i-- > 0;)
    queue.push(static_cast<std::uint32_t>(i), costs[i]);
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const std::uint32_t item = queue.top();
    ASSERT_NE(item, CollapseQueue::kNone);
    ASSERT_EQ(queue.bucket(item), CollapseQueue::bucket_of(costs[item]));
    ASSERT_GE(queue.bucket(item), last);
    last = queue.bucket(item);
    queue.erase(item);
  }
  EXPECT_EQ(queue.top(), CollapseQueue::kNone);
}

TEST(CollapseQueueTest, AnEmptyQueueHasNoTop) {
  CollapseQueue none(0);
  EXPECT_EQ(none.top(), CollapseQueue::kNone);
  CollapseQueue queue(3);
  EXPECT_EQ(queue.top(), CollapseQueue::kNone);
  EXPECT_FALSE(queue.contains(0));
  queue.push(1, 5);
  EXPECT_TRUE(queue.contains(1));
  EXPECT_FALSE(queue.contains(0));
  EXPECT_EQ(queue.top(), 1U);
  EXPECT_EQ(queue.top(), 1U);  // not removed
  queue.erase(1);
  EXPECT_EQ(queue.top(), CollapseQueue::kNone);
}

TEST(CollapseQueueTest, LastInIsFirstOutAmongEquals) {
  CollapseQueue queue(5);
  for (std::uint32_t item = 0; item < 5; ++item)
    queue.push(item, 1);
  queue.erase(3);  // from the middle
  for (const std::uint32_t expected : {4U, 2U, 1U, 0U}) {
    EXPECT_EQ(queue.top(), expected);
    queue.erase(expected);
  }
}

TEST(CollapseQueueTest, ACheaperItemComesFirstEvenAfterDearerOnesWereTaken) {
  CollapseQueue queue(3);
  queue.push(0, 100);
  queue.push(1, 1000);
  EXPECT_EQ(queue.top(), 0U);
  queue.erase(0);
  EXPECT_EQ(queue.top(), 1U);
  queue.push(2, 1);
  EXPECT_EQ(queue.top(), 2U);
}

TEST(CollapseQueueTest, DoesWhatAReferenceDoes) {
  constexpr std::uint32_t kItems = 300;
  CollapseQueue queue(kItems);
  Reference reference;
  std::vector<bool> in(kItems);
  for (std::uint64_t step = 0; step < 60'000; ++step) {
    const bool take_top = pick(step, 1, 4) == 0 && reference.top() != CollapseQueue::kNone;
    const std::uint32_t item = take_top ? reference.top() : pick(step, 2, kItems);
    if (in[item]) {
      queue.erase(item);
      reference.erase(item);
    } else {
      const float cost = random_cost(step);
      queue.push(item, cost);
      reference.push(item, cost);
      ASSERT_EQ(queue.bucket(item), CollapseQueue::bucket_of(cost));
    }
    in[item] = !in[item];
    ASSERT_EQ(queue.contains(item), in[item]);
    ASSERT_EQ(queue.top(), reference.top()) << "step " << step;
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
