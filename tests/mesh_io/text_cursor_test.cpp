#include "mesh_io/text_cursor.h"

#include "ply_samples.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

struct Word {
  std::string text;
  std::uint64_t line;
  friend bool operator==(const Word&, const Word&) = default;
};

std::vector<std::vector<Word>> rows_of(const std::string& text) {
  tests::MemoryFiles files;
  files.put("t", text);
  const auto file = files.open("t");
  TextCursor cursor({*file, text.size()}, 0, 1);
  std::vector<std::vector<Word>> rows;
  while (cursor.to_row()) {
    rows.emplace_back();
    do {
      const std::string word(cursor.take_word());
      rows.back().push_back({word, cursor.line()});
    } while (cursor.to_word());
  }
  EXPECT_EQ(cursor.remaining(), 0U);
  return rows;
}

TEST(TextCursor, SplitsRowsAndWordsAndCountsLines) {
  const std::vector<std::vector<Word>> expected{{{"a", 1}, {"b", 1}}, {{"c", 3}}, {{"d", 4}}};
  EXPECT_EQ(rows_of(" a\tb \n\n\tc\nd"), expected);
  EXPECT_EQ(rows_of("a b\r\n \r\nc \r\nd\r\n"), expected);
  EXPECT_EQ(rows_of("a b\r\rc\rd\r\r"), expected);
  EXPECT_EQ(rows_of("a b\n\rc\r\nd\r"), expected);
}

TEST(TextCursor, NothingIsNoRow) {
  EXPECT_TRUE(rows_of("").empty());
  EXPECT_TRUE(rows_of(" \n\r\n\t").empty());
}

/// Words and line ends fall on every position around the end of the buffer.
TEST(TextCursor, BufferEndsAnywhere) {
  for (std::size_t shift = 0; shift < 12; ++shift) {
    const std::string blanks(ByteWindow::kCapacity - 6 - shift, ' ');
    const auto rows = rows_of(blanks + "abc def\r\n\r\nghi\n");
    ASSERT_EQ(rows.size(), 2U) << shift;
    EXPECT_EQ(rows[0], (std::vector<Word>{{"abc", 1}, {"def", 1}})) << shift;
    EXPECT_EQ(rows[1], (std::vector<Word>{{"ghi", 3}})) << shift;
  }
}

TEST(TextCursor, ALineLongerThanTheBufferIsOneRow) {
  std::string text;
  for (int i = 0; i < 400000; ++i)
    text += std::to_string(i) + ' ';
  ASSERT_GT(text.size(), 2 * ByteWindow::kCapacity);
  const auto rows = rows_of(text + "\nend");
  ASSERT_EQ(rows.size(), 2U);
  ASSERT_EQ(rows[0].size(), 400000U);
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    ASSERT_EQ(rows[0][i].text, std::to_string(i));
  }
  EXPECT_EQ(rows[1][0], (Word{"end", 2}));
}

TEST(TextCursor, WordsAreLimited) {
  const std::string longest(TextCursor::kMaxWordBytes, 'w');
  EXPECT_EQ(rows_of(longest + " x")[0][0].text, longest);
  tests::MemoryFiles files;
  files.put("t", longest + "w x");
  const auto file = files.open("t");
  TextCursor cursor({*file, longest.size() + 3}, 0, 1);
  ASSERT_TRUE(cursor.to_row());
  EXPECT_EQ(cursor.take_word(), "");
}

}  // namespace
}  // namespace meshhier::mesh_io
