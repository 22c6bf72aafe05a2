#include "partition/rank_table.h"

#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

constexpr std::uint32_t kVertices = 30'000;
constexpr std::uint64_t kRoomy = 1 << 20;
constexpr std::uint64_t kTight = 64 << 10;  ///< less than the table has bytes

using Corner = std::pair<std::uint32_t, std::uint32_t>;  ///< rank and wedge
using RankedTriangle = Triangle<Corner>;
using CopyRecords = std::vector<CopyVertex>;

/// No two ids have the same.
WedgeRank rank_of(std::uint32_t id) {
  return {static_cast<std::uint32_t>(id * 0x9E3779B97F4A7C15U), 0};
}

class RankTableTest : public testing::Test {
 protected:
  /// The ranks of vertices, by their ids; `taken`: the ranks of copies, as they were handed out.
  struct Table {
    std::vector<RankedTriangle> triangles;
    std::vector<std::uint32_t> taken;
  };

  /// Vertices come in blocks of this many.
  static constexpr std::uint32_t kBlock = 7000;

  Table table(const CopyRecords& copies, std::uint64_t memory_bytes) {
    storage::ScratchFile scratch(*files_, directory_.path() / "scratch", pool_);
    RankTable<WedgeRank> table(kVertices, memory_bytes, scratch);
    fill(table, copies);
    Table result;
    table.settle([&](const auto& visit) { std::ranges::for_each(copies, visit); },
                 [&](std::uint32_t rank) { result.taken.push_back(rank); });
    result.triangles = translated(table.renumberer());
    return result;
  }

  static void fill(RankTable<WedgeRank>& table, std::span<const CopyVertex> copies) {
    for (std::uint32_t first = 0; first < kVertices; first += kBlock) {
      const std::uint32_t end = std::min(first + kBlock, kVertices);
      const auto behind = std::ranges::lower_bound(copies, end, {}, &CopyVertex::id);
      const auto here = copies.first(static_cast<std::size_t>(behind - copies.begin()));
      std::vector<WedgeRank> ranks;
      for (std::uint32_t id = first; id < end; ++id) {
        if (!std::ranges::binary_search(here, id, {}, &CopyVertex::id))
          ranks.push_back(rank_of(id));
      }
      table.is_in_memory() ? table.put(ranks, first, here) : table.append(ranks, first, here);
      copies = copies.subspan(here.size());
    }
  }

  /// Each vertex is a corner of three of them, far apart in the table.
  static std::vector<Triangle<std::uint32_t>> triangles() {
    std::vector<Triangle<std::uint32_t>> all;
    for (std::uint32_t id = 0; id < kVertices; ++id)
      all.push_back({id, (id + kVertices / 3) % kVertices, kVertices - 1 - id});
    return all;
  }

  static std::vector<RankedTriangle> translated(Renumberer<WedgeRank> renumberer) {
    std::vector<RankedTriangle> result;
    Renumbered<WedgeRank> part;
    const auto take = [&] {
      renumberer.keep(part);
      for (const auto& [a, b, c] : part.finished)
        result.push_back({Corner{a.rank, a.wedge}, {b.rank, b.wedge}, {c.rank, c.wedge}});
    };
    renumberer.translate(std::span<const Triangle<std::uint32_t>>(triangles()), part);
    take();
    while (renumberer.next_round()) {
      for (std::uint64_t batch = 0; batch < renumberer.batches(); ++batch) {
        renumberer.translate_batch(batch, part);
        take();
      }
    }
    std::ranges::sort(result);
    return result;
  }

  static Table expected(const CopyRecords& copies) {
    std::vector<Corner> of;
    for (std::uint32_t id = 0; id < kVertices; ++id)
      of.emplace_back(rank_of(id).rank, 0);
    Table result;
    for (const CopyVertex& copy : copies) {
      of[copy.id] = {rank_of(copy.first).rank, copy.slot};
      result.taken.push_back(rank_of(copy.first).rank);
    }
    for (const Triangle<std::uint32_t>& t : triangles())
      result.triangles.push_back({of[t[0]], of[t[1]], of[t[2]]});
    std::ranges::sort(result.triangles);
    return result;
  }

  void expect_table(const CopyRecords& copies) {
    const Table wanted = expected(copies);
    for (const std::uint64_t memory_bytes : {kRoomy, kTight}) {
      SCOPED_TRACE(memory_bytes);
      const Table found = table(copies, memory_bytes);
      EXPECT_TRUE(found.triangles == wanted.triangles);
      EXPECT_TRUE(found.taken == wanted.taken) << found.taken.size() << " copies";
    }
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
};

TEST_F(RankTableTest, BothWaysAreTried) {
  EXPECT_EQ(plan_renumbering(kVertices, sizeof(WedgeRank), kRoomy).blocks, 1U);
  EXPECT_GT(plan_renumbering(kVertices, sizeof(WedgeRank), kTight).blocks, 2U);
}

TEST_F(RankTableTest, VerticesAtTheirOwnPlacesKeepTheirRanks) {
  expect_table({});
}

TEST_F(RankTableTest, ACopyHasTheRankOfItsPlaceWhereverItIs) {
  expect_table({{kBlock, 0, 1}});
  expect_table({{1, 0, 1}, {kBlock - 1, 0, 2}, {kBlock, 2, 1}, {kVertices - 1, kBlock + 1, 1}});
}

TEST_F(RankTableTest, ManyCopies) {
  // At random, all places but a few have some.
  CopyRecords copies;
  std::vector<std::uint32_t> firsts, slots(kVertices);
  for (std::uint32_t id = 0; id < kVertices; ++id) {
    const auto any = static_cast<std::size_t>((tests::hash_noise(id, 5) + 1) / 2 *
                                              static_cast<float>(firsts.size()));
    if (id % 4 == 0)
      firsts.push_back(id);
    else
      copies.push_back({id, firsts[any], ++slots[firsts[any]]});
  }
  expect_table(copies);
}

TEST_F(RankTableTest, AllAtOnePlace) {
  CopyRecords copies;
  for (std::uint32_t id = 1; id < kVertices; ++id)
    copies.push_back({id, 0, id});
  expect_table(copies);
}

}  // namespace
}  // namespace meshhier::partition
