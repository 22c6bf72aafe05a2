#include "server/request_head.h"

#include <optional>
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

TEST(RequestHeadTest, WhoWaitsForTheGoAheadIsNoticed) {
  const auto head = parse_head("PUT / HTTP/1.1\r\nexpect: 100-Continue\r\nHost: a\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_TRUE(head->expects_continue);
  EXPECT_EQ(head->text, "PUT / HTTP/1.1\r\nHost: a\r\n\r\n") << "the library does not answer it";
  EXPECT_FALSE(parse_head("PUT / HTTP/1.1\r\nExpect: much\r\n\r\n")->expects_continue);
}

TEST(RequestHeadTest, TheLengthOfABodyIsToldIfItIsKnown) {
  const auto length_of = [](const std::string& line) {
    return parse_head("PUT / HTTP/1.1\r\n" + line + "\r\n\r\n")->body_bytes;
  };
  EXPECT_EQ(length_of("Content-Length: 9999999999999999999"), 9999999999999999999U);
  EXPECT_EQ(length_of("Content-Length: 0"), 0U);
  EXPECT_EQ(length_of("Transfer-Encoding: chunked"), std::nullopt);
  EXPECT_EQ(length_of("X: y"), std::nullopt);
}

TEST(RequestHeadTest, BodiesAreAnnounced) {
  for (const char* line :
       {"content-length: 5", "Content-Length: 05", "Transfer-Encoding: chunked"}) {
    const auto head = parse_head("POST / HTTP/1.1\r\n" + std::string(line) + "\r\n\r\n");
    ASSERT_TRUE(head);
    EXPECT_TRUE(head->has_body) << line;
  }
}

TEST(RequestHeadTest, NoBytesAreNoBody) {
  const auto head = parse_head("GET / HTTP/1.1\r\nContent-Length: 0\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_FALSE(head->has_body);
}

TEST(RequestHeadTest, HeadersThatCanBeReadInTwoWaysAreRefused) {
  for (const std::string& lines : {"Transfer-Encoding : chunked"s,
                                   "X: a\r\n b"s,
                                   " X: a"s,
                                   "X: a\r\n\t"s,
                                   ": a"s,
                                   "X"s,
                                   "X Y: a"s,
                                   "X\x01: a"s,
                                   "X: a\x01"s,
                                   "X: \x7f"s,
                                   "X\x80: a"s,
                                   "Host: a\r\nhost: a"s,
                                   "Content-Length: 5\r\nContent-Length: 5"s,
                                   "Content-Length: 0\r\nContent-Length: 5"s,
                                   "Content-Length: 5\r\nTransfer-Encoding: chunked"s,
                                   "Content-Length: 5,5"s,
                                   "Content-Length: +5"s,
                                   "Content-Length:"s,
                                   "Content-Length: 123456789012345678901"s,
                                   "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked"s,
                                   "Transfer-Encoding: gzip"s})
    EXPECT_EQ(parse_head("GET / HTTP/1.1\r\n" + lines + "\r\n\r\n"), std::nullopt) << lines;
  for (const std::string& line :
       {"\r\n"s, " GET / HTTP/1.1\r\n"s, "GET /\t HTTP/1.1\r\n"s, "GET  / HTTP/1.1\r\n"s,
        "GET /  HTTP/1.1\r\n"s, "GET / HTTP/1.1 \r\n"s, "GET /a b HTTP/1.1\r\n"s, "GET /\r\n"s,
        "GET  HTTP/1.1\r\n"s})
    EXPECT_EQ(parse_head(line + "\r\n"), std::nullopt) << line;
}

TEST(RequestHeadTest, OfAWholeAddressTheHostCountsAndNotTheHeaders) {
  const auto text_of = [](const std::string& target, const std::string& version = "HTTP/1.1") {
    const auto head =
        parse_head("GET " + target + " " + version + "\r\nHost: other\r\nX: y\r\n\r\n");
    return head ? head->text : "";
  };
  EXPECT_EQ(text_of("http://a:80/b?c=http://d/"),
            "GET /b?c=http://d/ HTTP/1.1\r\nHost: a:80\r\nX: y\r\n\r\n");
  EXPECT_EQ(text_of("HTTPS://[::1]", "HTTP/1.0"), "GET / HTTP/1.0\r\nHost: [::1]\r\nX: y\r\n\r\n");
  EXPECT_EQ(text_of("http://a?b"), "GET /?b HTTP/1.1\r\nHost: a\r\nX: y\r\n\r\n");
  EXPECT_EQ(text_of("/http://a/"), "GET /http://a/ HTTP/1.1\r\nHost: other\r\nX: y\r\n\r\n");
  for (const char* target :
       {"http://", "http:///b", "http://?b", "http://me@a/", "http://me:word@a/b"})
    EXPECT_EQ(text_of(target), "") << target;
  EXPECT_FALSE(parse_head("GET http://a/ HTTP/1.1\r\nHost: a\r\nHost: a\r\n\r\n"));
}

TEST(RequestHeadTest, LettersOfOtherScriptsMayBeInValues) {
  EXPECT_TRUE(parse_head("GET / HTTP/1.1\r\nX:\t\xc3\xa4 \r\n\r\n"));
}

TEST(RequestHeadTest, LinesThatOthersWouldSeeOtherwiseAreRefused) {
  for (const std::string& raw :
       {"GET / HTTP/1.1\r\nX: a\nRange: bytes=0-1\r\n\r\n"s, "GET / HTTP/1.1\nHost: a\n\n"s,
        "GET / HTTP/1.1\r\nX: a\rb\r\n\r\n"s, "GET /\0 HTTP/1.1\r\n\r\n"s, "GET / HTTP/1.1\r\n\r"s,
        "\n\r\n"s, "GET"s, "Range: bytes=0-1\r\n\r\n"s, "G(T / HTTP/1.1\r\n\r\n"s})
    EXPECT_EQ(parse_head(raw), std::nullopt) << raw;
}

}  // namespace
}  // namespace meshhier::server
