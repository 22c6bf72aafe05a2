#include "export/object_condition.h"

#include "tests/support/error_message.h"

#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::exporting {
namespace {

using testing::HasSubstr;

const std::vector<ObjectProperty> kProperties{
    {"height", ObjectPropertyType::number},  {"storey", ObjectPropertyType::number},
    {"listed", ObjectPropertyType::boolean}, {"owner", ObjectPropertyType::text},
    {"built", ObjectPropertyType::date},     {"Dach form", ObjectPropertyType::text}};

const ObjectRow kHouse{
    "Main Street/12", {12.5, 3.0, true, "Åse", "1911-05-17", {}}, std::nullopt, 10, 20.5};
const ObjectRow kBarn{"Main Street/barn", {{}, {}, {}, {}, {}, "flat"}, std::nullopt, 4, 8};

bool is_met(const std::string& text, const ObjectRow& row = kHouse) {
  return ObjectCondition(text, kProperties).is_met_by(row);
}

std::string fault(const std::string& text,
                  const std::vector<ObjectProperty>& properties = kProperties) {
  return tests::usage_error([&] { const ObjectCondition condition(text, properties); });
}

TEST(ObjectConditionTest, ValuesAreCompared) {
  for (const char* text : {"height = 12.5",
                           "height <> 12",
                           "height != 12",
                           "height > 12",
                           "height >= 12.5",
                           "-1 < height",
                           "height <= 1.25e1",
                           "3 = storey",
                           "height > storey",
                           "owner = 'Åse'",
                           "built < '1945-05-08'",
                           "built >= DATE('1911-05-17')",
                           "listed",
                           "listed = true",
                           "listed <> FALSE",
                           "not listed = false",
                           "area > 20",
                           "triangles = 10",
                           "name = 'Main Street/12'",
                           "\"height\" = 12.5",
                           "HEIGHT = 12.5",
                           "object.area > 20"})
    EXPECT_TRUE(is_met(text)) << text;
  for (const char* text : {"height = 12", "height < 12.5", "owner = 'åse'", "not listed",
                           "built > '1911-05-17'", "triangles > 10"})
    EXPECT_FALSE(is_met(text)) << text;
}

TEST(ObjectConditionTest, WordsBindAsInSql) {
  EXPECT_TRUE(is_met("storey = 3 or storey = 4 and height = 0")) << "and binds first";
  EXPECT_FALSE(is_met("(storey = 3 or storey = 4) and height = 0"));
  EXPECT_TRUE(is_met("not storey = 4 and height > 0")) << "not binds before and";
  EXPECT_TRUE(is_met("not (storey = 4 and height > 0)"));
  EXPECT_TRUE(is_met("storey between 3 and 4 and height > 1"));
  EXPECT_FALSE(is_met("STOREY NOT BETWEEN 3 AND 4"));
  EXPECT_TRUE(is_met("storey in (1, 3, 5)"));
  EXPECT_TRUE(is_met("owner not in ('it''s', 'nobody''s')"));
  EXPECT_TRUE(is_met("listed in (true)"));
}

TEST(ObjectConditionTest, ComparisonsWithNoValueAreUnknown) {
  EXPECT_TRUE(is_met("owner is null", kBarn));
  EXPECT_TRUE(is_met("owner is not null"));
  EXPECT_TRUE(is_met("\"Dach form\" = 'flat'", kBarn));
  for (const char* text : {"storey = 3", "storey <> 3", "not storey = 3", "storey in (3)", "listed",
                           "storey not in (3)", "not listed", "owner like '%'",
                           "owner not like 'x'", "storey between 1 and 9", "storey = height"})
    EXPECT_FALSE(is_met(text, kBarn)) << text;
  EXPECT_TRUE(is_met("storey = 3 or triangles = 4", kBarn));
  EXPECT_TRUE(is_met("not (storey = 3 and triangles = 5)", kBarn)) << "false whatever the storey";
  EXPECT_FALSE(is_met("not (storey = 3 and triangles = 4)", kBarn));
}

TEST(ObjectConditionTest, TextsAreLikePatterns) {
  EXPECT_TRUE(is_met("name like 'Main%'"));
  EXPECT_TRUE(is_met("name not like '%barn'"));
  EXPECT_TRUE(is_met("owner like '_se'")) << "a character of two bytes";
  EXPECT_TRUE(is_like("", ""));
  EXPECT_TRUE(is_like("", "%%"));
  EXPECT_FALSE(is_like("", "_"));
  EXPECT_TRUE(is_like("ab/cab/x", "%ab_x"));
  EXPECT_FALSE(is_like("abc", "ab"));
  EXPECT_FALSE(is_like("ABC", "abc"));
  EXPECT_TRUE(is_like("100%", "100\\%"));
  EXPECT_FALSE(is_like("1000", "100\\%"));
  EXPECT_TRUE(is_like("a\\b", "a\\\\b"));
  EXPECT_TRUE(is_like("a\\", "a\\")) << "a last backslash is itself";
  EXPECT_FALSE(is_like(std::string(3000, 'a'), std::string(100, '%') + "b")) << "ends soon";
}

TEST(ObjectConditionTest, FaultsTellTheirPlace) {
  const std::vector<std::array<std::string, 2>> faults{
      {"", "at character 1: expected a property or a value, but it ends"},
      {"stroey = 3",
       "at character 1: objects have no \"stroey\" (did you mean \"storey\"?); there "
       "are height, storey, listed, owner, built, Dach form, name, area, triangles"},
      {"owner = Åse", "at character 9: objects have no \"Åse\""},
      {"owner = 'Åse' nad height > 3", "at character 15: expected \"and\", \"or\" or the end"},
      {"storey = '3'", "at character 8: storey is a number, '3' is a text"},
      {"listed > 3", "listed is a boolean, 3 is a number"},
      {"storey like '3%'", "storey is a number, and only texts are like a pattern"},
      {"owner like name", "at character 12: expected a pattern in single quotes, found name"},
      {"storey in (1, '2')", "at character 15: storey is a number, '2' is a text"},
      {"storey in ()", "expected a property or a value, found )"},
      {"storey in (height)", "a list has numbers, texts or booleans"},
      {"storey = null", "what has no value is found by \"is null\""},
      {"owner = 'Åse", "at character 9: the text that begins here has no end"},
      {"\"Dach form = 'flat'", "the name in double quotes that begins here has no end"},
      {"(storey = 3", "expected \")\", but it ends"},
      {"storey == 3", "expected a property or a value, found ="},
      {"storey", "expected a comparison"},
      {"built < DATE('soon')", "at character 14: 'soon' is no date, as '2031-05-17' is"},
      {"storey = 3;", "at character 11: ; means nothing here"},
      {"storey = 3x", "this is no number"},
      {"storey = 1e999", "this is no number"},
      {"storey = -owner", "expected a number, found owner"},
      {"storey is 3", "expected \"null\", found 3"},
      {"owner = '\xC3'", "no UTF-8"},
      {std::string(1000, '(') + "listed" + std::string(1000, ')'), "too deep"},
      {std::string(65537, ' '), "65536 bytes at most"}};
  for (const auto& [text, said] : faults)
    EXPECT_THAT(fault(text), HasSubstr(said)) << text.substr(0, 40);
}

TEST(ObjectConditionTest, LongConditionsAreNotDeep) {
  std::string text = "listed";
  while (text.size() < 65500)
    text += " and listed";
  text.resize(65500 - (65500 - 6) % 11);
  EXPECT_TRUE(is_met(text));
  std::string list = "storey in (3";
  while (list.size() < 65500)
    list += ",99";
  EXPECT_TRUE(is_met(list + ")"));
}

TEST(ObjectConditionTest, PropertiesComeBeforeFacts) {
  const std::vector<ObjectProperty> properties{{"area", ObjectPropertyType::text},
                                               {"Area", ObjectPropertyType::number},
                                               {"AREA", ObjectPropertyType::number}};
  const ObjectRow row{"x", {"west", 1.0, 2.0}, std::nullopt, 1, 40};
  const auto met = [&](const std::string& text) {
    return ObjectCondition(text, properties).is_met_by(row);
  };
  EXPECT_TRUE(met("area = 'west' and Area = 1 and \"AREA\" = 2 and object.area = 40"));
  EXPECT_THAT(fault("aREA = 1", properties), HasSubstr("differ in the case of letters alone"));
  EXPECT_THAT(fault("\"aREa\" = 1", properties), HasSubstr("objects have no \"aREa\""));
}

}  // namespace
}  // namespace meshhier::exporting
