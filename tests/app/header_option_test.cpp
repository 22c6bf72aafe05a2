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
  for (const char* blanks : {" ", "\t", "  "})
    EXPECT_EQ(compare(blanks + std::string("http://localhost:1\tX-Key: secret")).code, kIo);
  EXPECT_EQ(compare("@" + headers).code, kIo);
  EXPECT_THAT(host.heads().back(), HasSubstr("X-Own: 1"));
  for (const char* address : {"http:/localhost:1", "HTTP:localhost:1", "https: //localhost:1"}) {
    const Outcome outcome = compare(address + std::string(" X-Key: secret"));
    EXPECT_EQ(outcome.code, kUsage) << address;
    EXPECT_THAT(outcome.messages, Not(HasSubstr("secret")));
  }
  EXPECT_THAT(host.heads(), Each(Not(HasSubstr("secret"))));
}

}  // namespace
}  // namespace meshhier::app
