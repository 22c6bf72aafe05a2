#include "storage/io/journal.h"

#include "base/error.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/sample_hierarchy.h"

#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using tests::Call;
using tests::FaultyFileSystem;

class JournalTest : public testing::Test {
 protected:
  /// Opens the journal, appends `more`, and returns what was in it before.
  std::vector<std::string> open(const std::vector<std::string>& more = {},
                                const std::string& refused = "") {
    std::vector<std::string> found;
    Journal journal(files_, path_, use_, [&](const Journal::Entry& entry) {
      if (entry == refused)
        return false;
      found.push_back(entry);
      return true;
    });
    for (const std::string& text : more)
      journal.append(text);
    return found;
  }

  std::vector<std::byte> bytes() { return read_file(files_, path_, 1 << 20); }

  FaultyFileSystem files_;
  tests::TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_.path() / "journal";
  ScratchUse use_;
};

TEST_F(JournalTest, HoldsWhatWasAppendedInItsOrder) {
  EXPECT_THAT(open({"a", "b"}), IsEmpty());
  EXPECT_THAT(open({"c"}), ElementsAre("a", "b"));
  EXPECT_THAT(open(), ElementsAre("a", "b", "c"));
}

TEST_F(JournalTest, KeepsEveryKindOfNumber) {
  const Journal::Entry entry{{"large", ~std::uint64_t{0}},
                             {"small", -5},
                             {"exact", 0.1},
                             {"tiny", 5e-324},
                             {"infinite", std::numeric_limits<double>::infinity()}};
  Journal(files_, path_, use_, [](const auto&) { return true; }).append(entry);
  int seen = 0;
  Journal(files_, path_, use_, [&](const Journal::Entry& found) {
    EXPECT_EQ(found, entry);
    ++seen;
    return true;
  });
  EXPECT_EQ(seen, 1);
}

// As after a kill in the middle of a write, or a power cut.
TEST_F(JournalTest, CutAnywhereHoldsTheEntriesBefore) {
  open({"first", "second"});
  const std::vector<std::byte> whole = bytes();
  std::size_t most = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    write_file(files_, path_, std::span(whole).first(size));
    const std::vector<std::string> found = open({"third"});
    EXPECT_GE(found.size(), most);
    most = found.size();
    std::vector<std::string> expected = found;
    expected.emplace_back("third");
    EXPECT_EQ(open(), expected) << size;
  }
  EXPECT_EQ(most, 2U);
}

TEST_F(JournalTest, AnyFlippedBitEndsIt) {
  open({"first", "second", "third"});
  const std::vector<std::byte> whole = bytes();
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::vector<std::byte> damaged = whole;
    damaged[bit / 8] ^= std::byte{1} << bit % 8;
    write_file(files_, path_, damaged);
    const std::vector<std::string> found = open();
    const std::vector<std::string> all{"first", "second", "third"};
    ASSERT_LT(found.size(), all.size()) << bit;
    EXPECT_TRUE(std::equal(found.begin(), found.end(), all.begin())) << bit;
  }
}

TEST_F(JournalTest, WhatIsRefusedIsDroppedWithAllBehindIt) {
  open({"a", "b", "c"});
  EXPECT_THAT(open({"x"}, "b"), ElementsAre("a"));
  // "c" lies behind "x" as it lay behind "b", of the same size; it belongs to neither.
  EXPECT_THAT(open(), ElementsAre("a", "x"));
}

TEST_F(JournalTest, AnEntryThatCouldNotBeWrittenIsNone) {
  for (std::uint64_t room = 0; room < 20; ++room) {
    std::filesystem::remove(path_);
    open({"a"});
    files_.limit_writes(room);
    EXPECT_THROW(open({"a longer text than that"}), Error);
    files_.limit_writes(1 << 20);
    EXPECT_THAT(open({"b"}), ElementsAre("a"));
    EXPECT_THAT(open(), ElementsAre("a", "b"));
  }
}

TEST_F(JournalTest, AFileThatIsNoneIsBegunAnew) {
  const std::string text = "years of work, but no journal";
  write_file(files_, path_, std::as_bytes(std::span(text)));
  EXPECT_THAT(open({"a"}), IsEmpty());
  EXPECT_THAT(open(), ElementsAre("a"));
}

TEST_F(JournalTest, AReadThatFailsIsToldAndLosesNothing) {
  open({"a", "b"});
  for (std::uint64_t n = 1; n <= 6; ++n) {
    files_.fail(Call::read, n);
    EXPECT_THROW(open(), Error) << n;
  }
  EXPECT_THAT(open(), ElementsAre("a", "b"));
}

TEST_F(JournalTest, CountsWhatItMoves) {
  open({"a"});
  EXPECT_EQ(use_.bytes_written(), bytes().size());
  open();
  EXPECT_GT(use_.bytes_read(), bytes().size() / 2);
}

}  // namespace
}  // namespace meshhier::storage
