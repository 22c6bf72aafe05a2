#include "storage/io/json_text.h"

#include <cstddef>
#include <span>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

using nlohmann::json;

TEST(JsonText, IsOneLineOrIndented) {
  const nlohmann::ordered_json value = {{"b", 1}, {"a", {true, nullptr}}};
  EXPECT_EQ(json_text(value), R"({"b":1,"a":[true,null]})");
  EXPECT_EQ(json_text(json{{"b", 1}}, {.indent = 2}), "{\n  \"b\": 1\n}");
}

TEST(JsonText, HasUtf8Alone) {
  EXPECT_EQ(json_text(json("\xff")), "\"\xef\xbf\xbd\"");
  EXPECT_THROW(json_text(json("\xff"), {.throws = true}), json::type_error);
  EXPECT_EQ(json_text(json("\xc3\xa9"), {.only_ascii = true}), R"("\u00e9")");
}

TEST(JsonText, IsParsedAsItIsAskedFor) {
  EXPECT_EQ(parse_json_text("[1]", nullptr), json::array({1}));
  EXPECT_THROW(parse_json_text("[1", nullptr), json::parse_error);
  EXPECT_TRUE(parse_json_text("[1", nullptr, {.throws = false}).is_discarded());
  EXPECT_THROW(parse_ordered_json_text("[1] // one"), json::parse_error);
  EXPECT_EQ(parse_ordered_json_text("[1] // one", nullptr, {.takes_comments = true}).size(), 1U);
  const auto watch = [](int depth, json::parse_event_t, json&) { return depth < 1; };
  EXPECT_EQ(parse_json_text("[1, 2]", watch), json::array());
}

TEST(JsonText, IsJudgedWithoutKeepingIt) {
  EXPECT_TRUE(is_json(R"({"a": [1]})"));
  EXPECT_FALSE(is_json(R"({"a": [1])"));
  EXPECT_FALSE(is_json("{} {}"));
  EXPECT_FALSE(is_json(std::string(1 << 20, '[')));
}

/// Counts keys of the whole.
class Keys final : public JsonVisitor {
 public:
  bool key(string_t&) override {
    count += depth() == 1 ? 1 : 0;
    return true;
  }
  int count = 0;
};

bool visit(const std::string& text, Keys& keys) {
  std::size_t at = 0;
  return visit_json([&] { return at < text.size() ? static_cast<unsigned char>(text[at++]) : -1; },
                    keys);
}

TEST(JsonText, IsVisitedToItsEndOrItsFirstMistake) {
  Keys all, some, deep;
  EXPECT_TRUE(visit(R"({"a": {"x": 1}, "b": [{"y": 2}], "c": "\u00e9"})", all));
  EXPECT_EQ(all.count, 3);
  EXPECT_FALSE(visit(R"({"a": 1, "b": )", some));
  EXPECT_EQ(some.count, 2);
  EXPECT_FALSE(visit(std::string(2000, '[') + std::string(2000, ']'), deep));
}

TEST(JsonText, IsReadAgainFromCbor) {
  const json value = {{"a", {1, 2.5, "x"}}, {"b", json::binary({1, 2})}};
  const std::vector<std::uint8_t> bytes = cbor_of(value);
  const auto read = [](std::span<const std::uint8_t> part) {
    return parse_cbor(std::as_bytes(part));
  };
  EXPECT_EQ(read(bytes), value);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_TRUE(read(std::span(bytes).first(size)).is_discarded()) << size;
  std::vector<std::uint8_t> more = bytes;
  more.push_back(0);
  EXPECT_TRUE(read(more).is_discarded());
}

}  // namespace
}  // namespace meshhier::storage
