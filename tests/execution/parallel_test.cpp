#include "execution/parallel.h"

#include "base/error.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::execution {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Work that takes longer the smaller i is, so that later items are ready first.
std::size_t uneven_work(std::size_t i) {
  std::uint64_t state = i;
  for (std::size_t step = 0; step < (i % 7 == 0 ? 20000U : 10U); ++step)
    state = state * 6364136223846793005U + 1442695040888963407U;
  return i * 3 + (state == 1 ? 1 : 0);
}

TEST(ParallelForTest, RunsEachOnce) {
  std::vector<std::atomic<int>> runs(500);
  parallel_for(runs.size(), [&](std::size_t i) { ++runs[i]; });
  EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](int count) { return count == 1; }));
  parallel_for(0, [](std::size_t) { ADD_FAILURE(); });
}

TEST(ParallelForTest, AFailureIsThrownAgain) {
  const auto work = [](std::size_t i) {
    if (i == 50)
      throw Error(ErrorCode::io, "item 50");
  };
  EXPECT_THROW(parallel_for(1000, work), Error);
}

TEST(OrderedForTest, HandsEveryResultOnInOrder) {
  for (const std::size_t in_flight : {1U, 2U, 16U}) {
    std::vector<std::size_t> order;
    ordered_for(500, in_flight, CancelToken(), uneven_work, [&](std::size_t i, std::size_t result) {
      EXPECT_EQ(result, uneven_work(i));
      order.push_back(i);
    });
    std::vector<std::size_t> expected(500);
    std::iota(expected.begin(), expected.end(), std::size_t{0});
    EXPECT_EQ(order, expected);
  }
}

TEST(OrderedForTest, NothingToDoIsFine) {
  ordered_for(
      0, 4, CancelToken(), [](std::size_t) { return ADD_FAILURE(), 0; },
      [](std::size_t, int) { ADD_FAILURE(); });
}

TEST(OrderedForTest, KeepsNoMoreInFlightThanAllowed) {
  for (const int limit : {1, 3}) {
    std::atomic<int> alive{0};
    std::atomic<int> most{0};
    ordered_for(
        300, static_cast<std::size_t>(limit), CancelToken(),
        [&](std::size_t i) {
          const int now = ++alive;
          for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
          }
          return uneven_work(i);
        },
        [&](std::size_t, std::size_t) { --alive; });  // a result counts until it is handed on
    EXPECT_LE(most, limit);
    EXPECT_GE(most, 1);
  }
}

/// Counts how many there are.
class Counted {
 public:
  explicit Counted(std::atomic<int>& alive) : alive_(&alive) { ++*alive_; }
  Counted(Counted&& other) noexcept : alive_(other.alive_) { ++*alive_; }
  Counted& operator=(Counted&&) = delete;
  ~Counted() { --*alive_; }

 private:
  std::atomic<int>* alive_;
};

TEST(OrderedForTest, AFailureLeavesNoResultBehind) {
  for (std::size_t round = 0; round < 1000; ++round) {
    std::atomic<int> alive{0};
    const auto work = [&](std::size_t i) {
      if (i == round % 64)
        throw std::runtime_error("stop");
      return Counted(alive);
    };
    EXPECT_THROW(ordered_for(64, 8, CancelToken(), work, [](std::size_t, const Counted&) {}),
                 std::runtime_error);
    ASSERT_EQ(alive, 0) << round;
  }
}

TEST(OrderedForTest, OfSeveralFailuresTheFirstInOrderIsThrownBehindAllResultsBeforeIt) {
  std::vector<std::size_t> order;
  try {
    ordered_for(
        1000, 4, CancelToken(),
        [](std::size_t i) {
          if (i == 50)
            uneven_work(7);
          if (i >= 50)
            throw Error(ErrorCode::io, "item " + std::to_string(i));
          return i;
        },
        [&](std::size_t i, std::size_t) { order.push_back(i); });
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_STREQ(error.what(), "item 50");
  }
  ASSERT_EQ(order.size(), 50U);
  for (std::size_t i = 0; i < order.size(); ++i)
    EXPECT_EQ(order[i], i);
}

TEST(OrderedForTest, AFailureOfTheSinkEndsItAndIsThrownAgain) {
  std::size_t sunk = 0;
  EXPECT_THROW(ordered_for(
                   1000, 4, CancelToken(), [](std::size_t i) { return i; },
                   [&](std::size_t i, std::size_t) {
                     if (i == 20)
                       throw std::runtime_error("full");
                     ++sunk;
                   }),
               std::runtime_error);
  EXPECT_EQ(sunk, 20U);
}

TEST(OrderedForTest, ACancelledJobStopsSoon) {
  CancelToken cancel;
  std::atomic<std::size_t> started{0};
  try {
    ordered_for(
        100'000, 4, cancel,
        [&](std::size_t i) {
          ++started;
          if (i == 10)
            cancel.cancel();
          return i;
        },
        [](std::size_t, std::size_t) {});
    FAIL() << "the job ran to its end";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
  EXPECT_LE(started, 10U + 2 * 4U);  // those in flight, and those that had been let in by then
}

struct Number {
  std::size_t item = 0;
  std::size_t result = 0;
};

TEST(OrderedBlocksTest, ResultsComeInOrderWhateverTheSlots) {
  for (const std::size_t in_flight : {1U, 2U, 3U, 16U, 1000U}) {
    std::vector<std::size_t> results;
    ordered_blocks<Number>(
        500, in_flight, CancelToken(),
        [](std::uint64_t i, Number& slot) { slot.result = uneven_work(i); },
        [&](const Number& slot) {
          results.push_back(slot.result);
          return true;
        });
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < 500; ++i)
      expected.push_back(uneven_work(i));
    EXPECT_EQ(results, expected) << in_flight << " in flight";
  }
}

TEST(OrderedBlocksTest, SlotsAreUsedAgain) {
  std::size_t uses = 0;
  ordered_blocks<std::vector<int>>(
      100, 3, CancelToken(), [](std::uint64_t, std::vector<int>& slot) { slot.push_back(1); },
      [&](const std::vector<int>& slot) {
        EXPECT_EQ(slot.size(), uses++ / 3 + 1);
        return true;
      });
}

TEST(OrderedBlocksTest, TheSinkEndsIt) {
  std::size_t sunk = 0;
  ordered_blocks<int>(
      1000, 4, CancelToken(),
      [](std::uint64_t i, int&) {
        if (i > 20)
          throw std::runtime_error("behind the end");
      },
      [&](int) { return ++sunk <= 20; });
  EXPECT_EQ(sunk, 21U);
}

TEST(OrderedBlocksTest, OfSeveralFailuresTheFirstInOrderIsThrown) {
  for (int round = 0; round < 20; ++round) {
    std::size_t sunk = 0;
    try {
      ordered_blocks<int>(
          200, 8, CancelToken(),
          [](std::uint64_t i, int&) {
            if (i == 50)
              uneven_work(7);
            if (i >= 50)
              throw Error(ErrorCode::input, std::to_string(i));
          },
          [&](int) {
            ++sunk;
            return true;
          });
      FAIL() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "50");
    }
    EXPECT_EQ(sunk, 50U);
  }
}

TEST(OrderedBlocksTest, WhatFollowsASinkRunsForEachThatWasSunk) {
  for (const std::size_t in_flight : {1U, 3U, 16U}) {
    std::vector<std::atomic<int>> followed(500);
    std::size_t sunk = 0;
    ordered_blocks<std::size_t>(
        followed.size(), in_flight, CancelToken(),
        [](std::size_t i, std::size_t& slot) {
          uneven_work(i);
          slot = i;
        },
        [&](std::size_t slot) {
          EXPECT_EQ(slot, sunk++);
          EXPECT_EQ(followed[slot], 0);
          return sunk <= 400;
        },
        [&](std::size_t& slot) {
          uneven_work(slot);
          ++followed[slot];
        });
    EXPECT_EQ(sunk, 401U);
    for (std::size_t i = 0; i < followed.size(); ++i)
      EXPECT_EQ(followed[i], i <= 400 ? 1 : 0) << i;
  }
}

TEST(OrderedBlocksTest, OfFailuresInAllStepsTheFirstInOrderIsThrown) {
  for (int round = 0; round < 20; ++round) {
    const auto fail_at = [](std::size_t i, std::size_t at) {
      if (i == at)
        throw Error(ErrorCode::input, std::to_string(i));
    };
    try {
      ordered_blocks<std::size_t>(
          200, 8, CancelToken(),
          [&](std::size_t i, std::size_t& slot) {
            slot = i;
            fail_at(i, 52);
          },
          [&](std::size_t slot) {
            fail_at(slot, 51);
            return true;
          },
          [&](std::size_t& slot) {
            uneven_work(7);
            fail_at(slot, 50);
          });
      FAIL() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "50");
    }
  }
}

TEST(OrderedBlocksTest, ACancelledJobEnds) {
  CancelToken cancel;
  std::size_t sunk = 0;
  EXPECT_THROW(ordered_blocks<int>(
                   100'000, 4, cancel, [](std::uint64_t, int&) {},
                   [&](int) {
                     if (++sunk == 10)
                       cancel.cancel();
                     return true;
                   }),
               Error);
  EXPECT_LT(sunk, 100U);
}

TEST(OrderedReadBlocksTest, ReadsUntilNothingIsLeftAndHandsOnInOrder) {
  for (const std::size_t in_flight : {1U, 2U, 16U}) {
    for (const std::size_t count : {0U, 1U, 500U}) {
      std::size_t read = 0;
      std::vector<std::size_t> taken;
      ordered_read_blocks<std::size_t>(
          in_flight, CancelToken(),
          [&](std::size_t& slot) {
            slot = read;
            return read++ < count;
          },
          [](std::size_t& slot) { slot = uneven_work(slot); },
          [&](std::size_t slot) { taken.push_back(slot); });
      ASSERT_EQ(taken.size(), count);
      for (std::size_t i = 0; i < count; ++i)
        EXPECT_EQ(taken[i], uneven_work(i));
      EXPECT_EQ(read, count + 1) << "nothing is read behind the end";
    }
  }
}

TEST(OrderedReadBlocksTest, OfSeveralFailuresTheFirstInOrderIsThrownBehindAllResultsBeforeIt) {
  for (const char* failing : {"read", "work", "sink"}) {
    const std::string which = failing;
    std::vector<std::size_t> taken;
    std::size_t read = 0;
    const auto fail_if = [&](const char* what, std::size_t i, std::size_t at) {
      if (which == what && i >= at)
        throw Error(ErrorCode::io, std::to_string(i));
    };
    try {
      ordered_read_blocks<std::size_t>(
          8, CancelToken(),
          [&](std::size_t& slot) {
            fail_if("read", read, 60);
            slot = read++;
            return true;
          },
          [&](std::size_t& slot) {
            fail_if("work", slot, 60);
            uneven_work(slot);
          },
          [&](std::size_t slot) {
            fail_if("sink", slot, 60);
            taken.push_back(slot);
          });
      ADD_FAILURE() << which;
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), std::string("60")) << which;
    }
    EXPECT_EQ(taken.size(), 60U) << which;
  }
}

TEST(OrderedReadBlocksTest, ACancelledJobEnds) {
  CancelToken cancel;
  std::size_t read = 0;
  EXPECT_THROW(ordered_read_blocks<std::size_t>(
                   4, cancel,
                   [&](std::size_t&) {
                     if (++read == 100)
                       cancel.cancel();
                     return true;
                   },
                   [](std::size_t&) {}, [](std::size_t) {}),
               Error);
  EXPECT_LT(read, 200U);
}

TEST(BatchedWorkTest, HandsEveryResultOnInOrder) {
  for (const std::size_t batch : {1U, 2U, 7U, 1000U}) {
    std::vector<std::size_t> results;
    BatchedWork<Number> work(
        batch, [](Number& slot) { slot.result = uneven_work(slot.item); },
        [&](Number& slot) { results.push_back(slot.result); });
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < 100; ++i) {
      work.next().item = i;
      expected.push_back(uneven_work(i));
    }
    work.finish();
    EXPECT_EQ(results, expected) << "batches of " << batch;
  }
}

TEST(BatchedWorkTest, GathersNoMoreThanABatch) {
  std::vector<int> results;
  BatchedWork<int> work(
      3, [](int&) {}, [&](int& item) { results.push_back(item); });
  for (const int i : {1, 2, 3})
    work.next() = i;
  EXPECT_THAT(results, IsEmpty());
  work.next() = 4;
  EXPECT_THAT(results, ElementsAre(1, 2, 3));
  work.finish();
  work.finish();
  EXPECT_THAT(results, ElementsAre(1, 2, 3, 4));
}

TEST(BatchedWorkTest, WhatFollowsRunsForEachOnceItIsSunk) {
  std::vector<int> sunk;
  std::atomic<int> followed = 0;
  BatchedWork<int> work(
      3, [](int& slot) { slot *= 2; }, [&](int& slot) { sunk.push_back(slot); },
      [&](int& slot) { followed += slot; });
  for (int i = 0; i < 7; ++i)
    work.next() = i;
  EXPECT_EQ(followed, 2 * (0 + 1 + 2 + 3 + 4 + 5));
  work.finish();
  EXPECT_EQ(followed, 2 * 21);
  EXPECT_THAT(sunk, ElementsAre(0, 2, 4, 6, 8, 10, 12));
}

TEST(BatchedWorkTest, AFailureIsThrownAgain) {
  BatchedWork<int> work(
      4,
      [](int& item) {
        if (item == 2)
          throw Error(ErrorCode::input, "2");
      },
      [](int&) { ADD_FAILURE() << "a batch that failed was handed on"; });
  for (const int i : {0, 1, 2, 3})
    work.next() = i;
  EXPECT_THROW(work.next(), Error);
}

}  // namespace
}  // namespace meshhier::execution
