// Which vertices lie where an earlier one does, against a map that holds all positions.
#include "import/find_copies.h"

#include "base/error.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_writer.h"
#include "tests/support/memory_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {

bool operator==(const CopyVertex& a, const CopyVertex& b) {
  return a.id == b.id && a.first == b.first && a.slot == b.slot;
}
void PrintTo(const CopyVertex& copy, std::ostream* out) {
  *out << fmt::format("{} at {}, {}", copy.id, copy.first, copy.slot);
}

namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using PositionList = std::vector<Vec3d>;
using CopyRecords = std::vector<CopyVertex>;

// ---- lists ---------------------------------------------------------------------------------

class CopyListTest : public testing::Test {
 protected:
  /// Vertex 0 lies at its own place, and so do all that are not named.
  CopyList list_of(const std::vector<std::uint32_t>& ids) {
    CopyList list(scratch_);
    std::uint32_t slot = 0;
    for (const std::uint32_t id : ids)
      list.append({id, 0, ++slot});
    return list;
  }
  static std::vector<std::uint32_t> ids(const CopyList& list, std::uint64_t first,
                                        std::uint64_t count) {
    std::vector<CopyVertex> memory;
    std::vector<std::uint32_t> result;
    for (const CopyVertex& copy : list.read(first, count, memory))
      result.push_back(copy.id);
    return result;
  }

  tests::MemoryFiles files_;
  storage::MemoryPool pool_{0};
  storage::ScratchFile scratch_{files_, "scratch", pool_};
};

TEST_F(CopyListTest, AnEmptyOneHoldsNothing) {
  for (const CopyList& list : {CopyList(), CopyList(scratch_)}) {
    EXPECT_TRUE(list.empty());
    EXPECT_EQ(list.count(), 0U);
    EXPECT_THAT(ids(list, 0, 1'000'000), IsEmpty());
    CopyCursor cursor(list);
    EXPECT_FALSE(cursor.is_copy(0));
    EXPECT_FALSE(cursor.is_copy(4'000'000'000U));
  }
}

/// In the first block, at its end, in the next, and in the fourth and the last there can be.
const std::vector<std::uint32_t> kIds{5,       7,       65'535,        65'536,
                                      100'000, 196'608, 4'294'901'760, 4'294'967'295};

TEST_F(CopyListTest, ReadsAnyRange) {
  const CopyList list = list_of(kIds);
  EXPECT_EQ(list.count(), kIds.size());
  for (const std::uint64_t first : {0UL, 5UL, 6UL, 65'535UL, 65'536UL, 65'537UL, 131'072UL,
                                    196'608UL, 196'609UL, 4'294'901'760UL, 4'294'967'295UL}) {
    for (const std::uint64_t count : {0UL, 1UL, 3UL, 65'530UL, 65'536UL, 65'537UL, 200'000UL}) {
      std::vector<std::uint32_t> expected;
      std::ranges::copy_if(kIds, std::back_inserter(expected),
                           [&](std::uint64_t id) { return id >= first && id < first + count; });
      EXPECT_EQ(ids(list, first, count), expected) << first << ", " << count;
    }
  }
  EXPECT_EQ(ids(list, 0, std::uint64_t{1} << 32), kIds);
}

TEST_F(CopyListTest, KeepsWhatItIsGiven) {
  CopyList list(scratch_);
  const CopyRecords given{{1, 0, 1}, {70'000, 3, 1}, {70'001, 0, 2}};
  for (const CopyVertex& copy : given)
    list.append(copy);
  std::vector<CopyVertex> memory;
  const auto read = list.read(0, 70'002, memory);
  EXPECT_EQ(CopyRecords(read.begin(), read.end()), given);
}

TEST_F(CopyListTest, WhatIsStoredIsThereInAnotherProcess) {
  const CopyList list = list_of(kIds);
  const std::vector<StoredCopies> stored = list.store(scratch_, [] {});
  ASSERT_EQ(stored.size(), 4U);
  CopyList restored(scratch_, std::uint64_t{1} << 32);
  EXPECT_TRUE(restored.empty());
  for (const StoredCopies& block : stored)
    ASSERT_TRUE(restored.restore(block));
  EXPECT_EQ(restored.count(), kIds.size());
  for (const std::uint64_t first : {0UL, 6UL, 65'536UL, 4'294'967'295UL}) {
    for (const std::uint64_t count : {0UL, 1UL, 65'537UL, 200'000UL})
      EXPECT_EQ(ids(restored, first, count), ids(list, first, count)) << first << ", " << count;
  }
  std::vector<std::uint32_t> visited;
  restored.for_each([] {}, [&](const CopyVertex& copy) { visited.push_back(copy.id); });
  EXPECT_EQ(visited, kIds);
  visited.clear();
  restored.for_each(
      7, 65'537, [] {}, [&](const CopyVertex& copy) { visited.push_back(copy.id); });
  EXPECT_THAT(visited, testing::ElementsAre(7, 65'535, 65'536));
  EXPECT_FALSE(restored.restore(stored[0])) << "twice";
  CopyList small(scratch_, 65'536);
  EXPECT_FALSE(small.restore(stored[1])) << "no such ids";
  EXPECT_FALSE(small.restore({0, {0, 11, 0}})) << "no whole records";
}

TEST_F(CopyListTest, ACursorTellsCopiesFromOthers) {
  const CopyList list = list_of(kIds);
  CopyCursor cursor(list);
  for (const std::uint32_t id : {0U, 4U, 5U, 5U, 7U, 8U, 65'535U, 65'536U, 65'537U, 140'000U,
                                 196'607U, 196'608U, 300'000U, 4'294'901'760U, 4'294'967'295U}) {
    EXPECT_EQ(cursor.is_copy(id), std::ranges::count(kIds, id) == 1) << id;
  }
}

// ---- finding -------------------------------------------------------------------------------

/// So much is there to work with.
struct LookBudget {
  std::uint64_t pool_bytes = 0;
  std::uint64_t memory_bytes = 0;
  std::size_t blocks_in_flight = 1;
};
constexpr LookBudget kBudgets[] = {{64 << 20, 64 << 20, 8}, {0, 1 << 20, 3}, {0, 1, 1}};

CopyRecords expected_copies(const PositionList& positions) {
  std::map<std::array<double, 3>, std::pair<std::uint32_t, std::uint32_t>> known;  // first, slot
  CopyRecords copies;
  for (std::uint32_t id = 0; id < positions.size(); ++id) {
    const Vec3d& p = positions[id];
    const auto [found, is_new] = known.try_emplace({p.x + 0.0, p.y + 0.0, p.z + 0.0}, id, 0);
    if (!is_new)
      copies.push_back({id, found->second.first, ++found->second.second});
  }
  return copies;
}

class FindCopiesTest : public testing::Test {
 protected:
  /// Expects the copies of a PLY that is read in place, and of one in text, which is not; in all
  /// budgets.
  void expect_found(const PositionList& positions, bool as_doubles, const CopyRecords& expected) {
    write(positions, as_doubles);
    write_text(positions, as_doubles);
    for (const char* file : {"mesh.ply", "text.ply"}) {
      for (const LookBudget& budget : kBudgets) {
        // One comparison: lists of a million are not to be printed.
        EXPECT_TRUE(found_in(file, budget) == expected)
            << file << ", " << budget.memory_bytes << " bytes";
      }
    }
  }
  void expect_found(const PositionList& positions, const CopyRecords& expected) {
    for (const bool as_doubles : {false, true}) {
      SCOPED_TRACE(as_doubles ? "doubles" : "floats");
      expect_found(positions, as_doubles, expected);
    }
  }
  /// Expects the copies that a map finds. All positions must be floats.
  void expect_as_by_map(const PositionList& positions) {
    expect_found(positions, expected_copies(positions));
  }

  CopyRecords found_in(const char* file, const LookBudget& budget) {
    storage::MemoryPool pool(budget.pool_bytes);
    CopyRecords copies;
    {
      storage::ScratchFile scratch(files_, "scratch", pool);
      storage::ScratchFile list(files_, "list", pool);
      execution::NoProgress progress;
      const execution::CancelToken cancel;
      const auto source = mesh_io::open_mesh(files_, file);
      const CopyList found = find_copies(
          *source, list, {scratch, budget.memory_bytes, budget.blocks_in_flight, progress, cancel});
      std::vector<CopyVertex> memory;
      const auto all = found.read(0, source->description().vertex_count, memory);
      copies.assign(all.begin(), all.end());
      EXPECT_EQ(copies.size(), found.count());
    }
    EXPECT_EQ(pool.free_bytes(), budget.pool_bytes) << "memory was not given back";
    return copies;
  }

  void write(const PositionList& positions, bool as_doubles) {
    mesh_io::PlyContent content;
    content.vertex_count = positions.size();
    content.double_coordinates = as_doubles;
    mesh_io::PlyWriter writer(files_.create("mesh.ply"), content);
    writer.write_vertices(positions, {});
    writer.finish();
  }
  void write_text(const PositionList& positions, bool as_doubles) {
    std::string text = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\n", positions.size());
    for (const char* axis : {"x", "y", "z"})
      text += fmt::format("property {} {}\n", as_doubles ? "double" : "float", axis);
    text += "end_header\n";
    for (const Vec3d& p : positions)
      text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
    files_.put("text.ply", text);
  }

  tests::MemoryFiles files_;
};

/// No two of them are equal, as floats.
PositionList lattice(int side) {
  PositionList positions;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (int z = 0; z < side; ++z)
        positions.push_back({x * 0.25, y * 0.5, z * 1.0});
    }
  }
  return positions;
}

TEST_F(FindCopiesTest, SLOW_PositionsThatAllDifferHaveNone) {
  expect_found({}, {});
  expect_found({{1, 2, 3}}, {});
  expect_found(lattice(50), {});
}

TEST_F(FindCopiesTest, SLOW_OnePairIsFoundWhereverItIs) {
  const PositionList lattice_points = lattice(42);  // in two blocks of the file, at least
  const auto count = static_cast<std::uint32_t>(lattice_points.size());
  for (const std::uint32_t from : {0U, 43'689U, 65'536U, count - 1}) {
    PositionList positions = lattice_points;
    positions.push_back({-1, 0, 0});
    positions.push_back(positions[from]);
    expect_found(positions, {{count + 1, from, 1}});
  }
}

TEST_F(FindCopiesTest, MinusZeroIsZero) {
  expect_found({{0.0, 1, -0.0}, {2, 2, 2}, {-0.0, 1, 0.0}, {0.0, 1, 0.0}}, {{2, 0, 1}, {3, 0, 2}});
  expect_found({{-0.0, -0.0, -0.0}, {0.0, 0.0, 0.0}}, {{1, 0, 1}});
}

TEST_F(FindCopiesTest, DoublesThatAreOneFloatAreOtherPlaces) {
  const PositionList positions{{400'000.1, 1, 2}, {0, 0, 0}, {400'000.1000001, 1, 2}};
  expect_found(positions, true, {});
  expect_found(positions, false, {{2, 0, 1}});
}

TEST_F(FindCopiesTest, SLOW_OneAxisIsEnoughToDiffer) {
  expect_found({{1, 2, 3}, {1, 2, 4}, {1, 4, 3}, {4, 2, 3}, {3, 2, 1}, {2, 1, 3}}, {});
}

TEST_F(FindCopiesTest, SLOW_OnePositionAMillionTimes) {
  // No bucket of them fits into little memory: it is sorted externally.
  PositionList positions(1'000'000, Vec3d{1, 2, 3});
  CopyRecords all;
  for (std::uint32_t id = 1; id < positions.size(); ++id)
    all.push_back({id, 0, id});
  expect_found(positions, false, all);
  CopyRecords halves;
  for (std::uint32_t id = 0; id < positions.size(); ++id) {
    positions[id].x = id % 2;
    if (id > 1)
      halves.push_back({id, id % 2, id / 2});
  }
  expect_found(positions, false, halves);
}

TEST_F(FindCopiesTest, SLOW_EveryPositionTwice) {
  PositionList positions = lattice(48);
  const std::size_t count = positions.size();
  for (std::size_t i = 0; i < count; ++i)
    positions.push_back(positions[(i * 7919) % count]);
  expect_as_by_map(positions);
}

TEST_F(FindCopiesTest, CopiesAreNumberedInTheOrderOfIds) {
  std::mt19937 random(1);
  for (int run = 0; run < 12; ++run) {
    const auto range = static_cast<std::uint32_t>(2 + 5 * run);
    PositionList positions;
    for (int i = 0; i < 1 + 300 * run; ++i) {
      positions.push_back({static_cast<double>(random() % range),
                           static_cast<double>(random() % range) * (run % 2 == 0 ? -0.0 : 1), 0});
    }
    SCOPED_TRACE(run);
    expect_as_by_map(positions);
  }
}

TEST_F(FindCopiesTest, DefectsOfTheMeshAreTold) {
  files_.put("mesh.ply",
             "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
             "property float y\nproperty float z\nend_header\n0 0 0\n0 nan 0\n");
  EXPECT_THROW(found_in("mesh.ply", kBudgets[0]), Error);
}

TEST_F(FindCopiesTest, EndsWhenItIsCancelled) {
  write(lattice(50), false);
  storage::MemoryPool pool(0);
  storage::ScratchFile scratch(files_, "scratch", pool);
  execution::NoProgress progress;
  execution::CancelToken cancel;
  cancel.cancel();
  const auto source = mesh_io::open_mesh(files_, "mesh.ply");
  EXPECT_THROW(find_copies(*source, scratch, {scratch, 1 << 20, 2, progress, cancel}), Error);
}

}  // namespace
}  // namespace meshhier::importing
