#include "server/request_head.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

using std::string_literals::operator""s;

/// The head, if it is taken.
std::optional<RequestHead> taken(std::string_view raw) {
  auto parsed = parse_head(raw);
  auto* head = std::get_if<RequestHead>(&parsed);
  return head == nullptr ? std::nullopt : std::optional(std::move(*head));
}

/// The status of a refusal; 0: it is none.
int refusal_of(std::string_view raw) {
  const auto parsed = parse_head(raw);
  const auto* refused = std::get_if<RefusedHead>(&parsed);
  return refused == nullptr ? 0 : refused->status;
}

TEST(RequestHeadTest, RangeIsTakenOutAndAllElseStays) {
  const auto head = taken("GET / HTTP/1.1\r\nHost: a\r\nrAnGe:  bytes=1-2 \r\nX: Range: y\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->text, "GET / HTTP/1.1\r\nHost: a\r\nX: Range: y\r\n\r\n");
  EXPECT_EQ(head->range, "bytes=1-2");
  EXPECT_FALSE(head->has_body);
}

TEST(RequestHeadTest, SeveralRangesAreNone) {
  const auto head = taken("GET / HTTP/1.0\r\nRange: bytes=1-2\r\nRange: bytes=1-2\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->text, "GET / HTTP/1.0\r\n\r\n");
  EXPECT_EQ(head->range, std::nullopt);
}

TEST(RequestHeadTest, AnEmptyRangeIsOne) {
  const auto head = taken("GET / HTTP/1.0\r\nRange:\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->range, "");
}

TEST(RequestHeadTest, WhoWaitsForTheGoAheadIsNoticed) {
  const auto head = taken("PUT / HTTP/1.1\r\nexpect: 100-Continue\r\nHost: a\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_TRUE(head->expects_continue);
  EXPECT_EQ(head->text, "PUT / HTTP/1.1\r\nHost: a\r\n\r\n") << "the library does not answer it";
  EXPECT_FALSE(taken("PUT / HTTP/1.0\r\nExpect: much\r\n\r\n")->expects_continue);
}

TEST(RequestHeadTest, TheLengthOfABodyIsToldIfItIsKnown) {
  const auto length_of = [](const std::string& line) {
    return taken("PUT / HTTP/1.0\r\n" + line + "\r\n\r\n")->body_bytes;
  };
  EXPECT_EQ(length_of("Content-Length: 9999999999999999999"), 9999999999999999999U);
  EXPECT_EQ(length_of("Content-Length: 0"), 0U);
  EXPECT_EQ(length_of("Transfer-Encoding: chunked"), std::nullopt);
  EXPECT_EQ(length_of("X: y"), std::nullopt);
}

TEST(RequestHeadTest, BodiesAreAnnounced) {
  for (const char* line :
       {"content-length: 5", "Content-Length: 05", "Transfer-Encoding: chunked"}) {
    const auto head = taken("POST / HTTP/1.0\r\n" + std::string(line) + "\r\n\r\n");
    ASSERT_TRUE(head);
    EXPECT_TRUE(head->has_body) << line;
  }
}

TEST(RequestHeadTest, NoBytesAreNoBody) {
  const auto head = taken("GET / HTTP/1.0\r\nContent-Length: 0\r\n\r\n");
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
    EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nHost: a\r\n" + lines + "\r\n\r\n"), 400) << lines;
  for (const std::string& line :
       {"\r\n"s, " GET / HTTP/1.1\r\n"s, "GET /\t HTTP/1.1\r\n"s, "GET  / HTTP/1.1\r\n"s,
        "GET /  HTTP/1.1\r\n"s, "GET / HTTP/1.1 \r\n"s, "GET /a b HTTP/1.1\r\n"s, "GET /\r\n"s,
        "GET  HTTP/1.1\r\n"s})
    EXPECT_EQ(refusal_of(line + "Host: a\r\n\r\n"), 400) << line;
}

TEST(RequestHeadTest, OfAWholeAddressTheHostCountsAndNotTheHeaders) {
  const auto text_of = [](const std::string& target, const std::string& version = "HTTP/1.1") {
    const auto head = taken("GET " + target + " " + version + "\r\nHost: other\r\nX: y\r\n\r\n");
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
  EXPECT_FALSE(taken("GET http://a/ HTTP/1.1\r\nHost: a\r\nHost: a\r\n\r\n"));
}

TEST(RequestHeadTest, EachRequestOfHttp11NamesAHost) {
  EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nX: y\r\n\r\n"), 400);
  EXPECT_EQ(refusal_of("GET http://a/ HTTP/1.1\r\n\r\n"), 400);
  EXPECT_EQ(refusal_of("GET / HTTP/1.0\r\n\r\n"), 0);
  for (const char* host :
       {"a b", "a/", "me@a", "a:b", "a:1:2", "[::1", "[::1]x", "[]", "a?", "\xc3\xa4"})
    EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n"), 400) << host;
  for (const char* host :
       {"", "a", "a:", "A_b.example:80", "127.0.0.1", "[::1]", "[fe80::1%25e]:80"})
    EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n"), 0) << host;
}

TEST(RequestHeadTest, ARefusalTellsWhatItIsFor) {
  const auto status_of = [](const std::string& line, const std::string& more = "") {
    return refusal_of(line + "\r\nHost: a\r\n" + more + "\r\n");
  };
  for (const char* method : {"BREW", "PROPFIND", "get", "PRI"})
    EXPECT_EQ(status_of(std::string(method) + " / HTTP/1.1"), 501) << method;
  for (const char* method : {"GET", "DELETE", "TRACE", "PATCH"})
    EXPECT_EQ(status_of(std::string(method) + " / HTTP/1.1"), 0) << method;
  EXPECT_EQ(status_of("GET / HTTP/2.0"), 505);
  EXPECT_EQ(status_of("GET / HTTP/9.9"), 505);
  for (const char* version : {"http/1.1", "HTTP/11", "HTTP/1.x", "HTTP/1.10", "HTTPS1.1"})
    EXPECT_EQ(status_of("GET / " + std::string(version)), 400) << version;
  const std::string path(kMostLineBytes - std::string("GET / HTTP/1.1").size(), 'a');
  EXPECT_EQ(status_of("GET /" + path + " HTTP/1.1"), 0);
  EXPECT_EQ(status_of("GET /" + path + "a HTTP/1.1"), 414);
  const std::string header = "X: " + std::string(kMostLineBytes - 3, 'a');
  EXPECT_EQ(status_of("GET / HTTP/1.1", header + "\r\n"), 0);
  EXPECT_EQ(status_of("GET / HTTP/1.1", header + "a\r\n"), 431);
}

TEST(RequestHeadTest, ANewerVersionOfTheSameKindIsReadAsThis) {
  EXPECT_EQ(taken("GET / HTTP/1.2\r\nHost: a\r\n\r\n")->text, "GET / HTTP/1.1\r\nHost: a\r\n\r\n");
}

TEST(RequestHeadTest, ATargetIsAPathOrAnAddress) {
  const auto status_of = [](const std::string& words) {
    return refusal_of(words + " HTTP/1.1\r\nHost: a\r\n\r\n");
  };
  for (const char* words : {"GET models.json", "GET *", "GET ftp://a/", "HEAD a:80", "OPTIONS **"})
    EXPECT_EQ(status_of(words), 400) << words;
  for (const char* words : {"OPTIONS *", "OPTIONS /", "CONNECT a:80"})
    EXPECT_EQ(status_of(words), 0) << words;
}

TEST(RequestHeadTest, WhoClosesTheConnectionSaysSoInAnyWords) {
  for (const char* value : {"close", "Close", "keep-alive, CLOSE", "x ,close"})
    EXPECT_TRUE(taken("GET / HTTP/1.0\r\nConnection: " + std::string(value) + "\r\n\r\n")->is_last)
        << value;
  for (const char* value : {"", "keep-alive", "closed", "x close"})
    EXPECT_FALSE(taken("GET / HTTP/1.0\r\nConnection: " + std::string(value) + "\r\n\r\n")->is_last)
        << value;
}

TEST(RequestHeadTest, LettersOfOtherScriptsMayBeInValues) {
  EXPECT_TRUE(taken("GET / HTTP/1.0\r\nX:\t\xc3\xa4 \r\n\r\n"));
}

TEST(RequestHeadTest, LinesThatOthersWouldSeeOtherwiseAreRefused) {
  for (const std::string& raw :
       {"GET / HTTP/1.1\r\nX: a\nRange: bytes=0-1\r\n\r\n"s, "GET / HTTP/1.1\nHost: a\n\n"s,
        "GET / HTTP/1.1\r\nX: a\rb\r\n\r\n"s, "GET /\0 HTTP/1.1\r\n\r\n"s, "GET / HTTP/1.1\r\n\r"s,
        "\n\r\n"s, "GET"s, "Range: bytes=0-1\r\n\r\n"s, "G(T / HTTP/1.1\r\n\r\n"s})
    EXPECT_EQ(refusal_of(raw), 400) << raw;
}

}  // namespace
}  // namespace meshhier::server
