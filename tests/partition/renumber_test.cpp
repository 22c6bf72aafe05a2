#include "partition/renumber.h"

#include "base/error.h"
#include "storage/io/file.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::partition {
namespace {

constexpr std::uint64_t kSmall = 65536;  ///< the least memory

template <class Value>
Value value_of(std::uint32_t id) {
  return static_cast<Value>((id + 1) *
                            0x9E3779B97F4A7C15u);  // odd factor: no two ids share a value
}

class RenumberTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("renumber_") + info.name() + std::to_string(::getpid()));
  }

  template <class Value, class Id = std::uint32_t>
  std::vector<std::array<Value, 3>> renumbered(const std::vector<std::array<Id, 3>>& triangles,
                                               std::size_t id_count, std::uint64_t memory_bytes) {
    storage::MemoryPool pool(0);
    storage::ScratchFile scratch(*files_, path_, pool);
    storage::RecordSpool<Value> table(scratch, 4096);
    for (std::uint32_t id = 0; id < id_count; ++id)
      table.append(value_of<Value>(id));
    const RenumberPlan plan = plan_renumbering(id_count, sizeof(Value), memory_bytes);
    table_blocks_ = plan.blocks;
    return run(Renumberer<Value>(table, plan, scratch), triangles);
  }

  template <class Value, class Id>
  std::vector<std::array<Value, 3>> run(Renumberer<Value> renumberer,
                                        const std::vector<std::array<Id, 3>>& triangles) {
    std::vector<std::array<Value, 3>> result;
    Renumbered<Value> part;
    spooled_bytes_ = 0;
    const auto take = [&] {
      renumberer.keep(part);
      spooled_bytes_ += part.fresh.size() * sizeof(Triangle<std::uint32_t>) +
                        part.begun.size() * sizeof(WaitingTriangle<Value>);
      result.insert(result.end(), part.finished.begin(), part.finished.end());
    };
    for (std::size_t i = 0; i < triangles.size(); i += 1000) {
      renumberer.translate(
          std::span(triangles).subspan(i, std::min<std::size_t>(1000, triangles.size() - i)), part);
      take();
    }
    while (renumberer.next_round()) {
      for (std::uint64_t batch = 0; batch < renumberer.batches(); ++batch) {
        renumberer.translate_batch(batch, part);
        take();
      }
    }
    return result;
  }

  template <class Value>
  void expect_exact(const std::vector<Triangle<std::uint32_t>>& triangles, std::size_t id_count,
                    std::uint64_t memory_bytes) {
    std::vector<std::array<Value, 3>> expected, found;
    for (const Triangle<std::uint32_t>& t : triangles) {
      expected.push_back({value_of<Value>(t[0]), value_of<Value>(t[1]), value_of<Value>(t[2])});
    }
    found = renumbered<Value>(triangles, id_count, memory_bytes);
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(found == expected) << found.size() << " of " << expected.size();
  }

  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::filesystem::path path_;
  std::uint64_t table_blocks_ = 0;
  std::uint64_t spooled_bytes_ = 0;
};

TEST_F(RenumberTest, ATableInMemory) {
  const tests::TestMesh mesh = tests::shuffled(tests::sphere(20'000), 3);
  const std::size_t ids = mesh.positions.size();
  auto table = std::make_unique<std::uint32_t[]>(ids);
  for (std::uint32_t id = 0; id < ids; ++id)
    table[id] = value_of<std::uint32_t>(id);
  storage::MemoryPool pool(0);
  storage::ScratchFile scratch(*files_, path_, pool);
  const auto found = run(Renumberer<std::uint32_t>(std::move(table), ids, scratch), mesh.triangles);
  ASSERT_EQ(found.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < found.size(); ++i) {  // in their order
    for (std::size_t corner = 0; corner < 3; ++corner)
      ASSERT_EQ(found[i][corner], value_of<std::uint32_t>(mesh.triangles[i][corner]));
  }
  EXPECT_EQ(scratch.size(), 0u);
}

TEST_F(RenumberTest, ATableThatFitsIsLoadedOnce) {
  const tests::TestMesh mesh = tests::sphere(20'000);
  expect_exact<std::uint32_t>(mesh.triangles, mesh.positions.size(), 1 << 20);
  EXPECT_EQ(table_blocks_, 1u);
  EXPECT_EQ(spooled_bytes_, 0u);
}

TEST_F(RenumberTest, ATableOfSomeIds) {
  constexpr std::uint32_t kFirst = 1'000'000'000;
  const tests::TestMesh mesh = tests::sphere(200'000);
  std::vector<Triangle<std::uint32_t>> triangles, expected;
  for (const Triangle<std::uint32_t>& t : mesh.triangles) {
    triangles.push_back({kFirst + t[0], kFirst + t[1], kFirst + t[2]});
    expected.push_back({kFirst + 2 * t[0], kFirst + 2 * t[1], kFirst + 2 * t[2]});
  }
  const RenumberTable<std::uint32_t> table{
      kFirst, mesh.positions.size(), [](std::uint64_t id, std::span<std::uint32_t> values) {
        for (std::uint32_t& value : values)
          value = static_cast<std::uint32_t>(2 * (id++ - kFirst) + kFirst);
      }};
  storage::MemoryPool pool(0);
  storage::ScratchFile scratch(*files_, path_, pool);
  for (const std::uint64_t memory : {kSmall, std::uint64_t{1} << 20}) {
    const RenumberPlan plan = plan_renumbering(table.entries, sizeof(std::uint32_t), memory);
    auto found = run(Renumberer<std::uint32_t>(table, plan, scratch), triangles);
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_TRUE(found == expected) << memory;
  }
  Renumbered<std::uint32_t> part;
  const Renumberer<std::uint32_t> renumberer(table, plan_renumbering(table.entries, 4, 1 << 20),
                                             scratch);
  EXPECT_THROW(renumberer.translate(std::span(mesh.triangles), part), Error) << "other ids";
}

TEST_F(RenumberTest, NoTrianglesAndNoIds) {
  expect_exact<std::uint32_t>({}, 0, kSmall);
  expect_exact<std::uint32_t>({}, 100'000, kSmall);
  expect_exact<std::uint64_t>({{0, 99'999, 50'000}}, 100'000, kSmall);
}

TEST_F(RenumberTest, CoherentIdsWaitOnceAtMostMostly) {
  const tests::TestMesh mesh = tests::sphere(200'000);  // 100,000 ids, 400 kB: 13 blocks
  expect_exact<std::uint32_t>(mesh.triangles, mesh.positions.size(), kSmall);
  EXPECT_GE(table_blocks_, 10u);
  EXPECT_GT(spooled_bytes_, 0u);
  // 12 bytes for the bucket, 12 more for the group: no more than a tenth goes further.
  EXPECT_LT(spooled_bytes_, mesh.triangles.size() * 24 * 11 / 10);
}

TEST_F(RenumberTest, RandomIds) {
  const tests::TestMesh mesh = tests::shuffled(tests::sphere(200'000), 5);
  expect_exact<std::uint32_t>(mesh.triangles, mesh.positions.size(), kSmall);
  // At most three buckets of 16 bytes, each through a group.
  EXPECT_LE(spooled_bytes_, mesh.triangles.size() * 3 * 2 * 16);
  expect_exact<std::uint32_t>(mesh.triangles, mesh.positions.size(), 300'000);
  EXPECT_EQ(table_blocks_, 3u);
}

TEST_F(RenumberTest, OneLevelOfBucketsAndTwo) {
  const std::uint64_t entries = 1'000'000;
  const RenumberPlan one = plan_renumbering(entries, 8, 2 << 20);
  EXPECT_EQ(one.blocks, 6u);
  EXPECT_EQ(one.groups, 1u);
  const RenumberPlan two = plan_renumbering(entries, 8, 1 << 18);
  EXPECT_EQ(two.blocks, 46u);
  EXPECT_EQ(two.groups, 7u);
  const tests::TestMesh mesh = tests::shuffled(tests::torus(200'000), 6);
  std::vector<Triangle<std::uint32_t>> triangles = mesh.triangles;
  for (Triangle<std::uint32_t>& t : triangles)
    t = {t[0] * 9, t[1] * 9 + 1, t[2] * 9 + 2};
  expect_exact<std::uint64_t>(triangles, entries, 2 << 20);
  expect_exact<std::uint64_t>(triangles, entries, 1 << 18);
  EXPECT_EQ(table_blocks_, 46u);
}

TEST_F(RenumberTest, ThePlanKeepsWithinTheMemory) {
  for (const std::uint64_t memory : {1ull << 22, 1ull << 24, 1ull << 28}) {
    for (const std::uint64_t entries : {1000ull, 1'000'000ull, 4'000'000'000ull}) {
      for (const std::uint64_t bytes : {4ull, 8ull}) {
        const RenumberPlan plan = plan_renumbering(entries, bytes, memory);
        EXPECT_GE(plan.blocks * plan.block_entries, entries);
        EXPECT_GE(plan.groups * plan.group_blocks, plan.blocks);
        std::uint64_t held = plan.block_entries * bytes;
        if (plan.blocks > 1) {
          held += 2 * plan.bucket_bytes * (plan.group_blocks + (plan.groups > 1 ? plan.groups : 0));
        }
        EXPECT_LE(held, memory) << entries << " entries of " << bytes << " bytes";
      }
    }
  }
}

TEST_F(RenumberTest, RepeatedCornersAndTriangles) {
  std::vector<Triangle<std::uint32_t>> triangles;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const std::uint32_t a = i * 97 % 50'000, b = 49'999 - a;
    triangles.insert(triangles.end(), {{a, a, b}, {b, a, a}, {a, b, a}, {a, a, a}, {a, a, b}});
  }
  expect_exact<std::uint32_t>(triangles, 50'000, kSmall);
}

TEST_F(RenumberTest, StrongIds) {
  enum class Id : std::uint32_t {};
  const std::vector<std::array<Id, 3>> triangles = {{Id{2}, Id{0}, Id{39'999}}};
  const std::array<std::uint32_t, 3> expected = {
      value_of<std::uint32_t>(2), value_of<std::uint32_t>(0), value_of<std::uint32_t>(39'999)};
  for (const std::uint64_t memory : {kSmall, std::uint64_t{1} << 20}) {
    const auto found = renumbered<std::uint32_t, Id>(triangles, 40'000, memory);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0], expected);
  }
}

TEST_F(RenumberTest, AnIdBeyondTheTableIsRefused) {
  for (const std::uint64_t memory : {kSmall, std::uint64_t{1} << 20}) {
    try {
      renumbered<std::uint32_t>({{0, 1, 40'000}}, 40'000, memory);
      FAIL() << "not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::internal);
      EXPECT_NE(std::string(error.what()).find("40000"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace meshhier::partition
