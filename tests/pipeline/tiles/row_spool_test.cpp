#include "pipeline/tiles/row_spool.h"

#include "tests/support/sample_hierarchy.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using testing::ElementsAre;

constexpr std::size_t kWidth = 3;

class RowSpoolTest : public testing::Test {
 protected:
  RowSpool make(std::size_t block_bytes = 64) { return {scratch_, block_bytes, kWidth}; }

  /// Rows first to end, each of its number.
  static std::vector<float> numbered(std::uint32_t first, std::uint32_t end) {
    std::vector<float> rows;
    for (std::uint32_t row = first; row < end; ++row)
      rows.insert(rows.end(), kWidth, static_cast<float>(row));
    return rows;
  }

  /// Returns a batch's rows in their places, a number a row; fails if a row is there twice.
  static std::vector<float> read(const RowSpool& spool, std::size_t batch) {
    constexpr float kNone = -1;
    std::vector<float> all(spool.size(), kNone);
    spool.for_each(batch, [&](std::uint64_t first, std::span<const float> rows) {
      ASSERT_LE(rows.size(), batch * kWidth);
      ASSERT_EQ(rows.size() % kWidth, 0U);
      for (std::size_t i = 0; i < rows.size(); i += kWidth) {
        float& row = all.at(first + i / kWidth);
        EXPECT_EQ(row, kNone);
        row = rows[i + kWidth - 1];
      }
    });
    return all;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  storage::ScratchFile scratch_{*files_, directory_.path() / "scratch", pool_};
};

TEST_F(RowSpoolTest, RowsAreWhereTheirNumbersSayWhateverIsReadAtATime) {
  RowSpool spool = make();
  spool.append(7, numbered(7, 40));
  spool.append(0, numbered(0, 1));
  spool.append(3, numbered(3, 7));
  spool.append(1, numbered(1, 3));
  ASSERT_EQ(spool.size(), 40U);
  for (const std::size_t batch : {1U, 2U, 3U, 7U, 40U, 1000U}) {
    const std::vector<float> rows = read(spool, batch);
    for (std::size_t i = 0; i < rows.size(); ++i)
      ASSERT_EQ(rows[i], static_cast<float>(i)) << batch;
  }
}

TEST_F(RowSpoolTest, NothingIsThereBeforeItComesAndAfterClear) {
  RowSpool spool = make();
  EXPECT_EQ(spool.size(), 0U);
  EXPECT_TRUE(read(spool, 4).empty());
  spool.append(0, numbered(0, 5));
  spool.clear();
  EXPECT_EQ(spool.size(), 0U);
  EXPECT_TRUE(read(spool, 4).empty());
}

TEST_F(RowSpoolTest, RestoredPartsAreNumberedOneBehindTheOther) {
  RowSpool first = make(), none = make(), second = make();
  first.append(2, numbered(2, 3));
  first.append(0, numbered(0, 2));
  second.append(1, numbered(11, 13));
  second.append(0, numbered(10, 11));
  RowSpool joined = make();
  for (RowSpool* part : {&none, &first, &none, &second})
    ASSERT_TRUE(joined.restore(part->store()));
  EXPECT_EQ(joined.find_change(), std::nullopt);
  EXPECT_THAT(read(joined, 2), ElementsAre(0, 1, 2, 10, 11, 12));
}

TEST_F(RowSpoolTest, NumbersThatAreNotThoseOfItsRowsAreRefused) {
  RowSpool written = make();
  written.append(0, numbered(0, 2));
  written.append(2, numbered(2, 4));
  const nlohmann::json stored = written.store();
  const auto restored_of = [&](int count) {
    nlohmann::json other = stored;
    other.at(4) = count;
    RowSpool spool = make();
    EXPECT_TRUE(spool.restore(other));
    return read(spool, 4);
  };
  EXPECT_EQ(restored_of(4).size(), 4U);
  for (const int count : {3, 5})
    EXPECT_THROW(restored_of(count), Error);
  nlohmann::json empty = make().store();
  empty.at(4) = 1;
  EXPECT_FALSE(make().restore(empty));
}

}  // namespace
}  // namespace meshhier::pipeline
