// `--header`: each line goes to one host.
#include "tests/app/command_line.h"
#include "tests/support/http_host.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::app {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(CommandLine, ALineForTheSecondHostNeverReachesTheFirstHoweverItIsWritten) {
  tests::HttpHost host([](const tests::HostRequest&) { return tests::answer_status(404); });
  const std::string headers = (work() / "headers.txt").string();
  write_text(headers, "X-Own: 1\n  http://localhost:1 X-Key: secret\n");
  const auto compare = [&](const std::string& header) {
    return run({"compare", host.url() + "a.3tz", "http://localhost:1/b.3tz", "--header", header});
  };
  for (const char* line :
       {" http://localhost:1\tX-Key: secret", "\thttp://localhost:1 X-Key:secret",
        "localhost:1 X-Key: secret", "LocalHost:1 X-Key:secret 1.2"})
    EXPECT_EQ(compare(line).code, kIo) << line;
  EXPECT_EQ(compare("@" + headers).code, kIo);
  for (const char* form : {"\"https://b.org X-Key: 123\"", "\"localhost:8080 X-Key: 123\""})
    EXPECT_THAT(run({"compare", "--help"}).out, HasSubstr(form));
  EXPECT_THAT(host.heads().back(), HasSubstr("X-Own: 1"));
  for (const char* address : {"http:/localhost:1", "HTTP:localhost:1", "https: //localhost:1",
                              "localhost:7912", "localhost:1:", "localhost", "b.org", "[::1]:1",
                              "https://localhost:1", "1.2.3.4:80", "user:1@b.org"}) {
    const Outcome outcome = compare(address + std::string(" X-Key: secret"));
    EXPECT_EQ(outcome.code, kUsage) << address;
    EXPECT_THAT(outcome.messages, Not(HasSubstr("secret")));
  }
  EXPECT_THAT(host.heads(), Each(Not(HasSubstr("secret"))));
}

TEST_F(CommandLine, AHeaderIsATokenAColonAndAValue) {
  tests::HttpHost host([](const tests::HostRequest&) { return tests::answer_status(404); });
  const auto inspect = [&](const std::string& header) {
    return run({"inspect", host.url() + "a.3tz", "--header", header}).code;
  };
  for (const char* line :
       {"X-Key: 1.2 b:3", "X-Key:7912", "x.y: 1", "X-Key:a b", "x!#$%&'*+-^_`|~: 1"}) {
    EXPECT_EQ(inspect(line), kIo) << line;
    EXPECT_THAT(host.heads().back(), HasSubstr(std::string("\r\n") + line)) << line;
  }
  const std::size_t requests = host.requests();
  for (const char* line : {"X-Key", ": 1", "X Key: 1", "X-Key : 1", "X-Key:1.2 b", "X(Key): 1",
                           "X-K\xc3\xa9y: 1", "", " "})
    EXPECT_EQ(inspect(line), kUsage) << line;
  EXPECT_EQ(host.requests(), requests);
}

}  // namespace
}  // namespace meshhier::app
