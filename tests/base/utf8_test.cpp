#include "base/utf8.h"

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

TEST(Utf8Test, KnowsWhatIsUtf8) {
  for (const char* text : {"", "a", "Straße", "\xe2\x82\xac", "\xf0\x9f\x8f\xa0", "\xed\x9f\xbf",
                           "\xee\x80\x80", "\xf4\x8f\xbf\xbf", "\xc2\x80", "\xe0\xa0\x80"})
    EXPECT_TRUE(is_utf8(text)) << text;
}

TEST(Utf8Test, KnowsWhatIsNot) {
  for (const char* text : {"\x80", "\xc3", "\xc3(", "\xc0\x80", "\xc1\xbf", "\xe0\x9f\xbf",
                           "\xed\xa0\x80", "\xed\xbf\xbf", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
                           "\xf5\x80\x80\x80", "\xe2\x82", "\xf0\x9f\x8f", "a\xff", "\xe2\x28\xa1"})
    EXPECT_FALSE(is_utf8(text)) << text;
}

}  // namespace
}  // namespace meshhier::tests
