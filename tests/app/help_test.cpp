// Help, the version, and mistakes in the arguments.
#include "tests/app/command_line.h"
#include "tests/support/gzip.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

TEST_F(CommandLine, HelpTeaches) {
  const Outcome outcome = run({"--help"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.messages, IsEmpty());
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("Examples:"), HasSubstr("meshhier build"),
                                 HasSubstr("Exit codes:"), HasSubstr("130  interrupted")));
}

TEST_F(CommandLine, EveryCommandHasHelpWithExamples) {
  for (const char* command : {"build", "inspect", "verify", "compare", "query", "export", "preview",
                              "draw", "progressive", "reconstruct", "serve"}) {
    const Outcome outcome = run({command, "--help"});
    EXPECT_EQ(outcome.code, 0) << command;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("Examples:"), HasSubstr(std::string("meshhier ") + command)));
  }
}

TEST_F(CommandLine, HelpOfABuildShowsTheDefaultsAndHelpOfTheConfigAllKeys) {
  EXPECT_THAT(run({"build", "--help"}).out,
              AllOf(HasSubstr(R"("method": "edge_collapse")"), HasSubstr("--help-config"),
                    Not(HasSubstr("Exit codes:"))));
  const Outcome keys = run({"build", "--help-config"});
  EXPECT_EQ(keys.code, 0) << keys.messages;
  EXPECT_THAT(keys.out, AllOf(HasSubstr("partition.vertices"), HasSubstr("default: 8192")));
  const Outcome schema = run({"build", "--help-config=schema"});
  EXPECT_EQ(schema.code, 0) << schema.messages;
  EXPECT_TRUE(nlohmann::json::parse(schema.out).at("properties").contains("partition"));
  EXPECT_EQ(run({"build", "--help-config=poem"}).code, kUsage);
  EXPECT_THAT(run({"build", "--help-formats"}).out, HasSubstr("ASCII"));
}

TEST_F(CommandLine, ABuildNeedsNoConfigIfAllIsSet) {
  const std::string input = "input=" + write_mesh("a.ply").string();
  const std::string output = "output=" + hierarchy();
  const Outcome outcome =
      run({"build", "--set", input, output, "partition.vertices=500", "preview=false"});
  EXPECT_EQ(outcome.code, 0) << outcome.messages;
  const auto without = contents(hierarchy());
  EXPECT_EQ(run({"build", write_config(), "--force"}).code, 0);
  EXPECT_EQ(contents(hierarchy()), without);
  const Outcome half = run({"build", "--set", input});
  EXPECT_EQ(half.code, kUsage);
  EXPECT_THAT(half.messages, HasSubstr("output is missing"));
}

TEST_F(CommandLine, VersionIsPrinted) {
  const Outcome outcome = run({"--version"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, ::testing::MatchesRegex("meshhier [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(CommandLine, MistakesExitWithUsageAndSayWhatIsWrong) {
  const std::vector<std::pair<Arguments, std::string>> mistakes{
      {{}, ", clean, completion, manual\nRun with --help"},
      {{"show", "x.hier"}, "unknown command \"show\"; expected one of build, inspect, "},
      {{MESHHIER_BINARY}, "a command is missing; did you mean \"meshhier build "},
      {{"biuld", "a.json"}, "unknown command \"biuld\"; did you mean \"build\"?"},
      {{"build"}, "A mesh or a config is required"},
      {{"build", "a.ply", "b.hier"}, "b.hier: this is no mesh; the output is named by -o"},
      {{"build", "a.json", "--froce"}, "--froce"},
      {{"build", "a.json", "--progress", "loud"}, "auto, bar, json or none"},
      {{"build", "a.json", "--json"}, "--dry-run"},
      {{"build", "a.json", "--dry-run", "--stats", "s.json"}, "excludes"},
      {{"inspect"}, "HIERARCHY is required"},
      {{"inspect", "x", "y"}, "y"},
      {{"inspect", "x", "--level", "-1"}, "--level"},
      {{"inspect", "x", "--level", "33"}, "from 0 to 32"},
      {{"inspect", "x", "--node", "3"}, "LEVEL/INDEX"},
      {{"inspect", "x", "--node", "3/"}, "LEVEL/INDEX"},
      {{"inspect", "x", "--node", "3/5x"}, "LEVEL/INDEX"},
      {{"inspect", "x", "--node", "3/4294967296"}, "LEVEL/INDEX"},
      {{"inspect", "x", "--node", "3/5", "--level", "3"}, "excludes"},
      {{"verify", "x", "--cuts", "many"}, "--cuts"},
      {{"compare", "x"}, "TO"},
      {{"compare", "x", "y", "--tolerance", "0.5 miles"}, "us_ft"},
      {{"compare", "x", "y", "--tolerance", "-1"}, "--tolerance"},
      {{"compare", "x", "y", "--level", "1", "--error", "2"}, "at most 1"},
      {{"verify", "x", "--cuts", "4294967296"}, "--cuts"},
      {{"verify", "x", "--seed", "1.5"}, "--seed"},
      {{"verify", "x", "--memory-budget", "lots"}, "512MiB"},
      {{"verify", "x", "--memory-budget", "0"}, "512MiB"},
      {{"export", "x", "--level", "1"}, "--output"},
      {{"export", "x", "-o", "y.ply"}, "say what to export, by --error (0: the original), --level"},
      {{"export", "x", "--level", "1", "--outline", "-o", "y.ply"}, "--outline"},
      {{"export", "x", "--cut", "", "-o", "y.ply"}, "--cut"},
      {{"export", "x", "--level", "0", "-o", "y.STL"}, "y.STL: export writes .ply, .glb, .obj, "},
      {{"export", "x", "--level", "0", "-o", "y.ply.gz"}, "pack it yourself: -o - | gzip"},
      {{"preview", "x"}, "--output"},
      {{"preview", "x", "-o", "y.jpg"}, ".png or .webp"},
      {{"preview", "x", "-o", "-"}, "--format"},
      {{"preview", "x", "-o", "y.png", "--size", "0x5"}, "WIDTHxHEIGHT"},
      {{"preview", "x", "-o", "y.png", "--size", "8193x5"}, "1 to 8192"},
      {{"preview", "x", "-o", "y.png", "--size", "80"}, "WIDTHxHEIGHT"},
      {{"preview", "x", "-o", "y.png", "--view", "behind"}, "iso, or AZ,EL"},
      {{"preview", "x", "-o", "y.png", "--view", "10,91"}, "AZ,EL"},
      {{"preview", "x", "-o", "y.png", "--view", "nan,0"}, "AZ,EL"},
      {{"preview", "x", "-o", "y.png", "--up", "x"}, "y or z"},
      {{"preview", "x", "-o", "y.png", "--background", "#12345"}, "#rrggbb"},
      {{"preview", "x", "-o", "y.png", "--error", "-1"}, "--error"},
      {{"preview", "x", "-o", "y.png", "--error", "nan"}, "--error"},
      {{"preview", "x", "-o", "y.png", "--level", "1", "--error", "2"}, "--error"},
      {{"preview", "x", "--plan", "--scale", "1:50", "-o", "y.png"}, "meshhier draw HIERARCHY"},
      {{"draw", "x"}, "--output"},
      {{"draw", "x", "-o", "y.jpg"}, ".png, .svg, .dxf, .geojson"},
      {{"draw", "x", "-o", "-"}, "--format"},
      {{"draw", "x", "-o", "y.png", "--format", "pdf"}, "--format"},
      {{"draw", "x", "-o", "y.png", "--scale", "0"}, "1:N"},
      {{"draw", "x", "-o", "y.png", "--scale", "1:0"}, "1:N"},
      {{"draw", "x", "-o", "y.png", "--scale", "1:-5"}, "1:N"},
      {{"draw", "x", "-o", "y.png", "--dpi", "5"}, "10 to 4800"},
      {{"draw", "x", "-o", "y.png", "--elevation", "up"}, "front, right, back or left"},
      {{"draw", "x", "-o", "y.png", "--plan", "--elevation", "left"}, "at most 1"},
      {{"draw", "x", "-o", "y.png", "--section", "1,2", "3"}, "X,Y X,Y"},
      {{"draw", "x", "-o", "y.png", "--plane", "1,2,3"}, "NX,NY,NZ,D"},
      {{"draw", "x", "-o", "y.png", "--cut-height", "nan"}, "Z,Z"},
      {{"draw", "x", "-o", "y.png", "--contours", "0"}, "above 0"},
      {{"draw", "x", "-o", "y.png", "--contours", "1", "--cut-height", "2"}, "at most 1"},
      {{"draw", "x", "-o", "y.png", "--units", "mile"}, "us_ft"},
      {{"draw", "x", "-o", "y.png", "--grid=0"}, "--grid"},
      {{"build", "a.ply", "-o", ""}, "--output: expected a name"},
      {{"build", "a.ply", "--stats", ""}, "--stats: expected a name"},
      {{"build", "a.ply", "--input-note", ""}, "--input-note: expected a name"},
      {{"export", "x", "--outline", "-o", ""}, "--output: expected a name"},
      {{"preview", "x", "-o", ""}, "--output: expected a name"},
      {{"progressive", "x", "-o", ""}, "--output: expected a name"},
      {{"reconstruct", "x", "-o", ""}, "--output: expected a name"},
      {{"progressive"}, "HIERARCHY is required"},
      {{"progressive", "x"}, "--output"},
      {{"progressive", "x", "-o", "y", "--steps", "0"}, "--steps"},
      {{"progressive", "x", "-o", "y", "--steps", "33"}, "from 1 to 32"},
      {{"progressive", "x", "-o", "y", "--node", "3"}, "LEVEL/INDEX"},
      {{"progressive", "x", "-o", "y", "--memory-budget", "0"}, "512MiB"},
      {{"reconstruct", "x"}, "--output"},
      {{"reconstruct", "x", "-o", "y", "--details", "-1"}, "--details"},
      {{"reconstruct", "x", "-o", "y", "--details", "33"}, "from 0 to 32"},
  };
  for (const auto& [arguments, expected] : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, kUsage) << expected;
    EXPECT_THAT(outcome.messages, AllOf(StartsWith("meshhier: "), HasSubstr(expected)));
    EXPECT_THAT(outcome.out, IsEmpty());
  }
}

TEST_F(CommandLine, MistakesInTheConfigExitWithUsage) {
  write_mesh("a.ply");
  const Outcome misspelt = run({"build", write_config(R"(, "treads": 1)")});
  EXPECT_EQ(misspelt.code, kUsage);
  EXPECT_THAT(misspelt.messages,
              HasSubstr("a.json: unknown key \"treads\"; did you mean \"threads\"?"));

  const Outcome ill_typed = run({"build", write_config(), "--set", "partition.vertices=lots"});
  EXPECT_EQ(ill_typed.code, kUsage);
  EXPECT_THAT(ill_typed.messages,
              HasSubstr("--set partition.vertices: expected an integer from 4 to 32768"));
}

TEST_F(CommandLine, MissingFilesExitWithIo) {
  const std::string absent = (work() / "absent").string();
  const std::vector<Arguments> commands{
      {"build", absent},
      {"build", write_config()},  // its input is not there
      {"inspect", absent},
      {"verify", absent},
      {"export", absent, "--level", "0", "-o", (work() / "x.ply").string()}};
  for (const Arguments& arguments : commands) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, kIo) << arguments[0] << ": " << outcome.messages;
    EXPECT_THAT(outcome.messages, AllOf(StartsWith("meshhier: "), HasSubstr(work().string())));
  }
  EXPECT_EQ(names(), (std::set<std::string>{"a.json"}));
}

}  // namespace
}  // namespace meshhier::app
