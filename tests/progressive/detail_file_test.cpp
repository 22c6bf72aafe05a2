#include "progressive/detail_file.h"

#include "base/error.h"
#include "storage/format/glb.h"
#include "storage/format/gzip.h"
#include "tests/support/error_message.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using progressive::DetailFileReader;
using testing::HasSubstr;
using DetailBytes = std::vector<std::byte>;

constexpr const char* kDetailName = "some/detail_03.bin";
constexpr std::uint32_t kStep = 3;
constexpr std::size_t kHeadSize = 16;
constexpr std::size_t kRunHeadSize = 12;
constexpr AttributeLayout kRich{true, ColourType::u16, true, true};

bool same_run(const DetailRun& a, const DetailRun& b) {
  if (a.index() != b.index())
    return false;
  if (const auto* vertices = std::get_if<VertexRun>(&a)) {
    const VertexRun& other = std::get<VertexRun>(b);
    return vertices->indices == other.indices && vertices->residuals == other.residuals;
  }
  if (const auto* triangles = std::get_if<TriangleRun>(&a)) {
    const TriangleRun& other = std::get<TriangleRun>(b);
    return triangles->indices == other.indices && triangles->corners == other.corners;
  }
  const MergeRun &merges = std::get<MergeRun>(a), &other = std::get<MergeRun>(b);
  return merges.indices == other.indices && merges.targets == other.targets;
}

bool same_runs(const std::vector<DetailRun>& a, const std::vector<DetailRun>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_run);
}

/// As the writer makes it: indices of a list go on from run to run.
DetailBytes encode(const std::vector<DetailRun>& runs, const AttributeLayout& layout) {
  DetailBytes bytes = progressive::detail_head(kStep);
  std::array<std::uint64_t, 3> first{};
  for (const DetailRun& run : runs) {
    const DetailBytes more = progressive::encode_run(run, layout, first[run.index()]);
    bytes.insert(bytes.end(), more.begin(), more.end());
    first[run.index()] =
        std::visit([](const auto& list) { return std::uint64_t{list.indices.back()} + 1; }, run);
  }
  return bytes;
}

std::vector<DetailRun> decode(std::span<const std::byte> bytes, const AttributeLayout& layout) {
  progressive::DetailFileReader reader(bytes, kStep, layout, kDetailName);
  std::vector<DetailRun> runs;
  while (std::optional<DetailRun> run = reader.next())
    runs.push_back(std::move(*run));
  return runs;
}

/// Returns the message that refuses the bytes; empty if they are not refused.
std::string refused(std::span<const std::byte> bytes, const AttributeLayout& layout = {}) {
  return tests::error_message(
      ErrorCode::corrupt, [&] { decode(bytes, layout); }, std::string(kDetailName) + ": ");
}

/// Ascending numbers up to `most`, the last of which is `most` itself.
template <class Index>
std::vector<Index> some_indices(std::mt19937_64& random, std::size_t count, std::uint64_t most) {
  std::vector<Index> indices;
  const std::uint64_t step = most / count;
  for (std::size_t i = 0; i + 1 < count; ++i)
    indices.push_back(static_cast<Index>(i * step + random() % step));
  indices.push_back(static_cast<Index>(most));
  return indices;
}

std::uint32_t any_number(std::mt19937_64& random) {
  const std::uint64_t bits = random();
  const auto number = static_cast<std::uint32_t>(bits >> 32);
  return (bits & 7) == 0 ? 0 : (bits & 7) == 1 ? UINT32_MAX : number;
}

VertexRun some_vertices(std::mt19937_64& random, std::size_t count, std::uint32_t most,
                        const AttributeLayout& layout) {
  VertexRun run{some_indices<std::uint32_t>(random, count, most), {}};
  for (std::size_t i = 0; i < count; ++i) {
    for (int value = 0; value < vertex_values(layout); ++value)
      run.residuals.push_back(any_number(random) >> (32 - 8 * value_bytes(layout, value)));
  }
  return run;
}

TriangleRun some_triangles(std::mt19937_64& random, std::size_t count, std::uint64_t most) {
  TriangleRun run{some_indices<std::uint64_t>(random, count, most), {}};
  for (std::size_t i = 0; i < count; ++i)
    run.corners.push_back({any_number(random), any_number(random), any_number(random)});
  return run;
}

MergeRun some_merges(std::mt19937_64& random, std::size_t count, std::uint32_t most) {
  MergeRun run{some_indices<std::uint32_t>(random, count, most), {}};
  for (std::size_t i = 0; i < count; ++i)
    run.targets.push_back(any_number(random));
  return run;
}

/// Each list in two runs, up to the largest index that it can have.
std::vector<DetailRun> some_runs(std::uint64_t seed, std::size_t count,
                                 const AttributeLayout& layout) {
  std::mt19937_64 random(seed);
  std::vector<DetailRun> runs;
  runs.emplace_back(some_vertices(random, count, 1U << 30, layout));
  runs.emplace_back(VertexRun{
      {UINT32_MAX}, std::vector<std::uint32_t>(static_cast<std::size_t>(vertex_values(layout)))});
  runs.emplace_back(some_triangles(random, count, std::uint64_t{1} << 50));
  runs.emplace_back(TriangleRun{{INT64_MAX}, {{0, UINT32_MAX, 0}}});
  runs.emplace_back(some_merges(random, count, 1U << 31));
  runs.emplace_back(MergeRun{{UINT32_MAX}, {0}});
  return runs;
}

TEST(DetailFile, RunsOfAnySizeComeBack) {
  for (const AttributeLayout& layout : {AttributeLayout{}, kRich}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
      for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const std::vector<DetailRun> runs = some_runs(seed, count, layout);
        EXPECT_TRUE(same_runs(decode(encode(runs, layout), layout), runs)) << count;
      }
    }
  }
  const std::vector<DetailRun> runs = some_runs(1, kRunEntries, kRich);
  EXPECT_TRUE(same_runs(decode(encode(runs, kRich), kRich), runs));
}

TEST(DetailFile, AFileOfNothingIsItsHead) {
  EXPECT_EQ(encode({}, {}).size(), kHeadSize);
  EXPECT_TRUE(decode(encode({}, {}), {}).empty());
}

TEST(DetailFile, IndicesBeginWithEachListAnew) {
  const std::vector<DetailRun> runs = {VertexRun{{0, 1}, std::vector<std::uint32_t>(6)},
                                       VertexRun{{2}, std::vector<std::uint32_t>(3)},
                                       TriangleRun{{0}, {{1, 2, 3}}}, MergeRun{{0}, {9}}};
  EXPECT_TRUE(same_runs(decode(encode(runs, {}), {}), runs));
}

TEST(DetailFile, SmallNumbersTakeFewBytes) {
  VertexRun run{{}, std::vector<std::uint32_t>(3000)};
  TriangleRun triangles;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    run.indices.push_back(i);
    triangles.indices.push_back(i);
    triangles.corners.push_back({i, i + 1, i + 2});
  }
  EXPECT_LT(encode({run, triangles}, {}).size(), 300U);
}

TEST(DetailFile, SANITIZED_EveryTruncationIsRefusedOrEndsBetweenRuns) {
  const std::vector<DetailRun> runs = some_runs(3, 5, kRich);
  const DetailBytes bytes = encode(runs, kRich);
  std::size_t whole = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto part = std::span(bytes).first(size);
    if (!refused(part, kRich).empty())
      continue;
    // The index tells the size: the file itself may end behind any run.
    const std::vector<DetailRun> found = decode(part, kRich);
    EXPECT_TRUE(same_runs(found, {runs.begin(), runs.begin() + std::ssize(found)})) << size;
    ++whole;
  }
  EXPECT_EQ(whole, runs.size());
}

TEST(DetailFile, SANITIZED_EveryFlippedBitIsRefusedOrChangesNothing) {
  const std::vector<DetailRun> runs = some_runs(4, 3, {});
  DetailBytes bytes = encode(runs, {});
  std::size_t unnoticed = 0;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const std::byte mask = std::byte{1} << static_cast<int>(bit % 8);
    bytes[bit / 8] ^= mask;
    if (refused(bytes).empty()) {
      // gzip's time, system and level, and a list 2 that is called a list 3, or the like, which the
      // checksum in the index is for.
      const std::size_t within = bit / 8;
      EXPECT_GE(within, kHeadSize) << "a bit of the head";
      ++unnoticed;
    }
    bytes[bit / 8] ^= mask;
  }
  EXPECT_LT(unnoticed, bytes.size()) << "of " << 8 * bytes.size();
}

/// One run with a number of its head changed.
DetailBytes with_head(std::size_t offset, std::uint32_t value) {
  DetailBytes bytes = encode({MergeRun{{3, 4}, {1, 2}}}, {});
  storage::store_little(value, bytes.data() + kHeadSize + offset);
  return bytes;
}

/// A run whose gzip member has these bytes.
DetailBytes with_content(std::uint32_t list, std::uint32_t entries, const DetailBytes& content) {
  DetailBytes bytes = progressive::detail_head(kStep);
  const DetailBytes packed = storage::gzip(content);
  storage::append_little(bytes, list);
  storage::append_little(bytes, entries);
  storage::append_little(bytes, static_cast<std::uint32_t>(packed.size()));
  bytes.insert(bytes.end(), packed.begin(), packed.end());
  return bytes;
}

DetailBytes content(std::initializer_list<int> values) {
  DetailBytes bytes;
  for (const int value : values)
    bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(DetailFile, SANITIZED_AnotherStepOrFormatIsRefused) {
  const DetailBytes good = encode({}, {});
  for (std::size_t i = 0; i < kHeadSize; ++i) {
    DetailBytes bytes = good;
    bytes[i] ^= std::byte{1};
    EXPECT_THAT(refused(bytes), HasSubstr(i < 8    ? "is no file of a progressive stream"
                                          : i < 12 ? "expected 1"
                                                   : "does not start as the file of step 3"));
  }
  EXPECT_THAT(refused({}), HasSubstr("is no file of a progressive stream"));
}

TEST(DetailFile, SANITIZED_ANewerVersionIsRefusedByItsNumber) {
  DetailBytes bytes = encode({}, {});
  bytes[8] = std::byte{2};
  EXPECT_THAT(refused(bytes), HasSubstr("version is 2, expected 1 (written by a newer meshhier)"));
}

TEST(DetailFile, SANITIZED_WrongRunHeadsAreNamed) {
  EXPECT_EQ(refused(with_head(0, 3)), "");
  EXPECT_THAT(refused(with_head(0, 0)), HasSubstr("byte 16: list is 0, expected 1 to 3"));
  EXPECT_THAT(refused(with_head(0, 4)), HasSubstr("list is 4, expected 1 to 3"));
  EXPECT_THAT(refused(with_head(4, 0)), HasSubstr("a run of 0 entries, expected 1 to 65536"));
  EXPECT_THAT(refused(with_head(4, 65537)), HasSubstr("a run of 65537 entries"));
  EXPECT_THAT(refused(with_head(4, UINT32_MAX)), HasSubstr("a run of 4294967295 entries"));
  EXPECT_THAT(refused(with_head(8, UINT32_MAX)), HasSubstr("a run is cut"));
  EXPECT_THAT(refused(with_head(8, 0)), HasSubstr("no gzip stream"));
}

TEST(DetailFile, ListsComeInTheirOrder) {
  DetailBytes bytes = encode({MergeRun{{3}, {1}}}, {});
  const DetailBytes more = progressive::encode_run(TriangleRun{{0}, {{1, 2, 3}}}, {}, 0);
  bytes.insert(bytes.end(), more.begin(), more.end());
  EXPECT_THAT(refused(bytes), HasSubstr("list is 2, expected 3 to 3"));
}

TEST(DetailFile, SANITIZED_EntriesThatAreNotThereAreRefused) {
  EXPECT_EQ(refused(with_content(3, 1, content({5, 0}))), "");
  EXPECT_THAT(refused(with_content(3, 2, content({5, 0}))), HasSubstr("ends within its entries"));
  EXPECT_THAT(refused(with_content(1, 1, content({5, 0, 0}))),
              HasSubstr("ends within its entries"));
  EXPECT_THAT(refused(with_content(3, 1, content({5, 128}))), HasSubstr("ends within its entries"));
  EXPECT_THAT(refused(with_content(3, 1, content({5, 0, 0}))), HasSubstr("1 bytes are left"));
  EXPECT_THAT(refused(with_content(3, 1, DetailBytes(11))), HasSubstr("goes on after"));
}

TEST(DetailFile, SANITIZED_NumbersThatAreTooLargeAreRefused) {
  const DetailBytes at_most = content({0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 0});  // 2^32 - 1
  EXPECT_EQ(refused(with_content(3, 1, at_most)), "");
  EXPECT_THAT(refused(with_content(3, 1, content({0x80, 0x80, 0x80, 0x80, 0x10, 0}))),
              HasSubstr("an index that is too large"));
  EXPECT_THAT(refused(with_content(3, 2, content({0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 0, 0, 0}))),
              HasSubstr("an index that is too large"));
  const DetailBytes last = content({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F, 0, 0, 0});
  EXPECT_EQ(refused(with_content(2, 1, last)), "");
  EXPECT_THAT(refused(with_content(
                  2, 1, content({0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0, 0, 0}))),
              HasSubstr("more than 63 bits"));
  // Below 0, and above 2^32 - 1.
  EXPECT_EQ(refused(with_content(3, 1, content({5, 9}))), "");
  EXPECT_THAT(refused(with_content(3, 1, content({5, 11}))),
              HasSubstr("a vertex that is no number of 32 bits"));
  EXPECT_THAT(refused(with_content(3, 1, content({5, 0x80, 0x80, 0x80, 0x80, 0x20}))),
              HasSubstr("a vertex that is no number of 32 bits"));
}

TEST(DetailFile, TheMessageTellsWhere) {
  DetailBytes bytes = encode({MergeRun{{3}, {1}}}, {});
  const std::size_t end = bytes.size();
  bytes.resize(end + kRunHeadSize - 1);
  EXPECT_THAT(refused(bytes), HasSubstr("byte " + std::to_string(end) + ": a run is cut"));
}

}  // namespace
}  // namespace meshhier::tests
