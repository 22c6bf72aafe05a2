#include "server/request_head.h"

#include <string>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

using std::string_literals::operator""s;

TEST(RequestHeadTest, RangeIsTakenOutAndAllElseStays) {
  const auto head =
      parse_head("GET / HTTP/1.1\r\nHost: a\r\nrAnGe:  bytes=1-2 \r\nX: Range: y\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->text, "GET / HTTP/1.1\r\nHost: a\r\nX: Range: y\r\n\r\n");
  EXPECT_EQ(head->range, "bytes=1-2");
  EXPECT_FALSE(head->has_body);
}

TEST(RequestHeadTest, SeveralRangesAreNone) {
  const auto head = parse_head("GET / HTTP/1.1\r\nRange: bytes=1-2\r\nRange: bytes=1-2\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->text, "GET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(head->range, std::nullopt);
}

TEST(RequestHeadTest, AnEmptyRangeIsOne) {
  const auto head = parse_head("GET / HTTP/1.1\r\nRange:\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->range, "");
}

TEST(RequestHeadTest, BodiesAreAnnounced) {
  for (const char* line :
       {"Content-Length: 0", "content-length: 5", "Transfer-Encoding: chunked"}) {
    const auto head = parse_head("POST / HTTP/1.1\r\n" + std::string(line) + "\r\n\r\n");
    ASSERT_TRUE(head);
    EXPECT_TRUE(head->has_body) << line;
  }
}

TEST(RequestHeadTest, LinesThatOthersWouldSeeOtherwiseAreRefused) {
  for (const std::string& raw :
       {"GET / HTTP/1.1\r\nX: a\nRange: bytes=0-1\r\n\r\n"s, "GET / HTTP/1.1\nHost: a\n\n"s,
        "GET / HTTP/1.1\r\nX: a\rb\r\n\r\n"s, "GET /\0 HTTP/1.1\r\n\r\n"s, "GET / HTTP/1.1\r\n\r"s,
        "\n\r\n"s, "GET"s})
    EXPECT_EQ(parse_head(raw), std::nullopt) << raw;
}

}  // namespace
}  // namespace meshhier::server
