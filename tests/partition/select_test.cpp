#include "partition/select.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

// The least memory granted holds 65536 keys: so many make several passes necessary.
constexpr std::size_t kMany = 200000;

/// A source that counts how often it is read.
struct Source {
  std::vector<SplitKey> keys;
  std::size_t block = 4096;
  int reads = 0;

  KeySource visit() {
    return [this](const std::function<void(std::span<const SplitKey>)>& use) {
      ++reads;
      for (std::size_t at = 0; at < keys.size(); at += block)
        use(std::span(keys).subspan(at, std::min(block, keys.size() - at)));
    };
  }
};

/// Keys of these values in a scattered order; ids are distinct and scattered too.
template <class Value>
Source source_of(std::size_t count, const Value& value) {
  Source source;
  for (std::size_t i = 0; i < count; ++i) {
    const auto id = static_cast<std::uint32_t>(i * 2654435761U);  // odd: a bijection
    source.keys.push_back({ordered_bits(value(i)), id});
  }
  std::shuffle(source.keys.begin(), source.keys.end(), std::mt19937(3));
  return source;
}

void expect_selected(Source source, std::uint64_t memory, const std::string& what) {
  std::vector<SplitKey> sorted = source.keys;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  for (const std::size_t k : {std::size_t{0}, std::size_t{1} % n, n / 3, n / 2, n - 1}) {
    source.reads = 0;
    EXPECT_EQ(select(source.visit(), n, k, memory), sorted[k]) << what << ", k " << k;
    EXPECT_LE(source.reads, 7) << what << ", k " << k;
  }
}

double number(std::size_t i, std::uint64_t stream = 0) {
  return tests::hash_noise(i, stream);
}

TEST(Select, FindsWhatSortingFindsInEveryDistribution) {
  constexpr double kTiny = std::numeric_limits<double>::denorm_min();
  constexpr double kHuge = std::numeric_limits<double>::max();
  const auto check = [](const std::string& what, const auto& value) {
    expect_selected(source_of(kMany, value), 0, what);
  };
  check("even", [](std::size_t i) { return number(i); });
  check("far from zero", [](std::size_t i) { return 1e6 + number(i); });
  check("negative", [](std::size_t i) { return -5 + number(i); });
  check("all equal", [](std::size_t) { return 0.1; });
  check("two values", [](std::size_t i) { return i % 3 == 0 ? -1.0 : 1.0; });
  check("zeros of both signs", [](std::size_t i) { return i % 2 == 0 ? -0.0 : 0.0; });
  check("denormal", [&](std::size_t i) { return kTiny * std::floor(1e5 * number(i)); });
  check("huge", [&](std::size_t i) { return kHuge * number(i); });
  check("every size", [](std::size_t i) { return std::ldexp(number(i), int(i % 2000) - 1000); });
  check("one apart", [](std::size_t i) { return i == 777 ? 1.0 : 1.0 + 1e-15; });
  check("neighbours", [](std::size_t i) { return 1 + std::ldexp(double(i / 2), -52); });
  check("half in one", [](std::size_t i) { return i % 2 == 0 ? number(i) : 0.25; });
}

TEST(Select, FindsTheSameForEveryMemoryAndBlock) {
  Source source = source_of(kMany, [](std::size_t i) { return std::round(50 * number(i)); });
  std::vector<SplitKey> sorted = source.keys;
  std::sort(sorted.begin(), sorted.end());
  for (const std::uint64_t memory : {0ULL, 1ULL << 20, 3ULL << 19, 1ULL << 22, 1ULL << 40}) {
    for (const std::size_t block : {1U, 1000U, 1000000U}) {
      source.block = block;
      EXPECT_EQ(select(source.visit(), kMany, 12345, memory), sorted[12345]) << memory;
    }
  }
}

TEST(Select, OfFewKeysEveryOneIsFound) {
  for (const std::size_t n : {1U, 2U, 3U, 100U}) {
    Source source = source_of(n, [](std::size_t i) { return std::round(3 * number(i)); });
    std::vector<SplitKey> sorted = source.keys;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 0; k < n; ++k)
      EXPECT_EQ(select(source.visit(), n, k, 0), sorted[k]);
  }
}

TEST(Select, ReadsTheSourceOnceIfAllFits) {
  Source source = source_of(kMany, [](std::size_t i) { return number(i); });
  (void)select(source.visit(), kMany, kMany / 2, kMany * sizeof(SplitKey));
  EXPECT_EQ(source.reads, 1);
  source.reads = 0;
  (void)select(source.visit(), kMany, kMany / 2, kMany * sizeof(SplitKey) - 1);
  EXPECT_GT(source.reads, 1);
}

TEST(Select, TellsEqualProjectionsApartByIdsAtBothEnds) {
  Source source;
  for (std::uint32_t i = 0; i < 70000; ++i) {
    source.keys.push_back({ordered_bits(1.0), i});
    source.keys.push_back({ordered_bits(1.0), 0xffffffff - i});
  }
  expect_selected(source, 0, "ids");
}

TEST(Select, TakesTheExtremeKeys) {
  Source source;
  for (std::uint32_t i = 0; i < 70000; ++i) {
    source.keys.push_back({0, i});
    source.keys.push_back({std::numeric_limits<std::uint64_t>::max(), 0xffffffff - i});
  }
  expect_selected(source, 0, "extremes");
}

TEST(SplitKeys, AreOrderedLikeTheNumbers) {
  const std::vector<double> ascending{-std::numeric_limits<double>::max(),
                                      -1e10,
                                      -1.0000000000000002,
                                      -1,
                                      -std::numeric_limits<double>::min(),
                                      -std::numeric_limits<double>::denorm_min(),
                                      0,
                                      std::numeric_limits<double>::denorm_min(),
                                      std::numeric_limits<double>::min(),
                                      1,
                                      1.0000000000000002,
                                      1e10,
                                      std::numeric_limits<double>::max()};
  for (std::size_t i = 1; i < ascending.size(); ++i)
    EXPECT_LT(ordered_bits(ascending[i - 1]), ordered_bits(ascending[i])) << ascending[i];
  EXPECT_EQ(ordered_bits(-0.0), ordered_bits(0.0));
}

TEST(SplitKeys, BreakTiesById) {
  const Vec3d x{1, 0, 0};
  EXPECT_LT(key_along(x, {1, 5, 5}, 3), key_along(x, {1, -5, 9}, 4));
  EXPECT_LT(key_along(x, {1, 0, 0}, 9), key_along(x, {1.0000001F, 0, 0}, 4));
  EXPECT_LE(SplitKey::lowest(), key_along(x, {-std::numeric_limits<float>::max(), 0, 0}, 0));
  EXPECT_GE(SplitKey::highest(),
            key_along(x, {std::numeric_limits<float>::max(), 0, 0}, 0xffffffff));
}

TEST(SplitKeys, APlanesOwnVertexIsOnItsRight) {
  const Vec3d direction{0.6, 0.8, 0};
  const SplitPlane plane{direction, key_along(direction, {1, 2, 3}, 10)};
  EXPECT_TRUE(plane.is_right({1, 2, 3}, 10));
  EXPECT_TRUE(plane.is_right({1, 2, 3}, 11));
  EXPECT_FALSE(plane.is_right({1, 2, 3}, 9));
  EXPECT_FALSE(plane.is_right({0, 2, 3}, 99));
}

}  // namespace
}  // namespace meshhier::partition
