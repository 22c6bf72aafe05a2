#include "server/log_text.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;

constexpr LogTime kTime{milliseconds(1'796'015'240'007)};

std::string request_line(const std::string& target, LogFormat format = LogFormat::text) {
  return log_line(format, kTime, {"::1", "GET", target, 200, 12});
}

TEST(LogTextTest, LinesHaveTimeAndLevel) {
  EXPECT_EQ(utc_text(LogTime{}), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(utc_text(LogTime{milliseconds(951'782'399'999)}), "2000-02-28T23:59:59.999Z");
  EXPECT_EQ(log_line(LogFormat::text, kTime, LogLevel::warning, "a.ply: no texture"),
            "2026-11-30T05:07:20.007Z warning a.ply: no texture");
  const json line = json::parse(log_line(LogFormat::json, kTime, LogLevel::error, "a \"b\"\nc"));
  EXPECT_EQ(
      line,
      json({{"time", "2026-11-30T05:07:20.007Z"}, {"level", "error"}, {"message", "a \"b\"?c"}}));
}

TEST(LogTextTest, RequestsAreToldAsTheyCame) {
  EXPECT_EQ(
      request_line("/models.json?count=120&first=0&search=big%20house"),
      "2026-11-30T05:07:20.007Z info ::1 GET /models.json?count=120&first=0&search=big%20house "
      "200 12");
  const json line = json::parse(request_line("/models/a.hier/tiles.bin?build=1f", LogFormat::json));
  EXPECT_EQ(line.at("target"), "/models/a.hier/tiles.bin?build=1f");
  EXPECT_EQ(line.at("status"), 200);
  EXPECT_EQ(line.at("client"), "::1");
}

TEST(LogTextTest, SecretsInQueriesAreNotTold) {
  for (const std::string target :
       {"/metrics?token=geheim", "/?model=https://h/a.3tz?sig=geheim", "/?geheim", "/?&geheim",
        "/models.json?count=1&key=geheim&&x=geheim", "/a??geheim", "/a?build=1&Build=geheim"}) {
    EXPECT_THAT(request_line(target), Not(HasSubstr("geheim"))) << target;
  }
  EXPECT_THAT(request_line("/a?build=1&token=geheim"), HasSubstr("/a?build=1&token=... "));
}

TEST(LogTextTest, NoTargetEndsALine) {
  const std::string hostile = "/a\r\n2026 info forged\x1b[2J\x7f\xc2\x85 \xff\"\\";
  for (const LogFormat format : {LogFormat::text, LogFormat::json}) {
    for (const char c : request_line(hostile, format))
      EXPECT_TRUE(c >= ' ' && c < '\x7f');
  }
  EXPECT_THAT(request_line(hostile), HasSubstr("/a\\x0d\\x0a2026\\x20info\\x20forged\\x1b[2J"));
  EXPECT_NO_THROW(json::parse(request_line(hostile, LogFormat::json)));
  EXPECT_NO_THROW(json::parse(log_line(LogFormat::json, kTime, LogLevel::info, "\xff\xfe")));
  EXPECT_LT(request_line(std::string(100'000, '\n')).size(), 1000U);
}

}  // namespace
}  // namespace meshhier::server
