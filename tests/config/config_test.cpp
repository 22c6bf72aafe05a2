#include "config/config.h"

#include "base/error.h"
#include "config/config_reference.h"
#include "config/config_schema.h"
#include "config/suggest.h"
#include "config/view_config.h"
#include "execution/size_text.h"
#include "tests/support/error_message.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <regex.h>

namespace meshhier::config {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;
using Overrides = std::vector<std::string>;

Config parse(const std::string& text, const Overrides& overrides = {}) {
  return parse_config(text, {"config.json", "/data/scans"}, overrides);
}

/// A whole config with these keys besides the required ones.
std::string with(const std::string& keys) {
  return R"({"input": "a.ply", "output": "a.hier")" + (keys.empty() ? "" : ", " + keys) + "}";
}

/// The message of the usage error that parsing must end with.
std::string refusal(const std::string& text, const Overrides& overrides = {}) {
  const std::string message = tests::usage_error([&] { parse(text, overrides); });
  EXPECT_NE(message, "") << "accepted: " << text;
  return message;
}

// ---- objects

TEST(Config, ObjectsComeFromASourceOrALabel) {
  const auto from_of = [](const std::string& keys) { return parse(with(keys)).objects.from; };
  EXPECT_TRUE(from_of("").is_evident());
  EXPECT_TRUE(from_of(R"("objects": "auto")").is_evident());
  EXPECT_EQ(from_of(R"("objects": "node")").from, mesh_io::ObjectSource::node);
  EXPECT_EQ(from_of(R"("objects": {"from": "none"})").from, mesh_io::ObjectSource::none);
  EXPECT_EQ(from_of(R"("objects": {"from": "label:bone"})"),
            (mesh_io::ObjectChoice{mesh_io::ObjectSource::label, "bone"}));
  EXPECT_EQ(parse(with(""), {"objects.from=solid"}).objects.from.from,
            mesh_io::ObjectSource::solid);
  for (const char* wrong : {R"("nodes")", R"({"from": "label"})", R"({"from": "label:"})",
                            R"({"from": "label:a b"})", R"({"from": 7})", R"(["node"])"})
    EXPECT_THAT(refusal(with(std::string(R"("objects": )") + wrong)), HasSubstr("objects"))
        << wrong;
}

TEST(Config, ATableOfObjectsLiesBesideTheConfig) {
  EXPECT_EQ(parse(with(R"("objects": {"table": "b.csv"})")).objects.table, "/data/scans/b.csv");
  EXPECT_TRUE(parse(with(R"("objects": {"table": "b.csv"})")).objects.in_tiles);
  EXPECT_FALSE(parse(with(R"("objects": {"in_tiles": false})")).objects.in_tiles);
  EXPECT_THAT(refusal(with(R"("objects": {"from": "none", "table": "b.csv"})")),
              HasSubstr("expected objects for its rows"));
  EXPECT_THAT(refusal(with(R"("objects": {"table": ""})")), HasSubstr("objects.table"));
  EXPECT_THAT(refusal(with(R"("objects": {"tables": "b.csv"})")), HasSubstr("tables"));
}

TEST(Config, ALabelThatIsNotReadMakesNoObjects) {
  EXPECT_THAT(refusal(with(R"("attributes": ["a"], "objects": "label:b")")),
              HasSubstr("the label \"b\" is not read"));
  parse(with(R"("attributes": ["a", "b"], "objects": "label:b")"));
}

TEST(Config, WhatObjectsAreByDefaultIsNotTold) {
  const auto told = [](const std::string& keys) {
    const Json all = resolved_json(parse(with(keys)));
    return all.contains("objects") ? all["objects"].dump() : "";
  };
  EXPECT_EQ(told(""), "");
  EXPECT_EQ(told(R"("objects": {"from": "auto", "in_tiles": true})"), "");
  EXPECT_EQ(told(R"("objects": {"from": "label:x", "in_tiles": false})"),
            R"({"from":"label:x","in_tiles":false})");
}

// ---- values

TEST(Config, OnlyInputAndOutputAreRequired) {
  const Config config = parse(with(""));
  Config expected;
  expected.input = "/data/scans/a.ply";
  expected.output = "/data/scans/a.hier";
  EXPECT_EQ(config, expected);
  EXPECT_EQ(config.partition.vertices, 8192u);
  EXPECT_EQ(config.memory_budget, std::nullopt) << "the machine decides";
}

TEST(Config, EveryKeyIsRead) {
  const Config config = parse(with(R"("memory_budget": "64MiB", "threads": 3,
      "partition": {"count": 128, "axis": "longest"},
      "simplify": {"method": "cluster", "vertices": 4096, "representative": "vertex",
                   "cost": "melax"},
      "outline": {"sectors": 64, "tolerance": 0.01},
      "storage": {"compression": "meshopt", "positions": {"bits": 14}, "normals": "none"})"));
  EXPECT_EQ(config.memory_budget, 64u << 20);
  EXPECT_EQ(config.threads, 3u);
  EXPECT_EQ(config.partition.count, 128u);
  EXPECT_EQ(config.partition.axis, config::AxisRule::longest);
  EXPECT_EQ(config.simplify.method, config::SimplifyMethod::cluster);
  EXPECT_EQ(config.simplify.vertices, 4096u);
  EXPECT_EQ(config.simplify.representative, config::Representative::vertex);
  EXPECT_EQ(config.simplify.cost, config::HalfEdgeCost::melax);
  EXPECT_EQ(config.outline.sectors, 64u);
  EXPECT_EQ(config.outline.tolerance, 0.01);
  EXPECT_EQ(config.storage.compression, storage::Compression::meshopt);
  EXPECT_EQ(config.storage.position_bits, 14u);
  EXPECT_EQ(config.storage.normals, config::Normals::none);
  EXPECT_EQ(parse(with(R"("simplify": {"representative": "mean"})")).simplify.representative,
            config::Representative::mean);
}

TEST(Config, TheContainerIsReadAndDecidesNothingOfTheFiles) {
  const Config config = parse(with(R"("storage": {"container": "3tz"})"));
  EXPECT_EQ(config.storage.container, storage::Container::archive);
  EXPECT_EQ(parse(with(R"("storage": {"container": "files"})")), parse(with("")));
  EXPECT_EQ(resolved_json(config), resolved_json(parse(with(""))));
}

TEST(Config, KeysTwoLevelsDeepAreOverriddenAndResolved) {
  const std::vector<std::string> overrides{"storage.positions.bits=16", "storage.compression=zlib"};
  const Config config =
      parse_config(with(R"("storage": {"positions": {"bits": 12}})"), {"a.json", {}}, overrides);
  EXPECT_EQ(config.storage.position_bits, 16u);
  EXPECT_EQ(resolved_json(config)["storage"].dump(),
            R"({"compression":"zlib","positions":{"bits":16},"normals":"auto"})");
  EXPECT_EQ(parse_config(with(""), {"a.json", {}}, overrides), config);
  const std::vector<std::string> whole{R"(storage={"positions": {"bits": 4}})"};
  try {
    parse_config(with(""), {"a.json", {}}, whole);
    ADD_FAILURE() << "4 bits are accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "--set storage.positions.bits: expected an integer from 8 to 24, found the number 4");
  }
}

TEST(Config, CommentsOfBothKindsAreSkipped) {
  const Config config =
      parse("// first\n{ /* in */ \"input\": \"a.ply\", // here\n \"output\": \"b\" }\n// last");
  EXPECT_EQ(config.output, "/data/scans/b");
}

TEST(Config, ABudgetMayBeANumberOfBytes) {
  EXPECT_EQ(parse(with(R"("memory_budget": 100000000)")).memory_budget, 100'000'000u);
  EXPECT_EQ(parse(with(R"("memory_budget": "1.5 GiB")")).memory_budget, std::uint64_t{1536} << 20);
}

TEST(Config, AWholeNumberMayBeWrittenAsAFraction) {
  EXPECT_EQ(parse(with(R"("partition": {"vertices": 1e3})")).partition.vertices, 1000u);
}

TEST(Config, LimitsAreInclusive) {
  EXPECT_EQ(parse(with(R"("partition": {"vertices": 4})")).partition.vertices, 4u);
  EXPECT_EQ(parse(with(R"("partition": {"vertices": 32768})")).partition.vertices, 32768u);
  EXPECT_EQ(parse(with(R"("partition": {"count": 1})")).partition.count, 1u);
  EXPECT_EQ(parse(with(R"("partition": {"count": 1073741824})")).partition.count, 1073741824u);
  EXPECT_EQ(parse(with(R"("outline": {"tolerance": 1})")).outline.tolerance, 1.0);
}

// ---- vertices by level

Config with_tile_vertices(const std::string& vertices) {
  return parse(with(R"("simplify": {"vertices": )" + vertices + "}"));
}

std::string tile_vertices_refusal(const std::string& vertices) {
  return refusal(with(R"("simplify": {"vertices": )" + vertices + "}"));
}

TEST(ConfigLevels, AreANumberOrAListFromTheRootDown) {
  EXPECT_EQ(with_tile_vertices("300").simplify.vertices, 300U);
  EXPECT_EQ(with_tile_vertices("[937, 5.73e2, 4, 32768]").simplify.vertices,
            TargetVertexCounts({937, 573, 4, 32768}));
  EXPECT_EQ(parse(with(""), {"simplify.vertices=[100,200]"}).simplify.vertices,
            TargetVertexCounts({100, 200}));
  EXPECT_EQ(with_tile_vertices(Json(std::vector<int>(32, 50)).dump()).simplify.vertices,
            TargetVertexCounts(std::vector<std::uint32_t>(32, 50)));
}

TEST(ConfigLevels, AListOfOneIsTheNumber) {
  EXPECT_EQ(with_tile_vertices("[300]"), with_tile_vertices("300"));
}

TEST(ConfigLevels, ALengthThatCannotBeIsNamed) {
  const std::string expected =
      "config.json: simplify.vertices: expected an integer from 4 to 32768 or a list of 1 to 32 of "
      "them, found ";
  EXPECT_EQ(tile_vertices_refusal("[]"), expected + "an empty list");
  EXPECT_EQ(tile_vertices_refusal(Json(std::vector<int>(33, 50)).dump()),
            expected + "a list of 33");
  EXPECT_EQ(tile_vertices_refusal("3"), expected + "the number 3");
  EXPECT_EQ(tile_vertices_refusal("32769"), expected + "the number 32769");
  EXPECT_EQ(tile_vertices_refusal("\"100, 200\""), expected + "the string \"100, 200\"");
  EXPECT_EQ(tile_vertices_refusal("{\"0\": 100}"), expected + "an object");
  EXPECT_EQ(tile_vertices_refusal("null"), expected + "null");
  EXPECT_EQ(tile_vertices_refusal("true"), expected + "true");
}

TEST(ConfigLevels, AWrongEntryIsNamedByItsLevel) {
  const std::string expected = "]: expected an integer from 4 to 32768, found ";
  const std::string key = "config.json: simplify.vertices[";
  EXPECT_EQ(tile_vertices_refusal("[3]"), key + "0" + expected + "the number 3");
  EXPECT_EQ(tile_vertices_refusal("[100, 50, 32769, 2]"),
            key + "2" + expected + "the number 32769");
  EXPECT_EQ(tile_vertices_refusal("[100, -50]"), key + "1" + expected + "the number -50");
  EXPECT_EQ(tile_vertices_refusal("[100.5]"), key + "0" + expected + "the number 100.5");
  EXPECT_EQ(tile_vertices_refusal("[100, \"50\"]"), key + "1" + expected + "the string \"50\"");
  EXPECT_EQ(tile_vertices_refusal("[100, null]"), key + "1" + expected + "null");
  EXPECT_EQ(tile_vertices_refusal("[[100, 50]]"), key + "0" + expected + "a list");
  EXPECT_EQ(refusal(with(""), {"simplify.vertices=[100,2]"}),
            "--set simplify.vertices[1]" + expected.substr(1) + "the number 2");
}

TEST(ConfigLevels, PartitionsHaveNone) {
  EXPECT_EQ(refusal(with(R"("partition": {"vertices": [100, 200]})")),
            "config.json: partition.vertices: expected an integer from 4 to 32768, found a list");
}

// ---- paths

TEST(ConfigPaths, AreRelativeToTheConfig) {
  const Config config = parse(R"({"input": "../raw/./a.ply", "output": "out/a.hier/"})");
  EXPECT_EQ(config.input, "/data/raw/a.ply");
  EXPECT_EQ(config.output.string(), "/data/scans/out/a.hier");
}

TEST(ConfigPaths, AbsoluteOnesStay) {
  EXPECT_EQ(parse(R"({"input": "/x/a.ply", "output": "b"})").input, "/x/a.ply");
}

TEST(ConfigPaths, OverridesAreRelativeToTheCurrentDirectory) {
  const Config config = parse(with(""), {"output=results/b.hier"});
  EXPECT_EQ(config.output, "results/b.hier");
  EXPECT_EQ(config.input, "/data/scans/a.ply");
}

TEST(ConfigPaths, AnOutputThatHoldsTheInputIsRefused) {
  for (const char* output : {"a.ply", "/data/scans", "/data", "..", "../scans/x/..", "/"}) {
    const Json text{{"input", "a.ply"}, {"output", output}};
    EXPECT_THAT(refusal(text.dump()), StartsWith("config.json: output: ")) << output;
  }
  EXPECT_NO_THROW(parse(R"({"input": "a.ply", "output": "a.pl"})"));
}

TEST(ConfigPaths, AnEmptyOneIsRefused) {
  EXPECT_THAT(refusal(R"({"input": "", "output": "b"})"),
              AllOf(HasSubstr("config.json: input: expected a path"), HasSubstr("\"\"")));
  EXPECT_THAT(refusal(R"({"input": "a\u0000b", "output": "b"})"),
              HasSubstr("input: expected a path"));
}

// ---- mistakes

TEST(ConfigErrors, UnknownKeysAreNamedWithTheNearestKnownOne) {
  EXPECT_EQ(
      refusal(with(R"("partition": {"vertexes": 5})")),
      "config.json: unknown key \"partition.vertexes\"; did you mean \"partition.vertices\"?");
  EXPECT_EQ(refusal(with(R"("memory_buget": 5)")),
            "config.json: unknown key \"memory_buget\"; did you mean \"memory_budget\"?");
  EXPECT_EQ(
      refusal(with(R"("representative": "mean")")),
      "config.json: unknown key \"representative\"; did you mean \"simplify.representative\"?");
  EXPECT_EQ(refusal(with(R"("zzzzzzzzzzzz": 5)")), "config.json: unknown key \"zzzzzzzzzzzz\"");
  EXPECT_THAT(refusal(with(R"("partition": {"": 5})")), HasSubstr("unknown key \"partition.\""));
}

TEST(ConfigErrors, ADottedKeyInTheFileIsExplained) {
  EXPECT_THAT(refusal(with(R"("partition.vertices": 5)")),
              HasSubstr(R"(write "partition": { "vertices": ... })"));
}

TEST(ConfigErrors, IllTypedValuesNameKeyExpectedAndFound) {
  EXPECT_EQ(refusal(with(R"("partition": {"vertices": "many"})")),
            "config.json: partition.vertices: expected an integer from 4 to 32768, found the "
            "string \"many\"");
  EXPECT_EQ(
      refusal(with(R"("partition": {"vertices": 5.5})")),
      "config.json: partition.vertices: expected an integer from 4 to 32768, found the number 5.5");
  EXPECT_EQ(refusal(with(R"("outline": {"tolerance": null})")),
            "config.json: outline.tolerance: expected a number above 0 and at most 1, found null");
  EXPECT_EQ(refusal(with(R"("threads": true)")),
            "config.json: threads: expected an integer from 0 to 4096, found true");
  EXPECT_EQ(refusal(with(R"("partition": 7)")),
            "config.json: partition: expected an object, found the number 7");
  EXPECT_EQ(refusal(R"({"input": "a", "output": ["b"]})"),
            "config.json: output: expected a path, found a list");
  EXPECT_EQ(refusal(with(R"("$schema": 1)")),
            "config.json: $schema: expected a string of at most 32768 bytes, found the number 1");
  EXPECT_THAT(refusal(with(R"("memory_budget": "512MiBs")")),
              AllOf(HasSubstr("memory_budget: expected a size such as"),
                    HasSubstr("found the string \"512MiBs\"")));
}

TEST(ConfigErrors, OutOfRangeValuesAreRefused) {
  for (const char* keys :
       {R"("partition": {"vertices": 3})", R"("partition": {"vertices": 32769})",
        R"("partition": {"vertices": -1})", R"("partition": {"vertices": 18446744073709551615})",
        R"("partition": {"vertices": 4294967300})", R"("partition": {"count": 0})",
        R"("partition": {"count": 1073741825})", R"("simplify": {"vertices": 2})",
        R"("outline": {"sectors": 0})", R"("outline": {"tolerance": 0})",
        R"("outline": {"tolerance": -0.5})", R"("outline": {"tolerance": 1.1})",
        R"("memory_budget": 0)", R"("memory_budget": -5)", R"("memory_budget": "0")",
        R"("memory_budget": 0.5)", R"("memory_budget": 9007199254740992)", R"("threads": -1)",
        R"("threads": 100000)"}) {
    EXPECT_THAT(refusal(with(keys)), HasSubstr("expected")) << keys;
  }
}

TEST(ConfigErrors, UnknownChoicesAreNamedWithTheNearest) {
  EXPECT_EQ(
      refusal(with(R"("partition": {"axis": "compactnes"})")),
      "config.json: partition.axis: expected one of \"compactness\", \"longest\", found the string "
      "\"compactnes\"; did you mean \"compactness\"?");
  EXPECT_EQ(refusal(with(R"("simplify": {"method": "nanite"})")),
            "config.json: simplify.method: expected one of \"edge_collapse\", \"half_edge\", "
            "\"cluster\", found the string \"nanite\"");
}

TEST(ConfigErrors, VerticesAndCountExcludeEachOther) {
  EXPECT_EQ(
      refusal(with(R"("partition": {"vertices": 100, "count": 7})")),
      "config.json: partition: expected either \"vertices\" or \"count\", found both; remove one");
}

TEST(Config, APlaceOrATransformPutsTheModelSomewhere) {
  const PlacementConfig place =
      parse(with(R"("placement": {"longitude": -7.5, "latitude": 90, "anchor": [1, 2, 3.5]})"))
          .placement;
  EXPECT_EQ(place.longitude, -7.5);
  EXPECT_EQ(place.latitude, 90);
  EXPECT_EQ(place.height, std::nullopt);
  EXPECT_EQ(place.anchor, (std::array<double, 3>{1, 2, 3.5}));
  const Config moved =
      parse(with(R"("up": "z", "placement": {"transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]})"));
  EXPECT_EQ(moved.up, UpAxis::z);
  EXPECT_EQ(moved.placement.transform.value()[14], 7);
}

TEST(Config, AFirstViewIsTwoAngles) {
  EXPECT_EQ(parse(with(R"("preview": true)")).first_view.standpoint(), std::nullopt);
  const Config config = parse(with(R"("first_view": {"azimuth": -30.5, "elevation": 90})"));
  EXPECT_EQ(config.first_view.standpoint(), (Standpoint{-30.5, 90}));
  EXPECT_EQ(resolved_json(config)["first_view"].dump(), R"({"azimuth":-30.5,"elevation":90.0})");
  EXPECT_EQ(parse(with(R"("first_view": {"azimuth": 0, "elevation": -90})")).first_view.elevation,
            -90);
  EXPECT_THAT(refusal(with(R"("first_view": {"azimuth": 3})")),
              HasSubstr("expected both \"azimuth\" and \"elevation\""));
  EXPECT_THAT(refusal(with(R"("first_view": {"azimuth": 3, "elevation": 91})")),
              HasSubstr("expected a number from -90 to 90"));
}

TEST(ConfigErrors, HalfAPlaceAndTwoPlacesAreRefused) {
  EXPECT_THAT(refusal(with(R"("placement": {"longitude": 1})")),
              HasSubstr("expected both \"longitude\" and \"latitude\""));
  EXPECT_THAT(refusal(with(R"("placement": {"height": 1})")), HasSubstr("expected both"));
  EXPECT_THAT(refusal(with(R"("placement": {"longitude": 1, "latitude": 2,
                               "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]})")),
              HasSubstr("found more than one"));
  EXPECT_THAT(refusal(with(R"("placement": {"transform": [1, 2]})")),
              HasSubstr("expected a list of 16 numbers, found a list"));
  EXPECT_THAT(refusal(with(R"("placement": {"longitude": 181, "latitude": 2})")),
              HasSubstr("expected a number above -180 and at most 180"));
}

TEST(ConfigErrors, MissingKeysAreNamed) {
  EXPECT_EQ(refusal(R"({"output": "b"})"),
            "config.json: input is missing: expected a path or a list of 1 to 100000 paths");
  EXPECT_EQ(refusal(R"({"input": "b"})"), "config.json: output is missing: expected a path");
}

TEST(ConfigErrors, AKeyThatIsThereTwiceIsRefused) {
  EXPECT_EQ(
      refusal(
          R"({"input": "a", "output": "b", "partition": {"count": 1, "axis": "longest", "count": 2}})"),
      "config.json: partition.count: this key is there twice; remove one");
  EXPECT_EQ(refusal(R"({"input": "a", "output": "b", "outline": {"sectors": 1}, "input": "a"})"),
            "config.json: input: this key is there twice; remove one");
}

TEST(ConfigErrors, BrokenJsonIsLocated) {
  EXPECT_THAT(
      refusal("{\n  \"input\": \"a.ply\",\n  \"output\" \"b\"\n}"),
      AllOf(StartsWith("config.json: line 3, column 14: "), Not(HasSubstr("json.exception"))));
  EXPECT_THAT(refusal(""), StartsWith("config.json: line 1, column 1: "));
  EXPECT_THAT(refusal("{\"input\": \"a\", \"output\": \"b\",}"), HasSubstr("trailing commas"));
  EXPECT_THAT(refusal("{\"threads\": 1e999}"), StartsWith("config.json: "));
  EXPECT_EQ(refusal("[1]"),
            "config.json: expected an object with the keys of a config, found a list");
}

TEST(ConfigErrors, DeepNestingIsRefusedWithoutRecursion) {
  EXPECT_THAT(refusal(std::string(500'000, '[')), HasSubstr("nested too deeply"));
  std::string objects;
  for (int i = 0; i < 100'000; ++i)
    objects += "{\"a\":";
  EXPECT_THAT(refusal(objects), HasSubstr("nested too deeply"));
}

TEST(ConfigErrors, AMillionKeysAreRefusedAtOnce) {
  std::string keys = "{\"input\": \"a\"";
  for (int i = 0; i < 80'000; ++i)
    keys += ",\"" + std::to_string(i) + "\":0";
  EXPECT_THAT(refusal(keys + "}"), HasSubstr("found more than 256 keys"));
}

TEST(ConfigErrors, WhatIsQuotedIsShortAndPlain) {
  const std::string escape = "\x1b[2J";
  const std::string long_word(100'000, 'k');
  const std::vector<std::string> messages = {
      refusal("{\x7f"),
      refusal('"' + escape),
      refusal('"' + long_word),
      refusal("{\"" + long_word + "\": 1}"),
      refusal("{\"\\u001b[2J\": 1}"),
      refusal("{\"\\u001b\": 1, \"\\u001b\": 2}"),
      refusal("{\"" + long_word + "\": 1, \"" + long_word + "\": 2}"),
      refusal(R"({"input": "a\u001b/b", "output": "a\u001b"})"),
      refusal("{\"input\": \"a\", \"output\": \"" + long_word + "/..\"}"),
      refusal(with(""), {escape + long_word}),
      refusal(with(""), {escape + long_word + "=1"}),
      refusal(with(""), {"threads=\"" + escape + long_word + '"'})};
  for (const std::string& message : messages) {
    EXPECT_LT(message.size(), 500U) << message.substr(0, 200);
    EXPECT_EQ(message.find_first_of("\x1b\x7f"), std::string::npos) << message.substr(0, 200);
  }
}

TEST(ConfigErrors, AnyDamageEndsInAUsageErrorOrAConfig) {
  const std::string whole =
      with(R"("memory_budget": "64MiB", "partition": {"count": 128, "axis": "longest"},
      "outline": {"sectors": 64, "tolerance": 0.01})");
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const char letter : {'\0', '"', '{', '}', '9', '-', '\xff', '\n'}) {
      std::string damaged = whole;
      damaged[at] = letter;
      for (const std::string& text : {damaged, whole.substr(0, at)}) {
        try {
          parse(text);
        } catch (const Error& error) {
          ASSERT_EQ(error.code(), ErrorCode::usage) << text;
          ++refused;
        }
      }
    }
  }
  EXPECT_GT(refused, 1000);
}

// ---- overrides

TEST(ConfigOverrides, ReplaceValuesInOrder) {
  const Config config =
      parse(with(R"("threads": 3)"),
            {"threads=5", "outline.tolerance=0.5", "partition.axis=longest", "memory_budget=2GiB",
             "simplify.representative=\"mean\"", "threads=6", "partition.vertices=500"});
  EXPECT_EQ(config.threads, 6u);
  EXPECT_EQ(config.outline.tolerance, 0.5);
  EXPECT_EQ(config.partition.axis, config::AxisRule::longest);
  EXPECT_EQ(config.memory_budget, std::uint64_t{2} << 30);
  EXPECT_EQ(config.simplify.representative, config::Representative::mean);
  EXPECT_EQ(config.partition.vertices, 500u);
}

TEST(ConfigOverrides, APathOfDigitsIsAPath) {
  EXPECT_EQ(parse(with(""), {"output=2024"}).output, "2024");
}

TEST(ConfigOverrides, AValueMayHoldTheSign) {
  EXPECT_EQ(parse(with(""), {"output=a=b"}).output, "a=b");
}

TEST(ConfigOverrides, AWholeSectionMayBeGiven) {
  const Config config =
      parse(with(R"("partition": {"vertices": 50})"), {"partition={\"count\": 9}"});
  EXPECT_EQ(config.partition.count, 9u);
}

TEST(ConfigOverrides, VerticesAndCountReplaceEachOther) {
  const std::string vertices = with(R"("partition": {"vertices": 100, "axis": "longest"})");
  const Config counted = parse(vertices, {"partition.count=7"});
  EXPECT_EQ(counted.partition.count, 7u);
  EXPECT_EQ(counted.partition.axis, config::AxisRule::longest);
  const Config sized = parse(with(R"("partition": {"count": 7})"), {"partition.vertices=100"});
  EXPECT_EQ(sized.partition.count, std::nullopt);
  EXPECT_EQ(sized.partition.vertices, 100u);
  EXPECT_THAT(refusal(vertices, {"partition.count=7", "partition.vertices=9"}),
              HasSubstr("found both"));
}

TEST(ConfigOverrides, MistakesAreBlamedOnTheOverride) {
  EXPECT_EQ(refusal(with(""), {"partition={\"count\": 1, \"count\": 2}"}),
            "--set partition: count: this key is there twice; remove one");
  EXPECT_THAT(refusal(with(""), {"partition=" + std::string(1000, '[')}),
              HasSubstr("--set partition: expected a config, found values nested too deeply"));
  EXPECT_EQ(
      refusal(with(""), {"partition.vertices=abc"}),
      "--set partition.vertices: expected an integer from 4 to 32768, found the string \"abc\"");
  EXPECT_EQ(refusal(with(""), {"partition.vertics=5"}),
            "--set: unknown key \"partition.vertics\"; did you mean \"partition.vertices\"?");
  EXPECT_EQ(refusal(with(""), {"treads=5"}),
            "--set: unknown key \"treads\"; did you mean \"threads\"?");
  EXPECT_EQ(refusal(with(""), {"partiton.count=5"}),
            "--set: unknown key \"partiton.count\"; did you mean \"partition.count\"?");
  EXPECT_EQ(refusal(with(""), {"output="}), "--set output: expected a path, found the string \"\"");
  EXPECT_THAT(refusal(with(""), {"threads"}), HasSubstr("--set: expected key=value"));
  EXPECT_THAT(refusal(with(""), {"=5"}), HasSubstr("--set: expected key=value"));
  EXPECT_THAT(refusal(with(""), {"input.x=5"}), HasSubstr("unknown key \"input.x\""));
  EXPECT_THAT(refusal(with(""), {"a..b=5"}), HasSubstr("unknown key \"a..b\""));
  EXPECT_THAT(refusal(with(R"("outline": 5)"), {"outline.sectors=5"}),
              HasSubstr("config.json: outline: expected an object, found the number 5"));
  EXPECT_THAT(refusal(with(""), {"threads=\xff\xfe"}),
              HasSubstr("--set threads: expected an integer"));
}

// ---- files

class ConfigFile : public ::testing::Test {
 protected:
  ConfigFile() {
    std::string name = (std::filesystem::temp_directory_path() / "meshhier-config-XXXXXX").string();
    directory_ = ::mkdtemp(name.data());
  }
  ~ConfigFile() override { std::filesystem::remove_all(directory_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return directory_ / name;
  }

  std::filesystem::path directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(ConfigFile, IsReadAndItsDirectoryIsTheBase) {
  const Config config = load_config(*files_, write("a.json", with("")), {});
  EXPECT_EQ(config.input, directory_ / "a.ply");
}

TEST_F(ConfigFile, MistakesNameTheFile) {
  const std::filesystem::path path = write("a.json", with(R"("x": 1)"));
  try {
    load_config(*files_, path, {});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), StartsWith(path.string() + ": unknown key"));
  }
}

TEST_F(ConfigFile, ThatIsMissingIsAnIoError) {
  try {
    load_config(*files_, directory_ / "none.json", {});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_THAT(error.what(), HasSubstr("none.json"));
  }
}

TEST_F(ConfigFile, ThatIsHugeIsRefusedUnread) {
  const std::filesystem::path path = write("mesh.ply", "ply\n");
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40);
  try {
    load_config(*files_, path, {});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(), HasSubstr("1099511627776"));
  }
}

// ---- several inputs, welding

TEST(ConfigInput, MayBeAListOfPaths) {
  const Config config = parse(R"({"input": ["a.ply", "/x/b.obj"], "output": "c"})");
  EXPECT_EQ(config.input.string(), "/data/scans/a.ply, /x/b.obj");
  EXPECT_EQ(parse(R"({"input": ["a.ply"], "output": "c"})").input, "/data/scans/a.ply");
}

TEST(ConfigInput, AnOverrideMayBeAListOrText) {
  const auto with_input = [](const std::string& setting) {
    const std::vector<std::string> overrides{setting};
    return parse_config(R"({"input": "a", "output": "c"})", {"config.json", "/data"}, overrides)
        .input.string();
  };
  EXPECT_EQ(with_input(R"(input=["x.ply", "y.ply"])"), "x.ply, y.ply");
  EXPECT_EQ(with_input("input=2024"), "2024");
  EXPECT_EQ(with_input("input=x.ply"), "x.ply");
}

TEST(ConfigInput, MayHaveAHundredThousandPaths) {
  const Json many{{"input", std::vector<std::string>(100'000, "a")}, {"output", "c"}};
  EXPECT_EQ(parse_config(many.dump(), {"config.json", "/data"}, {}).input.size(), 100'000);
}

TEST(ConfigErrors, TextsAreNotLongerThanTheManifestHasRoomFor) {
  const auto with_licence = [](std::size_t bytes) {
    return Json{{"input", "a"}, {"output", "c"}, {"licence", std::string(bytes, 'x')}}.dump();
  };
  EXPECT_EQ(parse_config(with_licence(32768), {"config.json", "/data"}, {}).licence.size(), 32768);
  EXPECT_THAT(refusal(with_licence(32769)),
              HasSubstr("licence: expected a string of at most 32768 bytes, found"));
  EXPECT_THAT(refusal(with_licence(1'000'000)), HasSubstr("at most 32768 bytes"));
}

TEST(ConfigInput, IsRefusedIfItIsNoListOfPaths) {
  for (const char* input : {"[]", R"([""])", R"(["a", 1])", R"({"a": 1})", "1", R"([["a"]])"}) {
    EXPECT_THAT(refusal(fmt::format(R"({{"input": {}, "output": "c"}})", input)),
                HasSubstr("input: expected a path or a list of 1 to 100000 paths"))
        << input;
  }
  Json many{{"input", std::vector<std::string>(100'001, "a")}, {"output", "c"}};
  EXPECT_THAT(refusal(many.dump()), HasSubstr("found a list"));
  EXPECT_THAT(refusal(R"({"input": ["a", "c/b"], "output": "c"})"), HasSubstr("holds the input"));
}

TEST(ConfigWeld, IsTrueOrFalse) {
  EXPECT_FALSE(parse(with("")).weld);
  EXPECT_TRUE(parse(with(R"("weld": true)")).weld);
  EXPECT_THAT(refusal(with(R"("weld": 1)")), HasSubstr("weld: expected true or false"));
}

TEST(ConfigAttributes, AreAllNoneOrNamed) {
  using Which = mesh_io::AttributeChoice::Which;
  EXPECT_EQ(parse(with("")).attributes, mesh_io::AttributeChoice{});
  EXPECT_EQ(parse(with(R"("attributes": "none")")).attributes.which, Which::none);
  const config::Config named = parse(with(R"("attributes": ["a", "b-c"], "labels": [])"));
  EXPECT_EQ(named.attributes.which, Which::named);
  EXPECT_EQ(named.attributes.names, (std::vector<std::string>{"a", "b-c"}));
  EXPECT_EQ(named.attributes.labels, std::vector<std::string>{});
  EXPECT_FALSE(parse(with(R"("labels": "integers")")).attributes.labels);
  for (const char* wrong : {R"("attributes": "quality")", R"("attributes": ["a b"])",
                            R"("attributes": [1])", R"("labels": "all")", R"("labels": 3)"})
    EXPECT_THAT(refusal(with(wrong)), HasSubstr("or a list of names")) << wrong;
}

TEST(ConfigTopology, IsPlaceOrIndex) {
  EXPECT_EQ(parse(with("")).topology, Topology::place);
  EXPECT_EQ(parse(with(R"("topology": "index")")).topology, Topology::index);
  EXPECT_THAT(refusal(with(R"("topology": "indexes")")),
              HasSubstr("topology: expected one of \"place\", \"index\", found the string"));
  EXPECT_THAT(refusal(with(R"("topolgy": "index")")), HasSubstr("did you mean \"topology\"?"));
}

// ---- resolved

TEST(ResolvedJson, HoldsWhatDecidesTheResultAndNothingElse) {
  EXPECT_EQ(resolved_json(parse(with(""))), Json::parse(R"({
      "weld": false, "topology": "place", "attributes": "all", "labels": "integers",
      "partition": {"vertices": 8192, "axis": "compactness"},
      "simplify": {"method": "edge_collapse", "vertices": 8192, "representative": "quadric",
                   "cost": "quadric"},
      "outline": {"sectors": 128, "tolerance": 0.002}, "preview": true,
      "storage": {"compression": "none", "normals": "auto"},
      "normal_map": {"texels": 896, "format": "jpeg", "quality": 85},
      "texture": {"use": true, "texels": 512, "format": "jpeg", "quality": 90, "unlit": true},
      "missing_images": "warn", "up": "y", "tileset": {"pixels": 16}})"));
  EXPECT_EQ(resolved_json(parse(with(R"("partition": {"count": 9})"))), Json::parse(R"({
      "weld": false, "topology": "place", "attributes": "all", "labels": "integers",
      "partition": {"count": 9, "axis": "compactness"},
      "simplify": {"method": "edge_collapse", "representative": "quadric", "cost": "quadric"},
      "outline": {"sectors": 128, "tolerance": 0.002}, "preview": true,
      "storage": {"compression": "none", "normals": "auto"},
      "normal_map": {"texels": 896, "format": "jpeg", "quality": 85},
      "texture": {"use": true, "texels": 512, "format": "jpeg", "quality": 90, "unlit": true},
      "missing_images": "warn", "up": "y", "tileset": {"pixels": 16}})"));
}

TEST(ResolvedJson, DoesNotDependOnPathsBudgetAndThreads) {
  const Config one = parse(with(R"("memory_budget": "64MiB", "threads": 1)"));
  const Config other =
      parse(R"({"input": "x", "output": "y", "memory_budget": "4GiB", "threads": 5})");
  EXPECT_EQ(resolved_json(one).dump(), resolved_json(other).dump());
}

TEST(ResolvedJson, SimplifiedTilesFollowThePartitionsUnlessTold) {
  EXPECT_EQ(resolved_json(parse(with(R"("partition": {"vertices": 500})")))["simplify"]["vertices"],
            500);
  EXPECT_EQ(resolved_json(parse(with(
                R"("partition": {"vertices": 500}, "simplify": {"vertices": 9})")))["simplify"]
                                                                                   ["vertices"],
            9);
}

TEST(ResolvedJson, ShowsVerticesByLevelAsTheyWereGiven) {
  const auto shown = [](const std::string& vertices) {
    return resolved_json(with_tile_vertices(vertices))["simplify"]["vertices"].dump();
  };
  EXPECT_EQ(shown("300"), "300");
  EXPECT_EQ(shown("[300]"), "300");
  EXPECT_EQ(shown("[300, 200, 200]"), "[300,200,200]");
}

TEST(ResolvedJson, ReadsBackToItself) {
  for (const char* keys :
       {"", R"("simplify": {"vertices": [700, 600, 4]})",
        R"("partition": {"count": 77, "axis": "longest"})",
        R"("partition": {"vertices": 500}, "outline": {"tolerance": 0.1, "sectors": 3},
                              "simplify": {"representative": "vertex", "vertices": 700})"}) {
    const Json resolved = resolved_json(parse(with(keys)));
    Json again = resolved;
    again["input"] = "a.ply";
    again["output"] = "a.hier";
    EXPECT_EQ(resolved_json(parse(again.dump())).dump(), resolved.dump());
  }
}

// ---- the JSON schema and the examples

std::filesystem::path configs_directory() {
  return std::filesystem::path(MESHHIER_SOURCE_DIR) / "configs";
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The schema's leaves by dotted path; `required` collects the paths of required keys.
void walk(const Json& schema, const std::string& prefix, std::map<std::string, Json>& leaves,
          std::set<std::string>& required) {
  EXPECT_EQ(schema.at("additionalProperties"), false) << prefix;
  for (const Json& name : schema.value("required", Json::array()))
    required.insert(prefix + name.get<std::string>());
  for (const auto& [name, inner] : schema.at("properties").items()) {
    EXPECT_TRUE(inner.contains("description")) << prefix << name;
    const Json type = inner.value("type", Json());
    if (type == "object" || type == Json::array({"object", "string"})) {
      walk(inner, prefix + name + '.', leaves, required);
    } else {
      leaves[prefix + name] = inner;
    }
  }
}

void expect_same_rule(const ConfigKey& key, const Json& schema) {
  SCOPED_TRACE(key.path);
  switch (key.kind) {
    case KeyKind::text:
      EXPECT_EQ(schema.at("type"), "string");
      EXPECT_EQ(schema.at("maxLength"), key.maximum);
      break;
    case KeyKind::path:
      EXPECT_EQ(schema.at("type"), "string");
      EXPECT_EQ(schema.at("minLength"), 1);
      break;
    case KeyKind::paths:
      EXPECT_EQ(schema.at("oneOf").at(0), Json::parse(R"({"type": "string", "minLength": 1})"));
      EXPECT_EQ(schema.at("oneOf").at(1).at("items"), schema.at("oneOf").at(0));
      EXPECT_EQ(schema.at("oneOf").at(1).at("minItems"), 1);
      EXPECT_EQ(schema.at("oneOf").at(1).at("maxItems"), key.maximum);
      break;
    case KeyKind::boolean:
      EXPECT_EQ(schema.at("type"), "boolean");
      break;
    case KeyKind::integer:
      EXPECT_EQ(schema.at("type"), "integer");
      EXPECT_EQ(schema.at("minimum"), key.minimum);
      EXPECT_EQ(schema.at("maximum"), key.maximum);
      break;
    case KeyKind::number:
      EXPECT_EQ(schema.at("type"), "number");
      EXPECT_EQ(schema.at(key.takes_minimum ? "minimum" : "exclusiveMinimum"), key.minimum);
      EXPECT_EQ(schema.at("maximum"), key.maximum);
      break;
    case KeyKind::numbers:
      EXPECT_EQ(schema.at("type"), "array");
      EXPECT_EQ(schema.at("items").at("type"), "number");
      EXPECT_EQ(schema.at("minItems"), key.maximum);
      EXPECT_EQ(schema.at("maxItems"), key.maximum);
      break;
    case KeyKind::levels:
      expect_same_rule(level_entry(key), schema.at("oneOf").at(0));
      EXPECT_EQ(schema.at("oneOf").at(1).at("type"), "array");
      EXPECT_EQ(schema.at("oneOf").at(1).at("items"), schema.at("oneOf").at(0));
      EXPECT_EQ(schema.at("oneOf").at(1).at("minItems"), 1);
      EXPECT_EQ(schema.at("oneOf").at(1).at("maxItems"), key.most_levels);
      break;
    case KeyKind::size:
      EXPECT_EQ(schema.at("oneOf").at(0).at("minimum"), key.minimum);
      EXPECT_EQ(schema.at("oneOf").at(0).at("maximum"), key.maximum);
      EXPECT_EQ(schema.at("oneOf").at(1).at("type"), "string");
      break;
    case KeyKind::choice:
      EXPECT_EQ((key.prefix.empty() ? schema : schema.at("anyOf").at(0)).at("enum"),
                Json(key.choices));
      break;
    case KeyKind::names:
      EXPECT_EQ(schema.at("oneOf").at(0).at("enum"), Json(key.choices));
      EXPECT_EQ(schema.at("oneOf").at(1).at("items").at("type"), "string");
      EXPECT_EQ(schema.at("oneOf").at(1).at("maxItems"), key.maximum);
      break;
    case KeyKind::view:
      for (const auto& [name, rule] : key.view->schema.items())
        EXPECT_EQ(schema.at(name), rule);
      break;
  }
}

TEST(ConfigSchema, AgreesWithTheParserOnKeysRangesAndDefaults) {
  std::map<std::string, Json> leaves;
  std::set<std::string> required;
  walk(Json::parse(text_of(configs_directory() / "meshhier.schema.json")), "", leaves, required);

  const Config defaults;
  for (const ConfigKey& key : config_keys()) {
    ASSERT_TRUE(leaves.contains(key.path)) << key.path << " is missing in the schema";
    expect_same_rule(key, leaves[key.path]);
    EXPECT_EQ(required.contains(key.path), key.required) << key.path;
    EXPECT_EQ(leaves[key.path].value("default", Json()), key.show(defaults)) << key.path;
    leaves.erase(key.path);
    required.erase(key.path);
  }
  for (const auto& [path, schema] : leaves)
    ADD_FAILURE() << path << " is not known to the parser";
  for (const std::string& path : required)
    ADD_FAILURE() << path << " is required, but not known to the parser";
}

TEST(ConfigSchema, KnowsWhichKeysExcludeAndNeedEachOther) {
  const Json properties =
      Json::parse(text_of(configs_directory() / "meshhier.schema.json")).at("properties");
  EXPECT_EQ(properties.at("partition").at("allOf"),
            Json::parse(R"([{"not": {"required": ["vertices", "count"]}}])"));
  EXPECT_EQ(properties.at("placement").at("allOf"),
            Json::parse(R"([{"not": {"required": ["longitude", "crs"]}},
                            {"not": {"required": ["transform", "crs"]}},
                            {"anyOf": [{"not": {"required": ["offset"]}},
                                       {"required": ["crs"]}, {"required": ["metadata"]}]},
                            {"not": {"required": ["longitude", "metadata"]}},
                            {"not": {"required": ["transform", "metadata"]}},
                            {"anyOf": [{"not": {"required": ["anchor"]}}, {"required": ["longitude"]},
                                       {"required": ["crs"]}, {"required": ["metadata"]}]},
                            {"not": {"required": ["longitude", "transform"]}}])"));
  EXPECT_EQ(properties.at("placement").at("dependentRequired"),
            Json::parse(R"({"longitude": ["latitude"], "latitude": ["longitude"],
                            "height": ["longitude"]})"));
}

// ---- what is told of the keys

TEST(ConfigReference, TheCommittedSchemaIsTheTables) {
  EXPECT_EQ(text_of(configs_directory() / "meshhier.schema.json"), schema_text())
      << "scripts/references writes it anew";
}

TEST(ConfigReference, TheDocumentHasTheTable) {
  const std::string text =
      text_of(std::filesystem::path(MESHHIER_SOURCE_DIR) / "docs" / "config.md");
  EXPECT_THAT(text,
              HasSubstr("<!-- keys: begin -->\n\n" + keys_markdown() + "\n<!-- keys: end -->"))
      << "scripts/references writes it anew";
}

TEST(FormatReference, WhatIsKeptInFilesIsTheTables) {
  const std::filesystem::path sources = MESHHIER_SOURCE_DIR;
  std::string json = formats_json();
  json.pop_back();  // the last line's end
  EXPECT_THAT(text_of(sources / "viewer/src/hierarchy/formats.ts"),
              EndsWith("export const FORMATS = " + json + " as const;\n"))
      << "scripts/references writes it anew";
  EXPECT_THAT(
      text_of(sources / "docs/input_formats.md"),
      HasSubstr("<!-- formats: begin -->\n\n" + formats_markdown() + "\n<!-- formats: end -->"))
      << "scripts/references writes it anew";
}

TEST(FormatReference, TheTerminalsListIsInShortLines) {
  const std::string text = formats_text();
  EXPECT_THAT(text, AllOf(HasSubstr("\n  STL: \".stl\"\n      kept: binary and ASCII"),
                          HasSubstr("\n  glTF: \".gltf\", \".glb\"\n")));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    EXPECT_LE(line.size(), 96U) << line;
}

TEST(ConfigReference, TheTerminalsListHasAllKeysInShortLines) {
  const std::string text = keys_text();
  for (const ConfigKey& key : config_keys())
    EXPECT_THAT(text, HasSubstr(' ' + key.path + ": " + expectation(key))) << key.path;
  EXPECT_THAT(text,
              HasSubstr("* partition.count: an integer from 1 to 1073741824; default: none\n"
                        "      number of partitions, any; excludes \"partition.vertices\"\n"));
  EXPECT_THAT(text,
              HasSubstr("* partition.vertices: an integer from 4 to 32768; default: 8192\n"
                        "      most vertices of a partition; excludes \"partition.count\"\n"));
  EXPECT_THAT(text, HasSubstr("  output: a path; required\n"));
}

TEST(ConfigReference, TheConfigOfDefaultsHoldsThem) {
  const Config shown = parse(defaults_text());
  Config expected;
  expected.input = shown.input;
  expected.output = shown.output;
  EXPECT_EQ(shown, expected);
  EXPECT_THAT(defaults_text(),
              HasSubstr("  \"partition\": { \"vertices\": 8192, \"axis\": \"compactness\" },\n"));
}

TEST(ConfigReference, EverySectionHasKeysAndEveryKeyItsSection) {
  for (const ConfigKey& key : config_keys()) {
    const std::size_t dot = key.path.rfind('.');
    EXPECT_TRUE(dot == std::string::npos || is_config_section(key.path.substr(0, dot))) << key.path;
    EXPECT_FALSE(key.meaning.empty()) << key.path;
  }
  for (const ConfigSection& section : config_sections()) {
    EXPECT_TRUE(std::ranges::any_of(config_keys(), [&](const ConfigKey& key) {
      return key.path.starts_with(section.path + '.');
    })) << section.path;
  }
}

/// POSIX regular expressions: as far as the schema goes they mean the same as JavaScript's.
class Pattern {
 public:
  explicit Pattern(const std::string& text) {
    EXPECT_EQ(regcomp(&compiled_, text.c_str(), REG_EXTENDED | REG_NOSUB), 0);
  }
  ~Pattern() { regfree(&compiled_); }
  Pattern(const Pattern&) = delete;
  Pattern& operator=(const Pattern&) = delete;
  bool matches(const char* text) const { return regexec(&compiled_, text, 0, nullptr, 0) == 0; }

 private:
  regex_t compiled_{};
};

TEST(ConfigSchema, TakesTheSizesThatTheParserTakes) {
  const Json schema = Json::parse(text_of(configs_directory() / "meshhier.schema.json"));
  const Json& text_form = schema.at("properties").at("memory_budget").at("oneOf").at(1);
  const Pattern pattern(text_form.at("pattern").get<std::string>());
  for (const char* text :
       {"1",   "512MiB", "512 mib", " 2G ", "1.5TB", "7B",    "7b",  "3k",  "1.",   "9KB",   "",
        "MiB", "-1MiB",  "1e3",     "1Mi",  "1ib",   ".5GiB", "1 2", "0x1", "5 XB", "1,5GiB"}) {
    EXPECT_EQ(pattern.matches(text), execution::parse_size(text).has_value()) << '"' << text << '"';
  }
}

TEST(ConfigSchema, EveryKeyTakesItsDefaultAndShowsWhatItTook) {
  const Config defaults;
  for (const ConfigKey& key : config_keys()) {
    const Json value = key.show(defaults);
    if (value.is_null())
      continue;
    EXPECT_TRUE(accepts(key, value)) << key.path;
    Config config;
    key.assign(config, value);
    EXPECT_EQ(config, defaults) << key.path;
  }
}

TEST(ExampleConfigs, AreAllAccepted) {
  const auto files = storage::make_posix_file_system();
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(configs_directory())) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".json" || name == "meshhier.schema.json")
      continue;
    EXPECT_NO_THROW(load_config(*files, entry.path(), {})) << entry.path();
    names.push_back(name);
  }
  EXPECT_THAT(names, IsSupersetOf({"minimal.json", "defaults.json", "huge_scan.json", "mobile.json",
                                   "paper.json", "progressive.json"}));
}

TEST(ExampleConfigs, TheOneOfDefaultsHoldsThem) {
  const auto files = storage::make_posix_file_system();
  const Config shown = load_config(*files, configs_directory() / "defaults.json", {});
  EXPECT_EQ(shown, load_config(*files, configs_directory() / "minimal.json", {}));
}

// ---- suggestions

TEST(EditDistance, CountsLetters) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("axis", "xais"), 1u);
  EXPECT_EQ(edit_distance("Axis", "aXIS"), 0u);
}

TEST(NearestWord, TakesTheFirstOfTheNearest) {
  const std::vector<std::string> words{"build", "inspect", "verify", "export", "bulid"};
  EXPECT_EQ(nearest_word("buidl", words), "build");
  EXPECT_EQ(nearest_word("exprot", words), "export");
  EXPECT_EQ(nearest_word("transmogrify", words), std::nullopt);
  EXPECT_EQ(nearest_word(std::string(100'000, 'x'), words), std::nullopt);
  EXPECT_EQ(nearest_word("x", {}), std::nullopt);
}

TEST(Config, CompleteTextIsTheSameConfigAnywhere) {
  const auto again = [](const Config& config) {
    return parse_config(complete_text(config, "/elsewhere"), {"plan", "/nowhere"}, {});
  };
  for (
      const char* keys :
      {"", R"("partition": {"count": 9}, "simplify": {"vertices": [100, 200]}, "threads": 3)",
       R"("partition": {"vertices": 77}, "memory_budget": "300MiB", "weld": true)",
       R"("texture": {"use": false}, "licence": "CC0", "up": "z", "preview": false, "tileset": {"pixels": 1},
           "placement": {"crs": "EPSG:32632", "offset": [1, 2, 3]})",
       R"("placement": {"metadata": "m.xml"}, "storage": {"container": "3tz"})",
       R"("placement": {"longitude": 10, "latitude": 50, "height": 3, "anchor": [1, 2, 3]},
           "storage": {"compression": "zlib", "positions": {"bits": 12}, "normals": "none"})"}) {
    const Config config = parse(with(keys));
    EXPECT_EQ(again(config), config) << keys;
  }
  Config several = parse(R"({"input": ["a.ply", "b.ply"], "output": "a.hier"})");
  EXPECT_EQ(again(several), several);
  several.input[0] = "a.ply";
  several.input[1] = "/b.ply";
  several.output = "a.hier";
  EXPECT_EQ(again(several).input[0], "/elsewhere/a.ply");
  EXPECT_EQ(again(several).input[1], "/b.ply");
  EXPECT_EQ(again(several).output, "/elsewhere/a.hier");
}

TEST(Config, WhatIsNoTextCannotBeWrittenDown) {
  Config config = parse(with(""));
  config.input = std::filesystem::path("/data/\xff.ply");
  EXPECT_THROW(complete_text(config, "/"), Error);
}

TEST(ConfigView, IsASectionWithTheKeysOfViews) {
  const auto parse = [](const std::string& view, std::vector<std::string> settings = {}) {
    return parse_config(R"({"input": "a.ply", "output": "a.hier", "view": )" + view + "}",
                        {"c.json", {}}, settings);
  };
  const Config config =
      parse(R"({"attribute": "distance", "range": [-1, 1]})", {"view.ramp=turbo"});
  EXPECT_EQ(config.view.colours, "attribute");
  EXPECT_EQ(config.view.ramp, "turbo");
  EXPECT_EQ(resolved_json(config).at("view").dump(),
            R"({"colours":"attribute","attribute":"distance","ramp":"turbo","range":[-1.0,1.0]})");
  EXPECT_FALSE(resolved_json(parse("{}")).contains("view"));
  EXPECT_EQ(parse_config(complete_text(config, "/"), {"c.json", {}}, {}).view, config.view);
  const auto message = [&](const std::string& view, std::vector<std::string> settings = {}) {
    try {
      parse(view, std::move(settings));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(message(R"({"rnage": [0, 1]})"),
            "c.json: unknown key \"view.rnage\"; did you mean \"view.range\"?");
  EXPECT_EQ(message(R"({"range": [0]})"), "c.json: view.range: expected two numbers, found a list");
  EXPECT_THAT(message("{}", {"view.ramp=trubo"}), testing::HasSubstr("did you mean \"turbo\"?"));
  EXPECT_THAT(message(R"({"cut": [1, 0, 0, 0], "box": [0, 0, 0, 1, 1, 1]})"),
              testing::HasSubstr("\"cut\" or \"box\", not both"));
}

TEST(ConfigView, TakesSettingsOnTopOfAView) {
  ModelView view;
  view.light = "raking";
  const std::vector<std::string> settings{"view.up=z", "view.wires=true"};
  const ModelView changed = with_settings(view, settings);
  EXPECT_EQ(changed.light, "raking");
  EXPECT_EQ(changed.up, "z");
  EXPECT_TRUE(changed.wires);
  EXPECT_THROW(with_settings(view, std::vector<std::string>{"partition.vertices=100"}), Error);
}

}  // namespace
}  // namespace meshhier::config
