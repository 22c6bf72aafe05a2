// `meshhier inspect` and `preview`.
#include "tests/app/command_line.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST_F(CommandLine, InspectTellsWhatIsInIt) {
  build();
  const Outcome text = run({"inspect", hierarchy()});
  EXPECT_EQ(text.code, 0) << text.messages;
  EXPECT_THAT(text.out, AllOf(HasSubstr("partitions"), HasSubstr("level")));

  const Outcome outcome = run({"inspect", hierarchy(), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  const json object = json::parse(outcome.out);
  EXPECT_EQ(object.at("source").at("vertices"), 2500);
  EXPECT_EQ(object.at("source").at("triangles"), 4802);
  EXPECT_EQ(object.at("partitions").at("count"), 5);
  EXPECT_EQ(object.at("partitions").at("vertices_min"), 500);
  EXPECT_EQ(object.at("partitions").at("vertices_max"), 500);
  EXPECT_EQ(object.at("levels").size(), 4u);
  EXPECT_LE(object.at("outline").at("bytes"), 32768);
  EXPECT_GT(object.at("total_bytes"), 0);
}

TEST_F(CommandLine, InspectOfALevelThatIsNotThereIsAUsageError) {
  build();
  EXPECT_EQ(run({"inspect", hierarchy(), "--level", "3", "--json"}).code, 0);
  EXPECT_EQ(run({"inspect", hierarchy(), "--node", "3/4"}).code, 0);
  const Outcome outcome = run({"inspect", hierarchy(), "--level", "9", "--json"});
  EXPECT_EQ(outcome.code, kUsage);
  EXPECT_THAT(outcome.messages, StartsWith("meshhier: "));
  EXPECT_EQ(run({"inspect", hierarchy(), "--node", "3/5", "--json"}).code, kUsage);
}

TEST_F(CommandLine, PreviewDrawsPictures) {
  build();
  const std::string png = (work() / "x.png").string(), webp = (work() / "x.WEBP").string();
  const Arguments basic{"preview", hierarchy(), "--size", "64x48", "-o"};
  const auto with = [&](Arguments more) {
    Arguments arguments = basic;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  const Outcome made = with({png, "--view", "30,20", "--level", "0"});
  EXPECT_EQ(made.code, 0) << made.messages;
  EXPECT_THAT(made.out, HasSubstr("64 x 48 pixels, 1 tile"));
  EXPECT_THAT(text_of(png), StartsWith("\x89PNG"));
  EXPECT_EQ(with({webp, "--view", "top", "--background", "#ffffff"}).code, 0);
  EXPECT_THAT(text_of(webp), StartsWith("RIFF"));
  EXPECT_EQ(with({png}).code, kExists);
  EXPECT_EQ(with({png, "--force"}).code, 0);
}

}  // namespace
}  // namespace meshhier::app
