#include "partition/external_sort.h"

#include "storage/io/file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

namespace meshhier::partition {
namespace {

struct Item {
  std::uint32_t key;
  std::uint32_t payload;
  friend bool operator==(const Item&, const Item&) = default;
};

struct ItemKey {
  std::uint32_t operator()(const Item& item) const { return item.key; }
};

std::uint64_t next_random(std::uint64_t& state) {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return state >> 33;
}

std::vector<Item> random_items(std::size_t count, std::uint32_t keys) {
  std::vector<Item> items(count);
  std::uint64_t state = count + keys;
  for (Item& item : items) {
    item.key = static_cast<std::uint32_t>(next_random(state) % keys);
    item.payload = static_cast<std::uint32_t>(next_random(state) % 1000);
  }
  return items;
}

/// The order that the header promises: by key, then by bytes.
bool before(const Item& a, const Item& b) {
  return a.key != b.key ? a.key < b.key : std::memcmp(&a, &b, sizeof(Item)) < 0;
}

class ExternalSortTest : public testing::Test {
 protected:
  using Sort = ExternalSort<Item, ItemKey>;

  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("external_sort_") + info.name() + std::to_string(::getpid()));
  }

  /// Sorts with so much memory; the spools may hold `pool_bytes` in memory.
  std::vector<Item> sort(const std::vector<Item>& items, std::uint64_t memory_bytes,
                         std::uint64_t pool_bytes = 0) {
    storage::MemoryPool pool(pool_bytes);
    storage::ScratchFile scratch(*files_, path_, pool);
    Sort sorter(scratch, memory_bytes);
    for (std::size_t i = 0; i < items.size(); i += 1000) {
      sorter.add(std::span(items).subspan(i, std::min<std::size_t>(1000, items.size() - i)));
    }
    EXPECT_EQ(sorter.size(), items.size());
    sorter.sort();
    std::vector<Item> result;
    sorter.for_each_block([&](std::span<const Item> block) {
      largest_block_ = std::max(largest_block_, block.size_bytes());
      result.insert(result.end(), block.begin(), block.end());
    });
    EXPECT_TRUE(sorter.next_block().empty());
    spilled_bytes_ = sorter.spilled_bytes();
    scratch_bytes_ = scratch.size();
    return result;
  }

  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::filesystem::path path_;
  std::uint64_t spilled_bytes_ = 0, scratch_bytes_ = 0;
  std::size_t largest_block_ = 0;
};

TEST_F(ExternalSortTest, NothingAndOneRecord) {
  EXPECT_TRUE(sort({}, 1 << 20).empty());
  const std::vector<Item> one = {{7, 8}};
  EXPECT_EQ(sort(one, 1 << 20), one);
}

TEST_F(ExternalSortTest, InMemoryNothingIsSpilled) {
  std::vector<Item> items = random_items(100'000, 5000);
  const std::vector<Item> sorted = sort(items, 1 << 20);
  EXPECT_EQ(spilled_bytes_, 0u);
  EXPECT_FALSE(std::filesystem::exists(path_));
  std::sort(items.begin(), items.end(), before);
  EXPECT_EQ(sorted, items);
}

TEST_F(ExternalSortTest, SpilledOnceWhenOneMergeSuffices) {
  std::vector<Item> items = random_items(100'000, 5000);  // 800 kB in 256 kB: 4 runs
  const std::vector<Item> sorted = sort(items, 1 << 18);
  EXPECT_EQ(spilled_bytes_, items.size() * sizeof(Item));
  EXPECT_GT(scratch_bytes_, 0u);
  EXPECT_LE(largest_block_, 1u << 18);
  std::sort(items.begin(), items.end(), before);
  EXPECT_EQ(sorted, items);
}

TEST_F(ExternalSortTest, MoreRunsThanOneMergeTakes) {
  std::vector<Item> items =
      random_items(400'000, 1u << 31);  // 3.2 MB in 64 kB: 56 runs, 13 at once
  const std::vector<Item> sorted = sort(items, 1 << 16);
  EXPECT_GT(spilled_bytes_, items.size() * sizeof(Item));
  EXPECT_LT(spilled_bytes_, 2 * items.size() * sizeof(Item));  // only the excess goes twice
  std::sort(items.begin(), items.end(), before);
  EXPECT_EQ(sorted, items);
}

TEST_F(ExternalSortTest, SeveralMergePasses) {
  std::vector<Item> items =
      random_items(2'000'000, 1u << 31);  // 280 runs, 13 at once: three levels
  const std::vector<Item> sorted = sort(items, 1 << 16);
  EXPECT_GT(spilled_bytes_, 2 * items.size() * sizeof(Item));
  EXPECT_LE(spilled_bytes_, 3 * items.size() * sizeof(Item));
  std::sort(items.begin(), items.end(), before);
  EXPECT_EQ(sorted, items);
}

TEST_F(ExternalSortTest, EqualKeysComeInTheSameOrderForEveryMemoryThreadCountAndArrival) {
  std::vector<Item> items = random_items(60'000, 3);
  const std::vector<Item> expected = sort(items, 1 << 24);
  for (const std::uint64_t memory : {1u << 16, 100'000u, 1u << 18}) {
    for (const std::size_t threads : {1u, 2u, 5u}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_EQ(sort(items, memory), expected) << memory << " bytes, " << threads << " threads";
    }
  }
  std::reverse(items.begin(), items.end());
  EXPECT_EQ(sort(items, 1 << 16), expected);
}

TEST_F(ExternalSortTest, ThePoolDecidesOnlyWhatTouchesTheDisk) {
  const std::vector<Item> items = random_items(100'000, 5000);
  const std::vector<Item> on_disk = sort(items, 1 << 16);
  EXPECT_GT(scratch_bytes_, 0u);
  EXPECT_EQ(sort(items, 1 << 16, 1 << 24), on_disk);
  EXPECT_EQ(scratch_bytes_, 0u);
  EXPECT_GT(spilled_bytes_, 0u);
}

TEST_F(ExternalSortTest, AlreadySortedAndReversedInput) {
  std::vector<Item> items = random_items(50'000, 1000);
  std::sort(items.begin(), items.end(), before);
  EXPECT_EQ(sort(items, 1 << 16), items);
  std::vector<Item> reversed(items.rbegin(), items.rend());
  EXPECT_EQ(sort(reversed, 1 << 16), items);
}

TEST_F(ExternalSortTest, RecordsOfAnOddSizeAddedOneByOne) {
  using Odd = std::array<std::uint8_t, 7>;
  const auto key_of = [](const Odd& odd) { return odd[3]; };
  storage::MemoryPool pool(0);
  storage::ScratchFile scratch(*files_, path_, pool);
  ExternalSort<Odd, decltype(key_of)> sorter(scratch, 1 << 16, key_of);
  std::vector<Odd> expected;
  std::uint64_t state = 1;
  for (int i = 0; i < 50'000; ++i) {
    Odd odd;
    for (std::uint8_t& byte : odd)
      byte = static_cast<std::uint8_t>(next_random(state));
    expected.push_back(odd);
    sorter.add(odd);
  }
  sorter.sort();
  std::vector<Odd> sorted;
  sorter.for_each_block(
      [&](std::span<const Odd> block) { sorted.insert(sorted.end(), block.begin(), block.end()); });
  EXPECT_GT(sorter.spilled_bytes(), 0u);
  std::sort(expected.begin(), expected.end(),
            [](const Odd& a, const Odd& b) { return a[3] != b[3] ? a[3] < b[3] : a < b; });
  EXPECT_EQ(sorted, expected);
}

}  // namespace
}  // namespace meshhier::partition
