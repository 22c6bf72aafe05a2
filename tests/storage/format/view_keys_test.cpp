#include "storage/format/view_keys.h"

#include "storage/format/view_link.h"

#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

using testing::ElementsAre;
using Json = nlohmann::ordered_json;

Json cases() {
  std::ifstream file(MESHHIER_SOURCE_DIR "/tests/data/views.json");
  return Json::parse(file).at("views");
}

std::string pointer_of(const ViewProblem& problem) {
  return problem.key.empty() ? "/view" : "/view/" + problem.key;
}

TEST(ViewKeys, AgreeWithTheCasesThatThePageReads) {
  for (const Json& one : cases()) {
    SCOPED_TRACE(one.dump());
    const auto read = parse_view(one.at("view"));
    if (one.contains("problem")) {
      ASSERT_TRUE(std::holds_alternative<ViewProblem>(read));
      EXPECT_EQ(pointer_of(std::get<ViewProblem>(read)), one.at("problem"));
      continue;
    }
    ASSERT_TRUE(std::holds_alternative<ModelView>(read));
    const auto& view = std::get<ModelView>(read);
    EXPECT_EQ(view_json(view), one.contains("becomes") ? one.at("becomes") : one.at("view"));
    if (!one.contains("link"))
      continue;
    const auto link = one.at("link").get<std::string>();
    EXPECT_EQ(view_json(parse_view_link(link).value().view), one.at("view"));
    if (one.value("exact", false)) {
      EXPECT_EQ('#' + view_link(view), link);
    }
  }
}

TEST(ViewKeys, AreReadAgainAsTheyWereWritten) {
  for (const Json& one : cases()) {
    if (one.contains("problem"))
      continue;
    const auto view = std::get<ModelView>(parse_view(one.at("view")));
    EXPECT_EQ(std::get<ModelView>(parse_view(view_json(view))), view) << one;
  }
}

TEST(ViewLink, IsTheEndOfAnAddressAndTellsWhatIsNoView) {
  const auto link =
      parse_view_link("https://example.org/page/?model=a#b.hier&story=1.json&up=z&notes=x%20y");
  ASSERT_TRUE(link);
  EXPECT_EQ(link->view.up, "z");
  EXPECT_THAT(link->others, ElementsAre("notes", "story"));
  EXPECT_FALSE(parse_view_link("https://example.org/?up=z"));
}

TEST(ViewLink, TakesWhatNobodyVouchesFor) {
  const std::vector<std::string> links{"#&&&=&=x&wires&%&attribute=%ff%zz%0&hide=",
                                       std::string("#") + '\0',
                                       "#&measure=" + std::string(100000, '1'),
                                       "#&range=1e999,0",
                                       "#&light=,,,",
                                       "#&camera=1"};
  for (const std::string& link : links)
    EXPECT_TRUE(parse_view_link(link)) << link.substr(0, 80);
}

}  // namespace
}  // namespace meshhier::storage
