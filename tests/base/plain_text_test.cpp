#include "base/plain_text.h"

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

TEST(PlainText, KeepsWhatATerminalShows) {
  EXPECT_EQ(plain_text("", 10), "");
  EXPECT_EQ(plain_text("na\xc3\xafve ~", 10), "na\xc3\xafve ~");
}

TEST(PlainText, ReplacesControlCharacters) {
  EXPECT_EQ(plain_text(std::string_view("a\nb\x1b[2J\x7f\0c", 10), 20), "a?b?[2J??c");
}

TEST(PlainText, IsCutBetweenCharacters) {
  EXPECT_EQ(plain_text("abcdef", 6), "abcdef");
  EXPECT_EQ(plain_text("abcdefg", 6), "abcdef...");
  EXPECT_EQ(plain_text("abcde\xc3\xaf", 6), "abcde...");
  EXPECT_EQ(plain_text("\x80\x80\x80", 2), "...");
}

TEST(Counted, VerticesSayWhereTheyLieIfSomeLieTogether) {
  EXPECT_EQ(counted_vertices(600, 600), "600 vertices");
  EXPECT_EQ(counted_vertices(600, 578), "600 vertices at 578 places");
  EXPECT_EQ(counted_vertices(2, 1), "2 vertices at 1 place");
}

TEST(Counted, HasTheSingularForOne) {
  EXPECT_EQ(counted(0, "vertices"), "0 vertices");
  EXPECT_EQ(counted(1, "vertices"), "1 vertex");
  EXPECT_EQ(counted(2, "vertices"), "2 vertices");
  EXPECT_EQ(counted(1, "entries"), "1 entry");
  EXPECT_EQ(counted(1, "pieces"), "1 piece");
  EXPECT_EQ(counted(1, "degenerate triangles"), "1 degenerate triangle");
  EXPECT_EQ(counted(1, "triangles lost by welding"), "1 triangle lost by welding");
}

TEST(JsonFault, IsToldWithoutTheParsersName) {
  EXPECT_EQ(json_fault("[json.exception.parse_error.101] parse error at line 1, column 2: x"),
            "line 1, column 2: x");
  EXPECT_EQ(json_fault("[json.exception.out_of_range.406] number overflow"), "number overflow");
  EXPECT_EQ(json_fault("plain"), "plain");
}

}  // namespace
}  // namespace meshhier::tests
