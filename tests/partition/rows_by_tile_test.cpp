// Rows come to the tiles that asked for them, in memory and out of core.
#include "partition/rows_by_tile.h"

#include "storage/io/spool.h"
#include "support/sample_hierarchy.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

using Bytes = std::vector<std::byte>;

/// Rows of all lengths at which pieces begin and end.
Bytes bytes_of(std::uint32_t row) {
  constexpr std::size_t kLengths[]{0, 1, 19, 20, 21, 40, 77, RowsByTile::kMostRowBytes};
  Bytes bytes(kLengths[row % (row == 7 ? 8 : 7)]);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(row + 31 * i);
  return bytes;
}

class RowsByTileTest : public testing::TestWithParam<std::uint64_t> {
 protected:
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{GetParam()};
  storage::ScratchFile scratch_{*files_, directory_.path() / "scratch", pool_};
};

TEST_P(RowsByTileTest, EachTileGetsItsRowsAscending) {
  constexpr std::uint32_t kTiles = 300, kRows = 5000;
  std::mt19937 chance(5);
  std::vector<std::set<std::uint32_t>> asked(kTiles);
  RowsByTile rows(scratch_, 0);
  for (std::uint32_t tile = 0; tile < kTiles; ++tile) {
    for (std::uint32_t i = tile % 60; i > 0; --i)
      asked[tile].insert(i % 9 == 0 ? 7 : static_cast<std::uint32_t>(chance() % kRows));
    const std::vector<std::uint32_t> wishes(asked[tile].rbegin(), asked[tile].rend());
    rows.ask(tile, wishes);
  }
  std::vector<std::uint32_t> fetched;
  Bytes row_bytes;
  rows.fetch([&](std::uint32_t row) {
    fetched.push_back(row);
    return std::span<const std::byte>(row_bytes = bytes_of(row));
  });
  std::set<std::uint32_t> all;
  for (const auto& wishes : asked)
    all.insert(wishes.begin(), wishes.end());
  EXPECT_EQ(fetched, std::vector(all.begin(), all.end()));
  for (std::uint32_t tile = 0; tile < kTiles; ++tile) {
    std::vector<std::uint32_t> taken;
    rows.take(tile, [&](std::uint32_t row, RowsByTile::Bytes bytes) {
      taken.push_back(row);
      EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), bytes_of(row)) << row;
    });
    EXPECT_EQ(taken, std::vector(asked[tile].begin(), asked[tile].end())) << tile;
  }
}

INSTANTIATE_TEST_SUITE_P(Pools, RowsByTileTest, testing::Values(0, 64 << 20));

}  // namespace
}  // namespace meshhier::partition
