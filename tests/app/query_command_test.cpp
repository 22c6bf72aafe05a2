// `meshhier query`.
#include "tests/app/command_line.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST_F(CommandLine, QueryAnswersPointsAndRays) {
  build();
  const std::string points = (work() / "p.txt").string(), rays = (work() / "r.csv").string();
  write_text(points, "# scanner\n0 0 -2\n");
  write_text(rays, "name,x,y,z,dx,dy,dz\nfirst,24.25,24.25,-100,0,0,2\nbeside,99,99,0,0,0,1\n");
  const Outcome near = run({"query", hierarchy(), "--points", points});
  EXPECT_EQ(near.code, 0) << near.messages;
  EXPECT_THAT(near.out, StartsWith("distance,x,y,z,level,index,triangle\n2,0,0,0,"));
  EXPECT_THAT(near.messages, StartsWith("1 point; distances 2 to 2; "));
  const Outcome hits =
      run({"query", hierarchy(), "--rays", rays, "--json", "-o", (work() / "hits.npy").string()});
  EXPECT_EQ(hits.code, 0) << hits.messages;
  EXPECT_THAT(text_of(work() / "hits.npy"), StartsWith("\x93NUMPY"));
  const auto told = nlohmann::json::parse(hits.out);
  EXPECT_EQ(told.at("rows"), 2);
  EXPECT_EQ(told.at("hits"), 1);
}

TEST_F(CommandLine, QueryRefusesWhatMakesNoSense) {
  build();
  const std::string points = (work() / "p.txt").string(), out = (work() / "out.csv").string();
  write_text(points, "0 0 0\n");
  EXPECT_THAT(run({"query", hierarchy()}).messages, HasSubstr("--points"));
  EXPECT_EQ(run({"query", hierarchy(), "--points", points, "--rays", points}).code, kUsage);
  EXPECT_EQ(run({"query", hierarchy(), "--rays", points, "--signed"}).code, kUsage);
  EXPECT_EQ(run({"query", hierarchy(), "--points", points, "--level", "30"}).code, kUsage);
  EXPECT_EQ(run({"query", hierarchy(), "--points", points, "--format", "xls"}).code, kUsage);
  EXPECT_EQ(run({"query", hierarchy(), "--points", (work() / "none").string()}).code, kIo);
  EXPECT_EQ(run({"query", hierarchy(), "--rays", points}).code, kInput);
  EXPECT_EQ(run({"query", (work() / "none.hier").string(), "--points", points}).code, kIo);
  ASSERT_EQ(run({"query", hierarchy(), "--points", points, "-o", out}).code, 0);
  EXPECT_EQ(run({"query", hierarchy(), "--points", points, "-o", out}).code, kExists);
  EXPECT_EQ(run({"query", hierarchy(), "--points", points, "-o", out, "--force"}).code, 0);
}

}  // namespace
}  // namespace meshhier::app
