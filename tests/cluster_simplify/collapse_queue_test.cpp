#include "cluster_simplify/collapse_queue.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
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
class ReferenceQueue {
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
  /// The lowest bucket in use. Requires some.
  std::uint32_t lowest() const { return buckets_.begin()->first; }
  std::vector<std::uint32_t> pop(std::size_t most) {
    std::vector<std::uint32_t> items;
    if (buckets_.empty())
      return items;
    std::vector<std::uint32_t>& stack = buckets_.begin()->second;
    for (; items.size() < most && !stack.empty(); stack.pop_back())
      items.push_back(stack.back());
    if (stack.empty())
      buckets_.erase(buckets_.begin());
    return items;
  }
  std::size_t size() const {
    std::size_t count = 0;
    for (const auto& [bucket, stack] : buckets_)
      count += stack.size();
    return count;
  }

 private:
  std::map<std::uint32_t, std::vector<std::uint32_t>> buckets_;
};

std::vector<std::uint32_t> pop(CollapseQueue& queue, std::size_t most) {
  std::vector<std::uint32_t> room(most);
  const auto items = queue.pop(room);
  return {items.begin(), items.end()};
}

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
    const std::vector<std::uint32_t> items = pop(queue, 1);
    ASSERT_THAT(items, SizeIs(1));
    ASSERT_EQ(queue.lowest(), CollapseQueue::bucket_of(costs[items[0]]));
    ASSERT_GE(queue.lowest(), last);
    last = queue.lowest();
  }
  EXPECT_THAT(pop(queue, 1), IsEmpty());
}

TEST(CollapseQueueTest, AnEmptyQueueHasNothingToTake) {
  CollapseQueue none(0);
  EXPECT_THAT(pop(none, 8), IsEmpty());
  CollapseQueue queue(3);
  EXPECT_THAT(pop(queue, 8), IsEmpty());
  EXPECT_FALSE(queue.contains(0));
  queue.push(1, 5);
  EXPECT_TRUE(queue.contains(1));
  EXPECT_FALSE(queue.contains(0));
  EXPECT_THAT(pop(queue, 8), ElementsAre(1U));
  EXPECT_FALSE(queue.contains(1));
  EXPECT_THAT(pop(queue, 8), IsEmpty());
  queue.push(1, 5);
  queue.erase(1);
  EXPECT_THAT(pop(queue, 8), IsEmpty());
}

TEST(CollapseQueueTest, LastInIsFirstOutAmongEquals) {
  CollapseQueue queue(5);
  for (std::uint32_t item = 0; item < 5; ++item)
    queue.push(item, 1);
  queue.erase(3);  // from the middle
  for (const std::uint32_t expected : {4U, 2U, 1U, 0U})
    EXPECT_THAT(pop(queue, 1), ElementsAre(expected));
}

TEST(CollapseQueueTest, ACheaperItemComesFirstEvenAfterDearerOnesWereTaken) {
  CollapseQueue queue(4);
  queue.push(0, 100);
  queue.push(1, 1000);
  queue.push(3, 1000);
  EXPECT_THAT(pop(queue, 1), ElementsAre(0U));
  EXPECT_THAT(pop(queue, 1), ElementsAre(3U));
  queue.push(2, 1);
  EXPECT_THAT(pop(queue, 1), ElementsAre(2U));
  EXPECT_THAT(pop(queue, 1), ElementsAre(1U));
}

TEST(CollapseQueueTest, ManyTakenAtOnceAreOfOneBucket) {
  CollapseQueue queue(6);
  for (const std::uint32_t item : {0U, 1U, 2U})
    queue.push(item, 1);
  for (const std::uint32_t item : {3U, 4U, 5U})
    queue.push(item, 2);
  EXPECT_THAT(pop(queue, 2), ElementsAre(2U, 1U));
  EXPECT_EQ(queue.lowest(), CollapseQueue::bucket_of(1));
  EXPECT_THAT(pop(queue, 2), ElementsAre(0U));  // not more of the next
  EXPECT_EQ(queue.lowest(), CollapseQueue::bucket_of(1));
  EXPECT_THAT(pop(queue, 8), ElementsAre(5U, 4U, 3U));
  EXPECT_EQ(queue.lowest(), CollapseQueue::bucket_of(2));
}

TEST(CollapseQueueTest, WhatWasErasedAndPushedAgainComesOnceAndFirst) {
  CollapseQueue queue(3);
  for (int round = 0; round < 40; ++round) {
    for (const std::uint32_t item : {0U, 1U, 2U})
      queue.push(item, 1);
    for (int again = 0; again < 20; ++again) {
      queue.erase(0);
      queue.push(0, again % 2 == 0 ? 1.0F : 7.0F);  // on what is left of it, or elsewhere
    }
    queue.erase(0);
    queue.push(0, 1);
    EXPECT_THAT(pop(queue, 1), ElementsAre(0U));
    queue.erase(2);
    EXPECT_THAT(pop(queue, 8), ElementsAre(1U));
    EXPECT_THAT(pop(queue, 8), IsEmpty());
  }
}

TEST(CollapseQueueTest, ABucketHoldsAnyNumber) {
  constexpr std::uint32_t kItems = 1000;
  CollapseQueue queue(kItems);
  for (int round = 0; round < 3; ++round) {
    for (std::uint32_t item = 0; item < kItems; ++item)
      queue.push(item, item % 2 == 0 ? 1.0F : 2.0F);
    std::vector<std::uint32_t> taken;
    for (std::uint32_t most = 1; taken.size() < kItems; most = most % 40 + 1) {
      const std::vector<std::uint32_t> items = pop(queue, most);
      ASSERT_THAT(items, Not(IsEmpty()));
      taken.insert(taken.end(), items.begin(), items.end());
    }
    for (std::uint32_t i = 0; i < kItems / 2; ++i) {
      EXPECT_EQ(taken[i], kItems - 2 - 2 * i);
      EXPECT_EQ(taken[kItems / 2 + i], kItems - 1 - 2 * i);
    }
  }
}

/// Pushes, erases and takes at random, up to `most` at once; compares with the reference.
void do_what_a_reference_does(std::uint32_t most, const auto& cost_at) {
  constexpr std::uint32_t kItems = 300;
  CollapseQueue queue(kItems);
  ReferenceQueue reference;
  std::vector<bool> in(kItems);
  for (std::uint64_t step = 0; step < 60'000; ++step) {
    if (pick(step, 1, 4 * most) == 0 && reference.size() > 0) {
      const std::uint32_t lowest = reference.lowest();
      const std::size_t count = 1 + pick(step, 6, most);
      const std::vector<std::uint32_t> items = pop(queue, count);
      ASSERT_EQ(items, reference.pop(count)) << "step " << step;
      ASSERT_EQ(queue.lowest(), lowest);
      for (const std::uint32_t item : items)
        in[item] = false;
    } else {
      const std::uint32_t item = pick(step, 2, kItems);
      if (in[item]) {
        queue.erase(item);
        reference.erase(item);
      } else {
        const float cost = cost_at(step);
        queue.push(item, cost);
        reference.push(item, cost);
      }
      in[item] = !in[item];
    }
    for (std::uint32_t item = 0; item < kItems; ++item) {
      if (queue.contains(item) != in[item])  // a macro for each would take most of the time
        FAIL() << "step " << step << ", item " << item << " is in: " << in[item];
    }
  }
}

TEST(CollapseQueueTest, DoesWhatAReferenceDoes) {
  for (const std::uint32_t most : {1U, 8U, 30U})
    do_what_a_reference_does(most, random_cost);
}

TEST(CollapseQueueTest, DoesWhatAReferenceDoesInThreeBuckets) {
  for (const std::uint32_t most : {1U, 8U, 30U})
    do_what_a_reference_does(
        most, [](std::uint64_t step) { return static_cast<float>(1U << pick(step, 7, 3)); });
}

}  // namespace
}  // namespace meshhier::cluster_simplify
