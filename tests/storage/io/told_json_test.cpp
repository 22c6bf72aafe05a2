#include "storage/io/told_json.h"

#include <string>

#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

TEST(ToldJson, HasTheBytesOfNames) {
  const nlohmann::ordered_json value = {
      {"output", "a\xff.hier"},
      {"input", "\xc3\xa4.ply"},
      {"models", {{{"path", "\xff"}, {"code", 4}}, {{"path", "b"}}}}};
  const std::string told = told_json_text(value);
  EXPECT_EQ(told,
            "{\"output\":\"a\xef\xbf\xbd.hier\",\"output_escaped\":\"a%FF.hier\","
            "\"input\":\"\xc3\xa4.ply\",\"models\":[{\"path\":\"\xef\xbf\xbd\","
            "\"path_escaped\":\"%FF\",\"code\":4},{\"path\":\"b\"}]}");
  const auto again = parse_ordered_json_text(told);
  EXPECT_EQ(told_json_text(again), told) << "what was told already is handed on as it is";
  for (const char* plain : {"{}", "[]", "7", "\"a\"", "null", R"([{},[[{"a":[]}]]])"})
    EXPECT_EQ(told_json_text(parse_ordered_json_text(plain)), plain);
}

}  // namespace
}  // namespace meshhier::storage
