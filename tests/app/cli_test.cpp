// The real program as a process: exit codes, messages, and what it leaves on disk.
#include "tests/app/program.h"
#include "tests/support/gzip.h"
#include "tests/support/http_host.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kUsage = 2;
constexpr int kInput = 3;
constexpr int kIo = 4;
constexpr int kExists = 5;
constexpr int kBudget = 6;
constexpr int kCorrupt = 7;
constexpr int kInterrupted = 130;

class CommandLine : public ::testing::Test {
 protected:
  CommandLine() {
    std::string name = (std::filesystem::temp_directory_path() / "meshhier-cli-XXXXXX").string();
    directory_ = ::mkdtemp(name.data());
    std::filesystem::create_directory(work());
  }
  ~CommandLine() override { std::filesystem::remove_all(directory_); }

  /// Where the tests' files are; what the program prints is kept elsewhere.
  Path work() const { return directory_ / "work"; }

  Outcome run(const Arguments& arguments, const std::string& out = "") const {
    return run_program(arguments, directory_, out);
  }

  /// A bumpy square of 50 x 50 vertices. The last face's last corner is `last_corner`.
  Path write_mesh(const std::string& name, std::size_t last_corner = 2499,
                  double bump = 0.25) const {
    constexpr std::size_t kSide = 50;
    std::ostringstream ply;
    ply << "ply\nformat ascii 1.0\nelement vertex " << kSide * kSide
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
        << 2 * (kSide - 1) * (kSide - 1)
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t v = 0; v < kSide * kSide; ++v) {
      ply << v % kSide << ' ' << v / kSide << ' ' << bump * static_cast<double>(v * 7919 % 64)
          << '\n';
    }
    for (std::size_t y = 0; y + 1 < kSide; ++y) {
      for (std::size_t x = 0; x + 1 < kSide; ++x) {
        const std::size_t v = y * kSide + x;
        const bool last = v + kSide + 2 == kSide * kSide;
        ply << "3 " << v << ' ' << v + 1 << ' ' << v + kSide << '\n';
        ply << "3 " << v + 1 << ' ' << v + kSide << ' ' << (last ? last_corner : v + kSide + 1)
            << '\n';
      }
    }
    write_text(work() / name, ply.str());
    return work() / name;
  }

  /// A config for five partitions of 500 vertices, without a preview, which takes most of so small
  /// a build; `more` adds keys.
  std::string write_config(const std::string& more = "") const {
    write_text(work() / "a.json",
               "// a comment\n{\"input\": \"a.ply\", \"output\": \"a.hier\",\n"
               " \"partition\": {\"vertices\": 500}, \"preview\": false" +
                   more + "}\n");
    return (work() / "a.json").string();
  }

  std::string hierarchy() const { return (work() / "a.hier").string(); }

  /// Meshes and hierarchies are made once more by every test that needs one: each is small.
  void build() const {
    write_mesh("a.ply");
    const Outcome outcome = run({"build", write_config()});
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
  }

  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(work()))
      found.insert(entry.path().filename());
    return found;
  }

  std::map<std::string, std::string> contents(const Path& directory) const {
    std::map<std::string, std::string> files;
    if (!std::filesystem::exists(directory))
      return files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
      if (entry.is_regular_file())
        files[entry.path().lexically_relative(directory)] = text_of(entry.path());
    }
    return files;
  }

 private:
  Path directory_;
};

// ---- help

TEST_F(CommandLine, HelpTeaches) {
  const Outcome outcome = run({"--help"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.messages, IsEmpty());
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("Examples:"), HasSubstr("meshhier build"),
                                 HasSubstr("Exit codes:"), HasSubstr("130  interrupted")));
}

TEST_F(CommandLine, EveryCommandHasHelpWithExamples) {
  for (const char* command : {"build", "inspect", "verify", "compare", "export", "preview",
                              "progressive", "reconstruct", "serve"}) {
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

// ---- mistakes in the arguments

TEST_F(CommandLine, MistakesExitWithUsageAndSayWhatIsWrong) {
  const std::vector<std::pair<Arguments, std::string>> mistakes{
      {{}, ", clean, completion, manual\nRun with --help"},
      {{"view", "x.hier"}, "unknown command \"view\"; expected one of build, inspect, "},
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
      {{"export", "x", "-o", "y.ply"}, "--outline"},
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

// ---- build

TEST_F(CommandLine, BuildMakesAHierarchyAndNothingElse) {
  build();
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply"}));
  EXPECT_TRUE(std::filesystem::exists(work() / "a.hier" / "hierarchy.json"));
}

TEST_F(CommandLine, ManyTilesAreInSeveralDirectories) {
  constexpr int kVertices = 40'004;  // of a strip, four a partition
  std::string mesh =
      "ply\nformat ascii 1.0\nelement vertex 40004\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 40002\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < kVertices; ++i)
    mesh += std::to_string(i / 2) + ' ' + std::to_string(i % 2) + " 0\n";
  for (int i = 2; i < kVertices; ++i)
    mesh +=
        "3 " + std::to_string(i - 2) + ' ' + std::to_string(i - 1) + ' ' + std::to_string(i) + '\n';
  write_text(work() / "strip.ply", mesh);
  const std::string made = (work() / "strip.hier").string();
  ASSERT_EQ(run({"build", (work() / "strip.ply").string(), "-o", made, "--set",
                 "partition.vertices=4", "simplify.vertices=4", "simplify.method=cluster"})
                .code,
            0);
  const auto tiles = [&](const char* directory) {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(Path(made) / directory))
      count += entry.is_regular_file() ? 1 : 0;
    return count;
  };
  EXPECT_EQ(tiles("tiles/14"), 10'000U);
  EXPECT_EQ(tiles("tiles/14/010000"), 1U);
  EXPECT_EQ(run({"verify", made, "--cuts", "2"}).code, 0);
  EXPECT_EQ(run({"verify", made, "--input", (work() / "strip.ply").string()}).code, 0);
}

TEST_F(CommandLine, BuildKeepsAnExistingOutputUnlessForced) {
  build();
  const auto before = contents(hierarchy());

  write_mesh("a.ply", 2499, 0.5);
  const Outcome refused = run({"build", write_config()});
  EXPECT_EQ(refused.code, kExists);
  EXPECT_THAT(refused.messages, AllOf(HasSubstr("a.hier"), HasSubstr("--force")));
  EXPECT_EQ(contents(hierarchy()), before);

  EXPECT_EQ(run({"build", write_config(), "--force"}).code, 0);
  EXPECT_NE(contents(hierarchy()), before);
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply"}));
}

TEST_F(CommandLine, BuildOfABrokenMeshNamesItAndLeavesNothing) {
  write_mesh("a.ply", 9999);
  const Outcome outcome = run({"build", write_config()});
  EXPECT_EQ(outcome.code, kInput);
  EXPECT_THAT(outcome.messages, AllOf(HasSubstr("a.ply"), HasSubstr("9999")));
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(CommandLine, BuildThatFailsKeepsTheOutputItWasToReplace) {
  build();
  const auto before = contents(hierarchy());
  write_mesh("a.ply", 9999);
  EXPECT_EQ(run({"build", write_config(), "--force"}).code, kInput);
  EXPECT_EQ(contents(hierarchy()), before);
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply"}));
}

TEST_F(CommandLine, AModelInMapCoordinatesStandsOnTheGlobe) {
  write_mesh("a.ply");
  write_text(work() / "metadata.xml",
             "<M><SRS>EPSG:32633</SRS><SRSOrigin>500000,5300000,0</SRSOrigin></M>");
  const std::string config = write_config(
      R"(, "up": "z", "placement": {"metadata": "metadata.xml", "anchor": [0, 0, 300]})");
  const Outcome outcome = run({"build", config});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  EXPECT_THAT(outcome.out, HasSubstr("placed by WGS 84 / UTM zone 33N at longitude 15.0000"));
  const std::string tileset = text_of(Path(hierarchy()) / "tileset.json");
  EXPECT_THAT(tileset, HasSubstr("\"transform\":[-0.258"));
  EXPECT_THAT(text_of(Path(hierarchy()) / "hierarchy.json"),
              AllOf(HasSubstr("\"crs\": \"EPSG:32633\""), Not(HasSubstr("metadata.xml"))));
  EXPECT_EQ(run({"verify", hierarchy(), "--input", work() / "a.ply"}).code, 0);
}

// It and what it needs take as much memory as all the rest of the program at rest.
TEST_F(CommandLine, PROJIsLoadedForACrsOnly) {
  write_mesh("a.ply");
  const auto loaded = [&](const std::string& more) {
    ::setenv("LD_DEBUG", "files", 1);  // the system's loader tells what it loads
    const Outcome outcome = run({"build", write_config(more), "--force"});
    ::unsetenv("LD_DEBUG");
    EXPECT_EQ(outcome.code, 0) << more;
    EXPECT_THAT(outcome.messages, HasSubstr("file=libc.so"));
    return outcome.messages;
  };
  EXPECT_THAT(loaded(""), Not(HasSubstr("libproj")));
  EXPECT_THAT(loaded(R"(, "placement": {"longitude": 15, "latitude": 47})"),
              Not(HasSubstr("libproj")));
  EXPECT_THAT(loaded(R"(, "placement": {"crs": "EPSG:32633", "offset": [500000, 5300000, 0]})"),
              HasSubstr("file=libproj"));
}

TEST_F(CommandLine, TheFileOfAMapStaysAsItIs) {
  write_mesh("a.ply");
  const Path map = work() / "metadata.xml";
  write_text(map, "<M><SRS>EPSG:32633</SRS></M>");
  const std::string config = write_config(R"(, "placement": {"metadata": "metadata.xml"})");
  const Outcome stats = run({"build", config, "--force", "--stats", map.string()});
  EXPECT_EQ(stats.code, kUsage) << stats.messages;
  std::filesystem::create_directory_symlink(work(), work() / "link");
  const Outcome output =
      run({"build", config, "--force", "-o", (work() / "link" / "metadata.xml").string()});
  EXPECT_EQ(output.code, kUsage) << output.messages;
  EXPECT_EQ(text_of(map), "<M><SRS>EPSG:32633</SRS></M>");
}

TEST_F(CommandLine, AMapThatCannotBeUsedIsRefusedAndNothingIsLeft) {
  write_mesh("a.ply");
  const auto refused = [&](const std::string& placement) {
    const Outcome outcome = run({"build", write_config(R"(, "placement": {)" + placement + '}')});
    EXPECT_EQ(outcome.code, kUsage) << outcome.messages;
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"})) << placement;
    return outcome.messages;
  };
  EXPECT_THAT(refused(R"("crs": "EPSG:99999")"), HasSubstr("PROJ knows no CRS"));
  EXPECT_THAT(refused(R"("crs": "EPSG:4326")"), HasSubstr("degrees"));
  EXPECT_THAT(refused(R"("crs": "EPSG:32633", "longitude": 1, "latitude": 2)"),
              HasSubstr("found more than one"));
  EXPECT_THAT(refused(R"("offset": [1, 2, 3])"), HasSubstr("needs \"crs\""));
  // Known only when the mesh was read.
  EXPECT_THAT(refused(R"("crs": "EPSG:32633", "offset": [5e9, 0, 0])"),
              HasSubstr("has no place on the globe"));
}

TEST_F(CommandLine, BuildRefusesABudgetThatCannotDo) {
  write_mesh("a.ply");
  const Outcome outcome = run({"build", write_config(), "--set", "memory_budget=1KiB"});
  EXPECT_EQ(outcome.code, kBudget);
  EXPECT_THAT(outcome.messages, HasSubstr("MiB")) << "names the least that would do";
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(CommandLine, ADryRunTellsAndLeavesNothing) {
  write_mesh("a.ply");
  const Outcome text = run({"build", write_config(), "--dry-run"});
  EXPECT_EQ(text.code, 0) << text.messages;
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("5 partitions"), HasSubstr("free in"), HasSubstr("memory")));
  const Outcome outcome = run({"build", write_config(), "--dry-run", "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.messages;
  EXPECT_EQ(json::parse(outcome.out)["vertices"], 2500);
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(CommandLine, ADryRunRefusesAsTheBuildDoes) {
  build();
  const Outcome exists = run({"build", write_config(), "--dry-run"});
  EXPECT_EQ(exists.code, kExists);
  EXPECT_EQ(exists.messages, run({"build", write_config()}).messages);
  const Outcome budget =
      run({"build", write_config(), "--dry-run", "--force", "--set", "memory_budget=1MiB"});
  EXPECT_EQ(budget.code, kBudget);
  EXPECT_THAT(budget.messages, HasSubstr("at least"));
}

TEST_F(CommandLine, BuildWritesItsAccountWhereItIsAskedTo) {
  write_mesh("a.ply");
  const Path stats = work() / "stats.json";
  const Outcome outcome = run({"build", write_config(), "--verbose", "--stats", stats.string()});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("stage"), HasSubstr("simplify"), HasSubstr("total")));
  const json account = json::parse(text_of(stats));
  EXPECT_EQ(account["vertices"], 2500);
  EXPECT_EQ(account["partitions"], 5);
  EXPECT_EQ(account["config"]["partition"]["vertices"], 500);
  EXPECT_GT(account["total"]["peak_resident_bytes"], 0);
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "stats.json"}));
}

TEST_F(CommandLine, ABuildEndsWithThreeLines) {
  std::filesystem::create_directory(work() / "my $models");
  const Path mesh = write_mesh("my $models/it's.ply");
  const Outcome outcome = run({"build", mesh.string()});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  std::istringstream lines(outcome.out);
  std::string made, took, next, more;
  std::getline(lines, made);
  std::getline(lines, took);
  std::getline(lines, next);
  EXPECT_EQ(made.substr(0, made.rfind(',')),
            "made " + (mesh.parent_path() / "it's.hier").string() +
                ": 2500 vertices, 4802 triangles in 1 partition, 1 level, 1 tile");
  EXPECT_THAT(took, ::testing::MatchesRegex("took [0-9.]+ s and [0-9.]+ MiB of memory, of a "
                                            "budget of [0-9.]+ [MG]iB"));
  EXPECT_EQ(next, "next: " MESHHIER_BINARY " serve '" + mesh.parent_path().string() + "' --open");
  EXPECT_FALSE(std::getline(lines, more)) << more;
}

/// Triangles along a line, in several tiles.
std::string slanted_line() {
  constexpr int kCount = 9000;
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(kCount) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                     std::to_string(kCount - 2) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < kCount; ++i)
    text += fmt::format("{:.1f} {:.1f} {:.1f}\n", 0.1 * i, 0.2 * i, 0.3 * i);
  for (int i = 0; i + 2 < kCount; ++i)
    text += fmt::format("3 {} {} {}\n", i, i + 1, i + 2);
  return text;
}

TEST_F(CommandLine, AMeshWithAnAreaIsNotSaidToHaveNone) {
  // Degrees, and heights in metres.
  std::string text;
  for (int i = 0; i < 441; ++i) {
    text += fmt::format("v {:.8f} {:.8f} {}\n", 139.7 + i % 21 * 1e-5, 35.65 + i / 21 * 1e-5,
                        i % 21 * (i / 21));
  }
  for (int i = 1; i < 420; ++i)
    text += fmt::format("f {} {} {}\n", i, i + 1, i + 21);
  write_text(work() / "a.obj", text);
  EXPECT_THAT(run({"build", (work() / "a.obj").string()}).out, Not(HasSubstr("warning")));
  // A strip that is thinner than a step of the lattice.
  text.clear();
  for (int i = 0; i < 100; ++i)
    text += fmt::format("v {} {} 0\n", i / 2, i % 2 * 0.01);
  for (int i = 1; i < 99; ++i)
    text += fmt::format("f {} {} {}\n", i, i + 1, i + 2);
  write_text(work() / "a.obj", text);
  const std::string out =
      run({"build", (work() / "a.obj").string(), "--force", "--set", "storage.positions.bits=8"})
          .out;
  EXPECT_THAT(out, AllOf(HasSubstr("warning: no triangle has an area once positions are rounded"),
                         Not(HasSubstr("of the mesh has"))));
}

TEST_F(CommandLine, ABuildThatShowsNothingWarns) {
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face ";
  const std::string lists = "\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const std::string point = "1 1 1\n1 1 1\n1 1 1\n1 1 1\n";
  const std::vector<std::pair<std::string, std::string>> meshes{
      {vertices + "0" + lists + corners, "no triangles: viewers show nothing of points alone"},
      {vertices + "1" + lists + corners + "3 0 0 1\n", "all triangles of the mesh are degenerate"},
      {vertices + "1" + lists + point + "3 0 1 2\n", "all vertices of the mesh are at one point"},
      {vertices + "2" + lists + "0 0 0\n1 0 0\n2 0 0\n3 0 0\n" + "3 0 1 2\n3 1 3 2\n",
       "no triangle of the mesh has an area"},
      {vertices + "2" + lists + "0.1 0.2 0.3\n0.2 0.5 1\n0.3 0.8 1.7\n0.4 1.1 2.4\n" +
           "3 0 1 2\n3 1 3 2\n",
       "no triangle of the mesh has an area"},
      {slanted_line(), "no triangle of the mesh has an area"},
      {vertices + "3" + lists + corners + "3 0 0 1\n3 0 1 1\n3 0 1 2\n", "most triangles"},
  };
  for (const auto& [mesh, warning] : meshes) {
    write_text(work() / "a.ply", mesh);
    const Outcome outcome = run({"build", (work() / "a.ply").string(), "--force"});
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("\nwarning: "), HasSubstr(warning)));
  }
  write_text(work() / "a.off",
             "OFF\n7 1 0\n0 0 0\n1 0 0\n0 1 0\n5 5 5\n6 5 5\n5 6 5\n6 6 6\n3 0 1 2\n");
  EXPECT_THAT(run({"build", (work() / "a.off").string(), "--force"}).out,
              HasSubstr("warning: most vertices of the mesh belong to no triangle"));
  write_text(work() / "a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n2 0 0\n2 0.001 0\n3 0 1 2\n3 0 2 3\n");
  EXPECT_THAT(run({"build", (work() / "a.off").string(), "--force"}).out,
              Not(HasSubstr("warning")));
}

TEST_F(CommandLine, AnAccountThatCannotBeWrittenIsRefusedBeforeTheBuild) {
  const Path mesh = write_mesh("a.ply");
  const std::string before = text_of(mesh);
  const std::vector<std::pair<Path, int>> refused{{work() / "absent" / "s.json", kIo},
                                                  {work() / "a.json", kUsage},
                                                  {work(), kUsage},
                                                  {mesh, kUsage},
                                                  {Path(hierarchy()) / "s.json", kUsage}};
  for (const auto& [path, code] : refused) {
    const Outcome outcome = run({"build", write_config(), "--stats", path.string()});
    EXPECT_EQ(outcome.code, code) << path << ": " << outcome.messages;
    EXPECT_THAT(outcome.messages, HasSubstr(path.filename().string()));
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
  }
  EXPECT_EQ(text_of(mesh), before);
}

/// A triangle with a library and a picture (one red texel) of its own.
class WithCompanions : public CommandLine {
 protected:
  WithCompanions() {
    write_text(work() / "a.obj",
               "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
               "f 1/1 2/2 3/3\n");
    write_library("a.png");
    write_picture(work() / "a.png");
  }
  void write_library(const std::string& picture) const {
    write_text(work() / "a.mtl", "newmtl m\nmap_Kd " + picture + '\n');
  }
  static void write_picture(const Path& path) {
    constexpr unsigned char kPng[] = {
        0x89, 'P',  'N',  'G',  '\r', '\n', 0x1a, '\n', 0,   0,    0,    13,   'I',  'H',
        'D',  'R',  0,    0,    0,    1,    0,    0,    0,   1,    8,    2,    0,    0,
        0,    0x90, 0x77, 0x53, 0xde, 0,    0,    0,    12,  'I',  'D',  'A',  'T',  0x78,
        0x9c, 0x63, 0xf8, 0xcf, 0xc0, 0,    0,    3,    1,   1,    0,    0xc9, 0xfe, 0x92,
        0xef, 0,    0,    0,    0,    'I',  'E',  'N',  'D', 0xae, 0x42, 0x60, 0x82};
    write_text(path, {reinterpret_cast<const char*>(kPng), sizeof kPng});
  }
  std::uint64_t texels() const {
    const json manifest = json::parse(text_of(Path(hierarchy()) / "hierarchy.json"));
    return manifest["source"].contains("textures")
               ? manifest["source"]["textures"]["texels"].get<std::uint64_t>()
               : 0;
  }
  std::string obj() const { return (work() / "a.obj").string(); }
};

TEST_F(WithCompanions, WhatAMeshNamesIsNotReplacedByAnAccount) {
  const auto before = contents(work());
  for (const char* option : {"--stats", "--input-note"}) {
    for (const char* name : {"a.mtl", "a.png", "a.obj"}) {
      const Outcome outcome = run({"build", obj(), "--force", option, (work() / name).string()});
      EXPECT_EQ(outcome.code, kUsage) << outcome.messages;
      EXPECT_THAT(outcome.messages, HasSubstr("it would replace " + (work() / name).string()));
      EXPECT_EQ(contents(work()), before) << option << ' ' << name;
    }
  }
  std::filesystem::create_symlink("a.png", work() / "link");
  EXPECT_EQ(run({"build", obj(), "--force", "--stats", (work() / "link").string()}).code, kUsage);
  EXPECT_EQ(run({"build", obj(), "--stats", (work() / "s.json").string()}).code, 0);
  EXPECT_EQ(texels(), 1U);
}

TEST_F(WithCompanions, AnOutputThatHoldsWhatAMeshNamesIsNotReplaced) {
  ASSERT_EQ(run({"build", obj()}).code, 0);
  write_picture(Path(hierarchy()) / "tiles/a.png");
  write_library("a.hier/tiles/a.png");
  const Outcome outcome = run({"build", obj(), "--force"});
  EXPECT_NE(outcome.code, 0);
  EXPECT_TRUE(std::filesystem::exists(Path(hierarchy()) / "tiles/a.png"));
}

TEST_F(CommandLine, AHierarchyHasNoNameOfAnotherFormat) {
  const std::string mesh = write_mesh("a.ply").string();
  for (const char* name : {"a.glb", "a.HTML", "a.zip", "a.obj", "a.ply.gz", "a.json", "a.png"}) {
    for (const Arguments& words :
         {Arguments{"build", mesh, "-o", name},
          {"build", mesh, "-o", name, "--dry-run"},
          {"build", "--set", "input=" + mesh, std::string("output=") + name},
          {"plan", mesh, "-o", name, "--work", (work() / "w").string(), "--tasks", "2"}}) {
      const Outcome outcome = run(words);
      EXPECT_EQ(outcome.code, kUsage) << name;
      EXPECT_THAT(outcome.messages, HasSubstr(": a build makes a hierarchy, a directory or one"));
    }
  }
  EXPECT_EQ(names(), (std::set<std::string>{"a.ply"}));
  const std::string dotted = (work() / "a.v2").string();
  EXPECT_EQ(run({"build", mesh, "-o", dotted, "--set", "preview=false"}).code, 0);
}

// ---- a system that gives little

/// The program by a shell that has set something before.
class Limited : public CommandLine {
 protected:
  Outcome run_after(const std::string& setting, const Arguments& arguments) const {
    Arguments words{"-c", setting + "; exec \"$0\" \"$@\"", MESHHIER_BINARY};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run_program(words, work().parent_path(), "", "/bin/bash");
  }
};

TEST_F(Limited, AFolderForTemporaryFilesThatIsNotThereIsNamed) {
  build();
  const std::string mesh = (work() / "a.ply").string();
  const Outcome outcome = run_after("TMPDIR=/nonexistent; export TMPDIR", {"compare", mesh, mesh});
  EXPECT_EQ(outcome.code, kIo);
  EXPECT_THAT(outcome.messages, AllOf(HasSubstr("/nonexistent (TMPDIR)"), HasSubstr("set TMPDIR")));
  const Outcome file = run_after("TMPDIR=" + mesh + "; export TMPDIR", {"compare", mesh, mesh});
  EXPECT_EQ(file.code, kIo);
  EXPECT_THAT(file.messages, HasSubstr("is no directory"));
}

TEST_F(Limited, LittleMemoryIsToldAndNothingElse) {
  build();
  const std::string mesh = (work() / "a.ply").string();
  const std::vector<Arguments> calls{
      {"build", mesh, "-o", (work() / "b.hier").string(), "--force", "--restart"},
      {"verify", hierarchy()},
      {"export", hierarchy(), "--level", "0", "-o", (work() / "b.ply").string(), "--force"}};
  int enough = 0;
  for (int kilobytes = 40'000; kilobytes <= 400'000; kilobytes = kilobytes * 9 / 8) {
    for (const Arguments& call : calls) {
      const Outcome outcome = run_after("ulimit -v " + std::to_string(kilobytes), call);
      constexpr int kNotStarted = 127;  // by the loader
      EXPECT_THAT(outcome.code, ::testing::AnyOf(0, kBudget, kNotStarted))
          << kilobytes << ' ' << call[0] << ": " << outcome.messages;
      enough += outcome.code == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(enough, 0);
}

TEST_F(Limited, FewerThreadsDo) {
  build();
  const std::string mesh = (work() / "a.ply").string();
  const auto before = contents(hierarchy());
  const std::string made = (work() / "b.hier").string();
  // The system limits no user 0: another one, who may open what user 0 may, since the program and
  // the folder of the tests may lie where nobody else comes.
  const std::string as_another =
      "exec setpriv --reuid=65534 --inh-caps=-all,+dac_override --ambient-caps=-all,+dac_override "
      "bash -c '";
  const std::string then = " exec \"$0\" \"$@\"";
  const auto run_limited = [&](const std::string& setting, const Arguments& arguments) {
    return ::geteuid() == 0 ? run_after(as_another + setting + then + "' \"$0\" \"$@\"", arguments)
                            : run_after(setting.empty() ? ":" : setting + " true", arguments);
  };
  if (const Outcome start = run_limited("", {"--version"}); start.code != 0)
    GTEST_SKIP() << "no process of another user can be started here: " << start.messages;
  for (const int most : {1, 2, 3, 4}) {
    const Outcome outcome = run_limited(
        "ulimit -u " + std::to_string(most) + " &&",
        {"build", mesh, "-o", made, "--set", "partition.vertices=500", "preview=false", "--force"});
    EXPECT_EQ(outcome.code, 0) << most << ": " << outcome.messages;
    EXPECT_TRUE(contents(made) == before) << most;
  }
}

TEST_F(CommandLine, TheAccountAndTheNoteAreTwoFiles) {
  const std::string mesh = write_mesh("a.ply").string();
  std::filesystem::create_symlink("x", work() / "y");
  for (const auto& [stats, note] : std::vector<std::pair<std::string, std::string>>{
           {(work() / "x").string(), (work() / "x").string()},
           {(work() / "x").string(), (work() / "y").string()},
           {"-", "-"}}) {
    const Outcome outcome = run({"build", mesh, "--stats", stats, "--input-note", note, "--force"});
    EXPECT_EQ(outcome.code, kUsage);
    EXPECT_THAT(outcome.messages, HasSubstr("both name"));
    EXPECT_EQ(names(), (std::set<std::string>{"a.ply", "y"}));
  }
}

// ---- input that is guarded

TEST_F(CommandLine, ALinkOnTheWayToAnInputIsNotFollowed) {
  std::filesystem::create_directory(work() / "secret");
  std::filesystem::create_directory_symlink("secret", work() / "house");
  write_text(work() / "secret/a.off", "OFF\nroot:x:secret");
  write_text(work() / "secret/shadow", "root:x:secret");
  for (const char* name : {"house/a.off", "house/shadow"}) {
    for (const Arguments& guard : {Arguments{"--no-links"}, {"--within", work().string()}}) {
      Arguments arguments{"build", (work() / name).string()};
      arguments.insert(arguments.end(), guard.begin(), guard.end());
      const Outcome outcome = run(arguments);
      EXPECT_EQ(outcome.code, kIo) << name;
      EXPECT_THAT(outcome.messages, AllOf(HasSubstr("house is a link"), Not(HasSubstr("root:"))));
    }
  }
  const Outcome outside =
      run({"build", (work() / "secret/a.off").string(), "--within", (work() / "house").string()});
  EXPECT_EQ(outside.code, kIo);
  EXPECT_THAT(outside.messages, AllOf(HasSubstr("does not lie in"), Not(HasSubstr("root:"))));
  EXPECT_EQ(run({"build", "a.ply", "--no-links", "--within", "."}).code, kUsage);
}

TEST_F(WithCompanions, WhatLiesElsewhereIsMissing) {
  std::filesystem::create_directory(work() / "in");
  for (const char* name : {"a.obj", "a.mtl"})
    std::filesystem::rename(work() / name, work() / "in" / name);
  const auto built = [&](const std::string& picture, const Arguments& guard) {
    write_text(work() / "in/a.mtl", "newmtl m\nmap_Kd " + picture + '\n');
    Arguments arguments{"build", (work() / "in/a.obj").string(), "-o", hierarchy(), "--force",
                        "--set", "missing_images=ignore"};
    arguments.insert(arguments.end(), guard.begin(), guard.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    return texels();
  };
  const Arguments within{"--within", (work() / "in").string()};
  EXPECT_EQ(built("../a.png", {}), 1U);
  EXPECT_EQ(built("../a.png", {"--no-links"}), 1U);
  EXPECT_EQ(built("../a.png", within), 0U);
  EXPECT_EQ(built((work() / "a.png").string(), within), 0U);
  std::filesystem::create_directory_symlink("..", work() / "in/up");
  EXPECT_EQ(built("up/a.png", {}), 1U);
  EXPECT_EQ(built("up/a.png", {"--no-links"}), 0U);
  EXPECT_EQ(built("up/a.png", within), 0U);
  std::filesystem::rename(work() / "a.png", work() / "in/a.png");
  EXPECT_EQ(built("a.png", within), 1U);
}

TEST_F(CommandLine, ABuildThatFailsLeavesNoAccount) {
  write_mesh("a.ply", 2500);  // no such vertex
  const Outcome outcome =
      run({"build", write_config(), "--stats", (work() / "stats.json").string()});
  EXPECT_EQ(outcome.code, kInput);
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(CommandLine, SetTakesSeveralSettingsInAnyPlace) {
  write_mesh("a.ply");
  const std::string config = write_config();
  const std::string output = "output=" + (work() / "b.hier").string();
  const std::vector<Arguments> forms{
      {"build", config, "--set", "partition.count=3", output},
      {"build", config, "--set", "partition.count=3", "--set", output},
      {"build", "--set", "partition.count=3", output, config},
      {"build", "--set", "partition.count=3", "--set", output, "--force", config}};
  for (const Arguments& arguments : forms) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    const Outcome inspected = run({"inspect", (work() / "b.hier").string(), "--json"});
    EXPECT_EQ(json::parse(inspected.out).at("partitions").at("count"), 3);
    std::filesystem::remove_all(work() / "b.hier");
  }
}

// ---- a build of meshes

TEST_F(CommandLine, AMeshIsEnough) {
  const std::string mesh = write_mesh("a.ply").string();
  const Outcome made = run({"build", mesh, "--set", "partition.vertices=500"});
  ASSERT_EQ(made.code, 0) << made.messages;
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.ply"}));
  const auto by_mesh = contents(hierarchy());
  EXPECT_EQ(run({"build", mesh}).code, kExists);
  EXPECT_EQ(run({"build", write_config(), "--force", "--set", "preview=true"}).code, 0);
  EXPECT_EQ(contents(hierarchy()), by_mesh);
  EXPECT_EQ(run({"build", "--set", "partition.vertices=500", "--force", mesh}).code, 0);
  EXPECT_EQ(run({"build", "--force", "--set", "partition.vertices=500", mesh}).code, 0);
  EXPECT_EQ(contents(hierarchy()), by_mesh);
}

TEST_F(CommandLine, AMeshIsKnownByItsContent) {
  const Path mesh = write_mesh("b.dat");
  ASSERT_EQ(run({"build", mesh.string()}).code, 0);
  std::filesystem::rename(mesh, work() / "mesh.obj.gz");
  ASSERT_EQ(run({"build", (work() / "mesh.obj.gz").string()}).code, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"b.dat.hier", "mesh.hier", "mesh.obj.gz"}));
}

TEST_F(CommandLine, TheOutputIsNamedByO) {
  const std::string mesh = write_mesh("a.ply").string();
  ASSERT_EQ(run({"build", mesh, "-o", (work() / "new" / "x.hier").string()}).code, 0);
  EXPECT_TRUE(std::filesystem::is_directory(work() / "new" / "x.hier"));
  const std::string archive = (work() / "x.3tz").string();
  ASSERT_EQ(run({"build", mesh, "--output", archive}).code, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(archive));
  ASSERT_EQ(run({"build", mesh, "--set", "storage.container=3tz"}).code, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(work() / "a.3tz"));
  ASSERT_EQ(run({"build", write_config(), "-o", (work() / "y.3tz").string()}).code, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(work() / "y.3tz"));
  EXPECT_FALSE(std::filesystem::exists(hierarchy()));
}

TEST_F(CommandLine, SeveralMeshesAreJoinedUnderAName) {
  const std::string mesh = write_mesh("a.ply").string();
  const std::string other = write_mesh("b.ply").string();
  const Outcome nameless = run({"build", mesh, other});
  EXPECT_EQ(nameless.code, kUsage);
  EXPECT_THAT(nameless.messages, HasSubstr("name it by -o"));
  ASSERT_EQ(run({"build", mesh, other, "-o", hierarchy()}).code, 0);
  EXPECT_EQ(run({"verify", hierarchy(), "--input", mesh, "--input", other}).code, 0);
  const std::string output = "output=" + hierarchy();
  EXPECT_EQ(run({"build", mesh, "--force", "--set", "weld=true", output, other}).code, 0);
  EXPECT_EQ(run({"verify", hierarchy(), "--input", mesh, "--input", other}).code, 0);
}

TEST_F(CommandLine, AKeyIsGivenOnce) {
  const std::string mesh = write_mesh("a.ply").string();
  const std::vector<Arguments> twice{
      {"build", mesh, "-o", "x.hier", "--set", "output=y.hier"},
      {"build", mesh, "--set", "input=" + mesh},
      {"build", mesh, write_config(), "-o", "x.hier"},
  };
  for (const Arguments& arguments : twice)
    EXPECT_EQ(run(arguments).code, kUsage) << ::testing::PrintToString(arguments);
  EXPECT_THAT(run(twice[0]).messages, HasSubstr("-o: \"output\" is given by --set as well"));
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(CommandLine, WhatIsNeitherAMeshNorAConfigIsToldSo) {
  write_text(work() / "a.txt", "Dear Sir,");
  const Outcome letter = run({"build", (work() / "a.txt").string()});
  EXPECT_EQ(letter.code, kUsage);
  EXPECT_THAT(letter.messages,
              HasSubstr("expected a mesh (PLY, OBJ, glTF, STL or OFF, perhaps in gzip) "
                        "or a config (JSON), found 'Dear Sir,'"));
  write_text(work() / "a.ply", "Dear Sir,");
  const Outcome ply = run({"build", (work() / "a.ply").string()});
  EXPECT_EQ(ply.code, kInput);
  EXPECT_THAT(ply.messages, HasSubstr("expected a mesh"));
  const Outcome folder = run({"build", work().string()});
  EXPECT_EQ(folder.code, kIo);
  EXPECT_THAT(folder.messages, HasSubstr("is a folder; name the mesh in it"));
  write_text(work() / "a.json", "{");
  EXPECT_THAT(run({"build", (work() / "a.json").string()}).messages,
              AllOf(HasSubstr("line 1, column"), Not(HasSubstr("json.exception"))));
}

TEST_F(CommandLine, APlaceThatTakesNoOutputIsToldByTheNameThatWasGiven) {
  const std::string mesh = write_mesh("a.ply").string();
  const std::vector<std::pair<std::string, std::string>> places{
      {mesh + "/x.hier", mesh + " is not a directory"},
      {"/proc/x.hier", "/proc cannot be written"},
      {"/proc/absent/x.hier", "/proc cannot be written"},
      {(work() / std::string(250, 'x')).string(), "its name is too long"},
  };
  for (const auto& [output, why] : places) {
    for (const Arguments& more : {Arguments{}, Arguments{"--dry-run"}}) {
      Arguments arguments{"build", mesh, "-o", output};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const Outcome outcome = run(arguments);
      EXPECT_EQ(outcome.code, kIo);
      EXPECT_THAT(outcome.messages, AllOf(HasSubstr("cannot make " + output + ": "), HasSubstr(why),
                                          Not(HasSubstr("meshhier-work"))));
    }
  }
  EXPECT_EQ(names(), (std::set<std::string>{"a.ply"}));
}

TEST_F(CommandLine, AFileThatCannotBeWrittenIsToldByTheNameThatWasGiven) {
  if (!std::filesystem::exists("/proc"))
    GTEST_SKIP() << "there is no /proc here";
  build();
  for (const Arguments& arguments :
       {Arguments{"export", hierarchy(), "--level", "0", "-o", "/proc/x.ply"},
        {"export", hierarchy(), "--level", "0", "-o", "/proc/x.obj"},
        {"preview", hierarchy(), "-o", "/proc/x.png"},
        {"build", write_config(), "--force", "--stats", "/proc/x.js"},
        {"build", write_config(), "--force", "--input-note", "/proc/x"},
        {"progressive", hierarchy(), "-o", "/proc/x.prog"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, kIo) << arguments[0];
    EXPECT_THAT(outcome.messages,
                AllOf(HasSubstr(" /proc/x"), HasSubstr("/proc cannot be written"),
                      HasSubstr("choose another place"), Not(HasSubstr("meshhier-"))));
  }
}

TEST_F(CommandLine, ADamagedManifestIsToldWithoutTheParsersName) {
  build();
  write_text(work() / "a.hier" / "hierarchy.json", "{\"a\": ]");
  EXPECT_THAT(run({"inspect", hierarchy()}).messages,
              AllOf(HasSubstr("is not valid JSON: line 1"), Not(HasSubstr("json.exception"))));
}

// ---- progress

TEST_F(CommandLine, ProgressAsJsonLinesIsValidAndComplete) {
  write_mesh("a.ply");
  const Outcome outcome = run({"build", write_config(), "--progress", "json"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  std::istringstream lines(outcome.messages);
  std::string open_stage;
  std::string last_event;
  double job_done = 0;
  for (std::string line; std::getline(lines, line);) {
    const json event = json::parse(line);
    last_event = event.at("event");
    if (last_event == "stage_start") {
      EXPECT_EQ(open_stage, "");
      open_stage = event.at("stage");
    } else if (last_event != "finish") {
      EXPECT_EQ(event.at("stage"), open_stage);
      for (const char* key : {"done", "total", "unit", "rate", "seconds", "eta_seconds", "job_done",
                              "job_eta_seconds"}) {
        EXPECT_TRUE(event.contains(key)) << line;
      }
      EXPECT_GE(event.at("job_done"), job_done) << line;
      job_done = event.at("job_done");
    }
    if (last_event == "stage_end")
      open_stage = "";
  }
  EXPECT_EQ(last_event, "finish");
  EXPECT_EQ(job_done, 1);
  EXPECT_EQ(open_stage, "");
}

TEST_F(CommandLine, FailureIsAJsonLineTooIfProgressIs) {
  write_mesh("a.ply", 9999);
  const Outcome outcome = run({"build", write_config(), "--progress", "json"});
  EXPECT_EQ(outcome.code, kInput);
  std::istringstream lines(outcome.messages);
  json last;
  for (std::string line; std::getline(lines, line);)
    last = json::parse(line);
  EXPECT_EQ(last.at("event"), "error");
  EXPECT_EQ(last.at("code"), kInput);
  EXPECT_THAT(last.at("message").get<std::string>(), HasSubstr("a.ply"));
}

TEST_F(CommandLine, AMistakeInTheArgumentsIsAJsonLineToo) {
  const std::vector<std::pair<Arguments, std::string>> mistakes{
      {{"build", "a.ply", "--bogus", "--progress", "json"}, "--bogus"},
      {{"verify", "--progress=json"}, "HIERARCHY is required"},
      {{"bild", "a.ply", "--progress", "json"}, "did you mean \"build\"?"},
  };
  for (const auto& [arguments, expected] : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, kUsage);
    const json event = json::parse(outcome.messages);
    EXPECT_EQ(event.at("event"), "error");
    EXPECT_EQ(event.at("code"), kUsage);
    EXPECT_THAT(event.at("message").get<std::string>(), HasSubstr(expected));
  }
}

TEST_F(CommandLine, ProgressIsSilentWhereThereIsNoTerminal) {
  write_mesh("a.ply");
  EXPECT_THAT(run({"build", write_config()}).messages, IsEmpty());
  EXPECT_THAT(run({"build", write_config(), "--force", "--progress", "none"}).messages, IsEmpty());
  EXPECT_THAT(run({"build", write_config(), "--force", "--progress", "bar"}).messages,
              AllOf(HasSubstr("simplify "), Not(HasSubstr("\r"))));
}

// ---- inspect, verify, export

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

TEST_F(CommandLine, VerifyPassesWhatBuildMade) {
  build();
  const Outcome plain = run({"verify", hierarchy()});
  EXPECT_EQ(plain.code, 0) << plain.out << plain.messages;
  EXPECT_THAT(plain.out, HasSubstr("No problem found."));
  const Outcome with_input =
      run({"verify", hierarchy(), "--input", (work() / "a.ply").string(), "--cuts", "50", "--seed",
           "18446744073709551615", "--memory-budget", "256MiB", "--json"});
  EXPECT_EQ(with_input.code, 0) << with_input.out << with_input.messages;
  const json report = json::parse(with_input.out);
  EXPECT_EQ(report.at("ok"), true);
  EXPECT_THAT(report.at("problems"), IsEmpty());
  EXPECT_THAT(report.at("checks"), Not(IsEmpty()));
}

TEST_F(CommandLine, CompareMakesAHierarchyThatIsShownByTheDistance) {
  write_mesh("a.ply");
  ASSERT_EQ(run({"build", write_config()}).code, 0);
  const std::string output = work() / "difference.hier";
  const Outcome made = run({"compare", hierarchy(), hierarchy(), "-o", output});
  EXPECT_EQ(made.code, 0) << made.messages;
  EXPECT_THAT(made.messages, HasSubstr("made "));
  EXPECT_THAT(run({"inspect", output}).out, HasSubstr("distance   f32 quantity, 0 to 0"));
  EXPECT_EQ(run({"verify", output}).code, 0);
  const std::string picture = work() / "distance.png";
  const Outcome drawn = run({"preview", output, "--attribute", "distance", "--ramp", "turbo",
                             "--range", "-1,1", "--size", "64x64", "-o", picture});
  EXPECT_EQ(drawn.code, 0) << drawn.messages;
  const std::string another = work() / "no.png";
  const Outcome none = run({"preview", output, "--attribute", "distnce", "-o", another});
  EXPECT_EQ(none.code, kUsage);
  EXPECT_THAT(none.messages, HasSubstr("the hierarchy has distance"));
  EXPECT_EQ(run({"preview", output, "--ramp", "turbo", "-o", another}).code, kUsage);
  EXPECT_EQ(run({"compare", hierarchy(), hierarchy(), "-o", output}).code, 5) << "it is there";
}

TEST_F(CommandLine, CompareTellsAndItsExitCodeKeepsTheTolerance) {
  write_mesh("a.ply");
  ASSERT_EQ(run({"build", write_config()}).code, 0);
  const Outcome same = run({"compare", hierarchy(), hierarchy(), "--tolerance", "0"});
  EXPECT_EQ(same.code, 0) << same.messages;
  EXPECT_THAT(same.out, AllOf(HasSubstr("within the tolerance of 0"), HasSubstr("percentiles")));
  write_text(work() / "up.txt", "1 0 0 0  0 1 0 0  0 0 1 0.25  0 0 0 1");
  const std::string ply = work() / "difference.ply";
  const Outcome moved = run({"compare", hierarchy(), hierarchy(), "--tolerance", "1e-3", "--json",
                             "--transform", work() / "up.txt", "-o", ply});
  EXPECT_EQ(moved.code, 1) << moved.messages;
  const auto report = nlohmann::json::parse(moved.out);
  EXPECT_GT(report.at("farthest"), 1e-3);
  EXPECT_FALSE(report.at("within"));
  EXPECT_THAT(text_of(ply), HasSubstr("property float distance"));
  EXPECT_EQ(run({"compare", hierarchy(), hierarchy(), "-o", ply}).code, 5) << "it is there";
  const Outcome mesh = run({"compare", hierarchy(), work() / "a.ply", "--tolerance", "0"});
  EXPECT_EQ(mesh.code, 0) << mesh.messages;
  EXPECT_THAT(mesh.out, HasSubstr("a.ply: 1 tile"));
  write_text(work() / "poem.txt", "no mesh");
  EXPECT_EQ(run({"compare", hierarchy(), work() / "poem.txt"}).code, kUsage);
  EXPECT_EQ(run({"compare", hierarchy(), work() / "absent.hier"}).code, 4);
  EXPECT_EQ(run({"compare", hierarchy(), hierarchy(), "--tolerance", "1mm"}).code, kUsage)
      << "the hierarchy does not know its unit";
  EXPECT_EQ(run({"compare", hierarchy(), hierarchy(), "--transform", ply}).code, kUsage);
}

TEST_F(CommandLine, VerifyFindsAFlippedBit) {
  build();
  const Path tile = work() / "a.hier" / "tiles" / "00" / "000000.glb";
  std::string bytes = text_of(tile);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  write_text(tile, bytes);

  const Outcome outcome = run({"verify", hierarchy(), "--json"});
  EXPECT_EQ(outcome.code, kCorrupt);
  EXPECT_EQ(json::parse(outcome.out).at("ok"), false);
  EXPECT_THAT(json::parse(outcome.out).at("problems").dump(), HasSubstr("000000.glb"));
  const Outcome plain = run({"verify", hierarchy()});
  EXPECT_EQ(plain.code, kCorrupt);
  EXPECT_THAT(plain.out, AllOf(HasSubstr("PROBLEM: "), Not(HasSubstr("No problem found."))));
}

TEST_F(CommandLine, VerifyKnowsAnInputWhosePicturesAreMissing) {
  const std::string mesh = (work() / "m.obj").string();
  write_text(mesh,
             "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\n"
             "f 1/1 2/2 3/3\n");
  write_text(work() / "m.mtl", "newmtl a\nmap_Kd lost.jpg\n");
  ASSERT_EQ(run({"build", mesh}).code, 0);
  const Arguments verify{"verify", (work() / "m.hier").string(), "--input", mesh};
  const Outcome same = run(verify);
  EXPECT_EQ(same.code, 0) << same.out;
  write_text(work() / "m.mtl", "newmtl a\nmap_Kd gone.jpg\n");
  const Outcome another = run(verify);
  EXPECT_EQ(another.code, kCorrupt);
  EXPECT_THAT(another.out, HasSubstr("m.mtl (material library)"));
}

TEST_F(CommandLine, VerifyFindsThatTheInputIsAnother) {
  build();
  const Path other = write_mesh("other.ply", 2499, 0.5);
  const Outcome outcome = run({"verify", hierarchy(), "--input", other.string()});
  EXPECT_EQ(outcome.code, kCorrupt) << outcome.out << outcome.messages;
  EXPECT_THAT(outcome.out, HasSubstr("PROBLEM: "));
}

TEST_F(CommandLine, ExportWritesPlyFiles) {
  build();
  write_text(work() / "cut.txt", "# the whole\n0/0\n");
  const std::string ply = (work() / "x.ply").string();
  const std::vector<Arguments> selections{{"--level", "0"},
                                          {"--level", "3"},
                                          {"--node", "2/1"},
                                          {"--cut", (work() / "cut.txt").string()},
                                          {"--outline"}};
  for (const Arguments& selection : selections) {
    Arguments arguments{"export", hierarchy(), "-o", ply, "--memory-budget", "256MiB"};
    arguments.insert(arguments.end(), selection.begin(), selection.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << selection[0] << ": " << outcome.messages;
    EXPECT_THAT(text_of(ply), StartsWith("ply\n"));
    EXPECT_EQ(text_of(ply).find("element edge") != std::string::npos, selection[0] == "--outline");
    std::filesystem::remove(ply);
  }
}

TEST_F(CommandLine, ExportMakesHierarchiesOfPieces) {
  build();
  const std::string ply = (work() / "x.ply").string(), whole = (work() / "whole.ply").string();
  const Arguments box{"--level", "3", "--box", "-9,-9,-9", "9,9,0.2"};
  const auto exported = [&](const std::string& from, Arguments what, const std::string& to) {
    what.insert(what.begin(), {"export", from, "-o", to, "--force"});
    return run(what);
  };
  ASSERT_EQ(exported(hierarchy(), box, ply).code, 0);
  for (const char* name : {"piece.hier", "piece.3tz"}) {
    const std::string piece = (work() / name).string();
    const Outcome outcome = exported(hierarchy(), box, piece);
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    EXPECT_THAT(outcome.out, HasSubstr("its simplified levels are new"));
    EXPECT_EQ(run({"verify", piece, "--input", ply}).code, 0) << "it is the piece, bit for bit";
  }
  EXPECT_EQ(exported(hierarchy(), {"--outline"}, (work() / "o.hier").string()).code, kUsage);
  const Outcome of_itself = exported(hierarchy(), box, hierarchy());
  EXPECT_EQ(of_itself.code, kUsage);
  EXPECT_THAT(of_itself.messages, HasSubstr("it would replace"));
  EXPECT_EQ(exported(hierarchy(), {"--level", "3", "--box", "700,700,700", "800,800,800"},
                     (work() / "none.hier").string())
                .code,
            kUsage);
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "piece.3tz", "piece.hier",
                                            "x.ply"}));
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

TEST_F(CommandLine, ExportReplacesNothingUnasked) {
  build();
  const std::string scan = (work() / "a.ply").string();
  const std::string original = text_of(scan);
  const Arguments outline{"export", hierarchy(), "--outline", "-o", scan};
  const Outcome refused = run(outline);
  EXPECT_EQ(refused.code, kExists);
  EXPECT_THAT(refused.messages, HasSubstr("a.ply is already there; --force replaces it"));
  EXPECT_EQ(text_of(scan), original);

  write_text(work() / "cut.txt", "0/0\n");
  const std::string cut = (work() / "cut.txt").string();
  const Outcome of_itself = run({"export", hierarchy(), "--cut", cut, "-o", cut, "--force"});
  EXPECT_EQ(of_itself.code, kUsage);
  EXPECT_EQ(text_of(cut), "0/0\n");

  const std::string made = (work() / "x.ply").string();
  write_text(made, "old");
  EXPECT_EQ(run({"export", hierarchy(), "--outline", "-o", made, "--force"}).code, 0);
  EXPECT_THAT(text_of(made), StartsWith("ply\n"));
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "cut.txt", "x.ply"}));
}

TEST_F(CommandLine, NothingIsWrittenIntoOtherHierarchies) {
  build();
  const std::string other = (work() / "b.hier").string();
  std::filesystem::copy(hierarchy(), other, std::filesystem::copy_options::recursive);
  const auto before = contents(other);
  for (const char* name : {"tiles/00/000000.glb", "hierarchy.json", "new.ply"}) {
    const std::string place = other + '/' + name;
    const Outcome of_mesh = run({"export", hierarchy(), "--level", "0", "-o", place, "--force"});
    EXPECT_EQ(of_mesh.code, kUsage) << name;
    EXPECT_THAT(of_mesh.messages, HasSubstr("in the hierarchy " + other));
    EXPECT_EQ(
        run({"preview", hierarchy(), "--size", "9x9", "--format", "png", "-o", place, "--force"})
            .code,
        kUsage);
  }
  EXPECT_EQ(contents(other), before);
}

TEST_F(CommandLine, WhatIsReplacedKeepsItsMode) {
  using std::filesystem::perms;
  build();
  const Path made = work() / "x.ply", packed = work() / "a.3tz";
  write_text(made, "old");
  ASSERT_EQ(run({"build", (work() / "a.ply").string(), "-o", packed.string()}).code, 0);
  for (const Path& file : {made, packed})
    std::filesystem::permissions(file, perms::owner_read | perms::owner_write | perms::group_read);
  EXPECT_EQ(run({"export", hierarchy(), "--outline", "-o", made.string(), "--force"}).code, 0);
  EXPECT_EQ(run({"build", (work() / "a.ply").string(), "-o", packed.string(), "--force"}).code, 0);
  for (const Path& file : {made, packed})
    EXPECT_EQ(std::filesystem::status(file).permissions(),
              perms::owner_read | perms::owner_write | perms::group_read)
        << file;
}

/// A viewer's folder, as much of it as pages and sites need.
class CommandLinePage : public CommandLine {
 protected:
  CommandLinePage() {
    std::filesystem::create_directories(viewer() / "assets");
    write_text(viewer() / "index.html", "<title>meshhier</title>");
    write_text(viewer() / "assets/a.js", "script");
    write_text(viewer() / "single.html",
               "<title>meshhier</title>\n<!-- meshhier: hierarchy -->\n<script></script>");
  }
  Path viewer() const { return work() / "viewer"; }
  Outcome page(Arguments arguments) const {
    arguments.insert(arguments.begin(), "page");
    arguments.insert(arguments.end(), {"--viewer", viewer().string()});
    return run(arguments);
  }
  /// What is in a page's script element.
  static nlohmann::json embedded(const Path& file) {
    const std::string text = text_of(file);
    const std::size_t begin = text.find('{'), end = text.find("\n</script>", begin);
    return nlohmann::json::parse(text.substr(begin, end - begin));
  }
};

TEST_F(CommandLinePage, OneFileHasTheHierarchyAsFarAsItFits) {
  build();
  const Path file = work() / "a.html";
  ASSERT_EQ(page({hierarchy(), "-o", file.string()}).code, 0);
  const nlohmann::json all = embedded(file);
  EXPECT_EQ(all["name"], "a");
  EXPECT_FALSE(all.contains("link"));
  std::size_t tiles = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(hierarchy())) {
    const std::string name = entry.path().lexically_relative(hierarchy()).generic_string();
    if (!entry.is_regular_file() || name.starts_with("tileset") || name == "preview.webp")
      continue;
    ASSERT_TRUE(all["files"].contains(name)) << name;
    tiles += name.starts_with("tiles/") ? 1 : 0;
  }
  EXPECT_GT(tiles, 3U);
  const auto size = std::filesystem::file_size(file);
  EXPECT_THAT(text_of(file), HasSubstr("<title>a</title>"));

  const Outcome smaller = page({hierarchy(), "-o", file.string(), "--force", "--size",
                                std::to_string(size * 2 / 3), "--link", "https://h/<a>.3tz"});
  ASSERT_EQ(smaller.code, 0) << smaller.messages;
  EXPECT_LE(std::filesystem::file_size(file), size * 2 / 3);
  EXPECT_THAT(text_of(file), Not(HasSubstr("<a>")));
  const nlohmann::json some = embedded(file);
  EXPECT_EQ(some["link"], "https://h/<a>.3tz");
  EXPECT_TRUE(some["files"].contains("tiles/00/000000.glb"));
  EXPECT_LT(some["files"].size(), all["files"].size());
  EXPECT_THAT(smaller.out, HasSubstr(std::to_string(std::filesystem::file_size(file)) +
                                     " bytes, of which the viewer takes "));
  EXPECT_THAT(smaller.out, HasSubstr("; errors up to"));
  EXPECT_THAT(smaller.out, HasSubstr(" did not fit: the page fetches them from the link"));
}

TEST_F(CommandLinePage, AStoryBesideTheHierarchyIsTold) {
  build();
  const Path file = work() / "a.html", story = hierarchy() + ".story.json";
  const std::string text = R"({"type": "AnnotationPage", "label": "</script>", "items": []})";
  write_text(story, text);
  ASSERT_EQ(page({hierarchy() + "/", "-o", file.string()}).code, 0);
  EXPECT_EQ(embedded(file)["story"], text);
  for (const std::string& bad : {std::string("{"), std::string("[]"), std::string(100'000, '[')}) {
    write_text(story, bad);
    const Outcome outcome = page({hierarchy(), "-o", file.string(), "--force"});
    EXPECT_EQ(outcome.code, kCorrupt);
    EXPECT_THAT(outcome.messages, HasSubstr("a.hier.story.json: it is no JSON object"));
  }
  EXPECT_EQ(embedded(file)["story"], text);
}

/// A story with pictures at these addresses.
std::string story_with_pictures(const std::vector<std::string>& addresses) {
  nlohmann::json bodies = nlohmann::json::array();
  for (const std::string& address : addresses)
    bodies.push_back({{"id", address}, {"type", "Image"}});
  const nlohmann::json note{{"type", "Annotation"}, {"body", bodies}};
  return nlohmann::json{{"type", "AnnotationPage"}, {"items", {note}}}.dump();
}

TEST_F(CommandLinePage, AStorysPicturesBesideItAreInThePage) {
  build();
  const Path file = work() / "a.html";
  const std::string picture = "\x89PNG\r\n\x1a\n1";
  std::filesystem::create_directories(work() / "pictures");
  for (const Path& place : {work() / "pictures/a b.png", work() / "c.jpg",
                            work().parent_path() / "out.png", work() / ".hidden.png"})
    write_text(place, picture);
  write_text(work() / "secret.png", "root:x:0:0");
  std::filesystem::create_symlink(work() / "c.jpg", work() / "link.png");
  const auto pictures_of = [&](const std::vector<std::string>& addresses) {
    write_text(hierarchy() + ".story.json", story_with_pictures(addresses));
    const Outcome outcome = page({hierarchy() + "/", "-o", file.string(), "--force"});
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    const auto story = nlohmann::json::parse(embedded(file)["story"].get<std::string>());
    return std::pair(story["items"][0]["body"], outcome);
  };
  const auto [there, told] =
      pictures_of({"pictures/a%20b.png", "./c.jpg", "pictures/a b.png?v=2#x"});
  ASSERT_EQ(there.size(), 3U);
  for (const auto& body : there)
    EXPECT_EQ(body["id"], "data:image/png;base64,iVBORw0KGgox");
  EXPECT_THAT(told.out, HasSubstr("3 of 3 pictures of the story"));
  EXPECT_THAT(told.messages, Not(HasSubstr("left out")));

  const std::vector<std::string> bad{"../out.png",
                                     (work() / "c.jpg").string(),
                                     "pictures/../../out.png",
                                     "..%2fout.png",
                                     "%2e%2e/out.png",
                                     "link.png",
                                     ".hidden.png",
                                     "secret.png",
                                     "none.png",
                                     "pictures",
                                     "",
                                     "file://" + (work() / "c.jpg").string(),
                                     "javascript:alert(1)",
                                     "https://h.example/a.png",
                                     "//h.example/a.png"};
  const auto [none, all_told] = pictures_of(bad);
  EXPECT_TRUE(none.empty()) << none;
  EXPECT_THAT(all_told.out, HasSubstr("0 of 15 pictures of the story"));
  EXPECT_THAT(all_told.messages,
              HasSubstr("warning: a picture of the story is left out: https://h.example/a.png: it "
                        "is on another host; --fetch-pictures embeds it"));
}

TEST_F(CommandLinePage, AStorysPicturesOfOtherHostsAreFetchedWhereThatIsAsked) {
  build();
  const std::string picture = "GIF89a" + std::string(5000, 'x');
  tests::HttpHost host([&](const tests::HostRequest& request) {
    if (request.target == "/a.gif")
      return tests::answer_with(request, picture);
    if (request.target == "/whole.gif")
      return tests::answer_whole(request, picture);
    if (request.target == "/text.gif")
      return tests::answer_with(request, "no picture");
    if (request.target == "/large.gif")
      return tests::answer_with(request, std::string(3'000'000, 'x'));
    return tests::answer_status(404);
  });
  std::vector<std::string> addresses;
  for (const char* name : {"a.gif", "whole.gif", "text.gif", "large.gif", "none.gif"})
    addresses.push_back(host.url() + name);
  write_text(hierarchy() + ".story.json", story_with_pictures(addresses));
  const Path file = work() / "a.html";
  ASSERT_EQ(page({hierarchy(), "-o", file.string()}).code, 0);
  EXPECT_EQ(host.requests(), 0U);
  const Outcome outcome =
      page({hierarchy(), "-o", file.string(), "--force", "--fetch-pictures", "--size", "2MB"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  EXPECT_THAT(outcome.out, HasSubstr("2 of 5 pictures of the story"));
  EXPECT_THAT(outcome.messages, HasSubstr("text.gif: it is no JPEG"));
  EXPECT_THAT(outcome.messages, HasSubstr("large.gif: it has 2.86 MiB"));
  EXPECT_THAT(outcome.messages, HasSubstr("none.gif: there is no such file on the host"));
  EXPECT_THAT(text_of(file), Not(HasSubstr(host.url())));
}

TEST_F(CommandLinePage, WhatIsWrongIsTold) {
  build();
  const std::string file = (work() / "b.html").string();
  const auto says = [&](const Arguments& arguments, int code, const char* message) {
    const Outcome outcome = page(arguments);
    EXPECT_EQ(outcome.code, code) << message;
    EXPECT_THAT(outcome.messages, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(file));
  };
  says({hierarchy(), "-o", file, "--size", "1000"}, kUsage, "give --size ");
  says({hierarchy(), "-o", file, "--link", "david.3tz"}, kUsage, "--link: expected the address");
  for (const char* secret : {"https://me:word@h/a.3tz", "https://me@h/a.hier", "HTTP://:w@h"})
    says({hierarchy(), "-o", file, "--link", secret}, kUsage, "a user or a password in it");
  says({(work() / "none.hier").string(), "-o", file}, kIo, "none.hier");
  const std::string elsewhere = (work().parent_path() / "c.html").string();
  says({work().string(), "-o", elsewhere, "--link", "https://h/"}, kUsage,
       "--link is for the page of one");
  says({work().string(), "-o", elsewhere, "--fetch-pictures"}, kUsage,
       "--fetch-pictures is for the page of one");
  says({work().string(), "-o", (work().parent_path() / "site").string(), "--size", "20MB"}, kUsage,
       "--size is for the page of one");
  says({work().string(), "-o", elsewhere}, kUsage,
       "the name of an HTML file is for the page of one");
  says({hierarchy(), "-o", (work() / "b.glb").string()}, kUsage, "name it .html");
  std::filesystem::remove(viewer() / "single.html");
  says({hierarchy(), "-o", file}, kIo, "has no single.html");
}

TEST_F(CommandLinePage, AFolderBecomesASite) {
  write_mesh("a.ply");
  const Path models = work() / "models", site = work() / "site";
  std::filesystem::create_directories(models / "sub");
  for (const char* made : {"a.hier", "sub/b c.3tz"}) {
    const Arguments words{"build", (work() / "a.ply").string(), "-o", (models / made).string()};
    ASSERT_EQ(run(words).code, 0);
  }
  write_text(models / "notes.txt", "mine");
  write_text(models / "sub/b c.3tz.story.json", "{}");
  ASSERT_EQ(page({models.string(), "-o", site.string() + "/"}).code, 0);
  EXPECT_EQ(text_of(site / "assets/a.js"), "script");
  EXPECT_FALSE(std::filesystem::exists(site / "single.html"));
  EXPECT_FALSE(std::filesystem::exists(site / "models/notes.txt"));
  for (const char* file : {"sub/b c.3tz", "a.hier/hierarchy.json", "a.hier/tiles/00/000000.glb"})
    EXPECT_EQ(text_of(site / "models" / file), text_of(models / file)) << file;
  const auto listed = nlohmann::json::parse(text_of(site / "models.json"))["models"];
  ASSERT_EQ(listed.size(), 2U);
  EXPECT_EQ(listed[0]["path"], "models/a.hier");
  EXPECT_EQ(listed[0]["preview"], "models/a.hier/preview.webp");
  EXPECT_EQ(listed[1]["path"], "models/sub/b%20c.3tz");
  EXPECT_EQ(listed[1]["preview"], "models/sub/b%20c.3tz.webp");
  EXPECT_THAT(text_of(site / "models/sub/b c.3tz.webp"), HasSubstr("WEBP"));
  EXPECT_EQ(listed[1]["story"], "models/sub/b%20c.3tz.story.json");
  EXPECT_FALSE(listed[0].contains("story"));
  EXPECT_EQ(text_of(site / "models/sub/b c.3tz.story.json"), "{}");
  EXPECT_EQ(run({"verify", (site / "models/a.hier").string()}).code, 0);

  EXPECT_EQ(page({models.string(), "-o", site.string()}).code, kExists);
  std::filesystem::remove_all(models / "a.hier");
  ASSERT_EQ(page({models.string(), "-o", site.string(), "--force"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(site / "models/a.hier"));
  EXPECT_EQ(page({models.string(), "-o", viewer().string(), "--force"}).code, kUsage);
  EXPECT_EQ(page({models.string(), "-o", (models / "site").string()}).code, kUsage);
  EXPECT_EQ(page({viewer().string(), "-o", (work() / "none").string()}).code, kUsage);
  EXPECT_EQ(names(), (std::set<std::string>{"a.ply", "models", "site", "viewer"}));
}

TEST_F(CommandLine, ANameThatIsTooLongIsToldByTheNameThatWasGiven) {
  build();
  const std::string name = (work() / std::string(255, 'x')).string();
  const Outcome outcome = run({"export", hierarchy(), "--level", "0", "-o", name});
  EXPECT_EQ(outcome.code, kIo);
  EXPECT_THAT(outcome.messages,
              HasSubstr("cannot write " + name + ": its name is too long, by 18 bytes"));
}

TEST_F(CommandLine, AnArchiveIsNamedInCapitalsToo) {
  write_mesh("a.ply");
  const Path packed = work() / "A.3TZ";
  ASSERT_EQ(run({"build", (work() / "a.ply").string(), "-o", packed.string()}).code, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(packed));
  EXPECT_EQ(run({"verify", packed.string()}).code, 0);
}

TEST_F(CommandLine, ANoteReplacesNotesAlone) {
  write_mesh("a.ply");
  const std::string note = (work() / "note.json").string();
  const Arguments build{"build", write_config(), "--input-note", note};
  write_text(note, "{\"mine\": true}\n");
  const Outcome refused = run(build);
  EXPECT_EQ(refused.code, kExists);
  EXPECT_THAT(refused.messages, HasSubstr("note.json is already there"));
  EXPECT_EQ(text_of(note), "{\"mine\": true}\n");
  EXPECT_FALSE(std::filesystem::exists(hierarchy())) << "it is told before the work";

  Arguments forced = build;
  forced.push_back("--force");
  EXPECT_EQ(run(forced).code, 0);
  EXPECT_THAT(text_of(note), HasSubstr("a.ply"));
  std::filesystem::remove_all(hierarchy());
  EXPECT_EQ(run(build).code, 0);
}

TEST_F(CommandLine, ExportWritesToStandardOutput) {
  build();
  const std::string ply = (work() / "x.ply").string();
  ASSERT_EQ(run({"export", hierarchy(), "--level", "2", "-o", ply}).code, 0);
  for (const char* place : {"-", "/dev/stdout", "/proc/self/fd/1"}) {
    if (std::filesystem::is_regular_file(std::filesystem::symlink_status(place))) {
      std::cout << place << " is skipped: on this machine it is a file, not standard output\n";
      continue;
    }
    const Outcome outcome = run({"export", hierarchy(), "--level", "2", "-o", place});
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    EXPECT_TRUE(outcome.out == text_of(ply)) << place;
    EXPECT_THAT(outcome.messages, HasSubstr("level 2: "));
  }
}

TEST_F(CommandLine, AClosedStandardOutputTakesNothing) {
  build();
  const std::string ply = (work() / "x.ply").string();
  const std::string command = std::string(MESHHIER_BINARY) + " export " + hierarchy() +
                              " --level 0 --progress none 2>/dev/null >&- -o ";
  EXPECT_EQ(WEXITSTATUS(std::system((command + "-").c_str())), kIo);
  EXPECT_EQ(WEXITSTATUS(std::system((command + ply).c_str())), kIo);  // the summary is lost
  EXPECT_THAT(text_of(ply), AllOf(StartsWith("ply\n"), Not(HasSubstr("level 0: "))));
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "x.ply"}));
}

TEST_F(CommandLine, ExportRefusesWhatIsNoCut) {
  build();
  write_text(work() / "cut.txt", "1/0\n");
  const auto before = names();
  const Outcome outcome = run({"export", hierarchy(), "--cut", (work() / "cut.txt").string(), "-o",
                               (work() / "x.ply").string()});
  EXPECT_EQ(outcome.code, kUsage) << outcome.messages;
  EXPECT_EQ(names(), before);
}

TEST_F(CommandLine, AnArchiveIsAHierarchyForEveryCommand) {
  build();
  const Path archive = work() / "a.3tz";
  const Arguments pack{"build", (work() / "a.json").string(), "--set", "storage.container=3tz",
                       "output=" + archive.string()};
  const Outcome built = run(pack);
  ASSERT_EQ(built.code, 0) << built.messages;
  EXPECT_THAT(built.out, HasSubstr("made " + archive.string()));
  EXPECT_EQ(names(), (std::set<std::string>{"a.3tz", "a.hier", "a.json", "a.ply"}));
  EXPECT_EQ(run(pack).code, kExists);
  EXPECT_THAT(run({"inspect", archive.string()}).out, HasSubstr("a.3tz (format"));
  const std::string mesh = (work() / "a.ply").string();
  EXPECT_EQ(run({"verify", archive.string(), "--input", mesh}).code, 0);
  EXPECT_EQ(run({"verify", archive.string(), "--error", "--samples", "1000"}).code, 0);
  for (const Path& from : {archive, Path(hierarchy())})
    EXPECT_EQ(run({"export", from.string(), "--level", "1", "-o", from.string() + ".ply"}).code, 0);
  EXPECT_EQ(text_of(archive.string() + ".ply"), text_of(hierarchy() + ".ply"));

  std::string bytes = text_of(archive);
  bytes[bytes.size() / 2] ^= 4;
  write_text(archive, bytes);
  EXPECT_EQ(run({"verify", archive.string()}).code, kCorrupt);
  write_text(archive, bytes.substr(0, bytes.size() - 9));
  for (const char* command : {"inspect", "verify"})
    EXPECT_EQ(run({command, archive.string()}).code, kCorrupt) << command;
  const Outcome mistaken = run({"inspect", mesh});
  EXPECT_EQ(mistaken.code, kIo);
  EXPECT_THAT(mistaken.messages, HasSubstr("neither a directory nor a 3tz archive"));
}

TEST_F(CommandLine, ForceFollowsALinkAndReplacesWhatItLeadsTo) {
  build();
  std::filesystem::rename(hierarchy(), work() / "v1.hier");
  std::filesystem::create_directory_symlink("v1.hier", hierarchy());
  const std::string before = text_of(work() / "v1.hier" / "hierarchy.json");
  const Outcome outcome =
      run({"build", (work() / "a.json").string(), "--force", "--set", "simplify.method=cluster"});
  EXPECT_EQ(outcome.code, 0) << outcome.messages;
  EXPECT_TRUE(std::filesystem::is_symlink(hierarchy()));
  EXPECT_NE(text_of(work() / "v1.hier" / "hierarchy.json"), before);
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "v1.hier"}));
}

// ---- progressive streams

class Streams : public CommandLine {
 protected:
  Streams() {
    write_mesh("a.ply");
    const Outcome outcome = run({"build", write_config(R"(,
 "simplify": {"method": "half_edge"})")});
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
  }

  std::string stream() const { return (work() / "a.prog").string(); }
  std::string mesh() const { return (work() / "out.ply").string(); }

  void make_stream() const {
    const Outcome outcome = run({"progressive", hierarchy(), "-o", stream()});
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
  }
};

TEST_F(Streams, AreMadeAndPutTogether) {
  const Outcome made = run({"progressive", hierarchy(), "-o", stream()});
  EXPECT_EQ(made.code, 0) << made.messages;
  EXPECT_THAT(made.out, AllOf(HasSubstr("2500 vertices, 4802 triangles"), HasSubstr("a base of "),
                              HasSubstr("and 3 details")));
  const Outcome rebuilt = run({"reconstruct", stream(), "-o", mesh()});
  EXPECT_EQ(rebuilt.code, 0) << rebuilt.messages;
  EXPECT_THAT(rebuilt.out, HasSubstr("level 3: 2500 vertices, 4802 triangles"));
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "a.prog", "out.ply"}));
  const std::string level = (work() / "level.ply").string();
  ASSERT_EQ(run({"export", hierarchy(), "--level", "3", "-o", level}).code, 0);
  const auto body = [](const std::string& text) { return text.substr(text.find("end_header")); };
  EXPECT_TRUE(body(text_of(mesh())) == body(text_of(level)));
}

TEST_F(Streams, FewerStepsAndSectorsAreAskedForByOptions) {
  const Outcome made =
      run({"progressive", hierarchy(), "--node", "1/0", "--steps", "1", "-o", stream()});
  EXPECT_EQ(made.code, 0) << made.messages;
  EXPECT_THAT(made.out, HasSubstr("and 1 detail,"));
  EXPECT_EQ(run({"reconstruct", stream(), "--details", "0", "-o", mesh()}).code, 0);
  const Outcome too_many = run({"reconstruct", stream(), "--details", "2", "-o", mesh()});
  EXPECT_EQ(too_many.code, kUsage);
  EXPECT_THAT(too_many.messages, HasSubstr("--details 2: the stream has 1"));
}

TEST_F(Streams, AFileThatIsThereIsNotReplacedByReconstruct) {
  make_stream();
  write_text(mesh(), "old");
  EXPECT_EQ(run({"reconstruct", stream(), "-o", mesh()}).code, kExists);
  EXPECT_EQ(text_of(mesh()), "old");
  EXPECT_EQ(run({"reconstruct", stream(), "-o", mesh(), "--force"}).code, 0);
  const Outcome streamed = run({"reconstruct", stream(), "--stats", "-o", "-"});
  EXPECT_EQ(streamed.code, 0) << streamed.messages;
  EXPECT_TRUE(streamed.out == text_of(mesh()));
  EXPECT_THAT(streamed.messages, HasSubstr("the two arrays: "));
}

TEST_F(Streams, StatsAreATableOfTheFiles) {
  make_stream();
  const Outcome outcome = run({"reconstruct", stream(), "--stats", "-o", mesh()});
  EXPECT_EQ(outcome.code, 0) << outcome.messages;
  std::istringstream lines(outcome.out);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    rows.push_back({std::istream_iterator<std::string>(words), {}});
  }
  ASSERT_EQ(rows.size(), 7U);  // a head, four files, the arrays, the summary
  EXPECT_EQ(rows[0], (std::vector<std::string>{"file", "bytes", "entries", "vertices", "triangles",
                                               "ms", "ns/entry"}));
  EXPECT_EQ(rows[1].at(0), "base.bin");
  EXPECT_EQ(rows[1].at(1), std::to_string(std::filesystem::file_size(Path(stream()) / "base.bin")));
  EXPECT_EQ(rows[4].at(0), "detail_03.bin");
  EXPECT_EQ(rows[4].at(3), "2500");
  EXPECT_EQ(rows[4].at(4), "4802");
  EXPECT_THAT(outcome.out, HasSubstr("the two arrays: "));
}

TEST_F(Streams, ProgressIsJsonLines) {
  for (const Arguments& arguments :
       {Arguments{"progressive", hierarchy(), "-o", stream(), "--progress", "json"},
        Arguments{"reconstruct", stream(), "-o", mesh(), "--progress", "json"}}) {
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
    std::istringstream lines(outcome.messages);
    std::string last;
    std::size_t begun = 0, ended = 0;
    for (std::string line; std::getline(lines, line);) {
      const json event = json::parse(line);
      last = event.at("event");
      begun += last == "stage_start" ? 1 : 0;
      ended += last == "stage_end" ? 1 : 0;
    }
    EXPECT_EQ(begun, 2U);
    EXPECT_EQ(ended, 2U);
    EXPECT_EQ(last, "finish");
  }
}

TEST_F(Streams, FailuresHaveTheirCodes) {
  make_stream();
  EXPECT_EQ(run({"progressive", hierarchy(), "-o", stream()}).code, kExists);
  EXPECT_EQ(run({"progressive", hierarchy(), "-o", stream(), "--force"}).code, 0);
  EXPECT_EQ(run({"progressive", hierarchy(), "-o", hierarchy(), "--force"}).code, kUsage);
  const std::string other = (work() / "b.prog").string();
  EXPECT_EQ(run({"progressive", hierarchy(), "-o", other, "--steps", "4"}).code, kUsage);
  EXPECT_EQ(run({"progressive", hierarchy(), "-o", other, "--node", "4/0"}).code, kUsage);
  EXPECT_EQ(run({"progressive", hierarchy(), "-o", other, "--memory-budget", "1"}).code, kBudget);
  EXPECT_EQ(run({"progressive", stream(), "-o", other}).code, kIo);
  EXPECT_EQ(run({"reconstruct", hierarchy(), "-o", mesh()}).code, kIo);
  EXPECT_EQ(run({"reconstruct", stream(), "-o", mesh(), "--memory-budget", "1"}).code, kBudget);
  std::filesystem::resize_file(Path(stream()) / "detail_02.bin", 100);
  const Outcome damaged = run({"reconstruct", stream(), "-o", mesh()});
  EXPECT_EQ(damaged.code, kCorrupt);
  EXPECT_THAT(damaged.messages, AllOf(HasSubstr("detail_02.bin"), HasSubstr("--details 1")));
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "a.prog"}));
  EXPECT_EQ(run({"reconstruct", stream(), "-o", mesh(), "--details", "1"}).code, 0);
}

TEST_F(Streams, AnotherMethodIsRefusedWithWhatToDo) {
  ASSERT_EQ(run({"build", write_config(), "--force"}).code, 0);
  const Outcome outcome = run({"progressive", hierarchy(), "-o", stream()});
  EXPECT_EQ(outcome.code, kUsage);
  EXPECT_THAT(outcome.messages, AllOf(HasSubstr("edge_collapse"), HasSubstr("half_edge")));
}

TEST_F(Streams, CleanKnowsWhatAKilledRunLeaves) {
  make_stream();
  const auto expected = contents(stream());
  // As a kill between the two renames of a replacement leaves it.
  std::filesystem::rename(stream(), work() / ".a.prog.meshhier-old");
  std::filesystem::create_directories(work() / ".a.prog.meshhier-work" / "hierarchy");
  EXPECT_EQ(run({"clean", work().string(), "--remove"}).code, 0);
  EXPECT_EQ(contents(stream()), expected);
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "a.prog"}));
}

TEST_F(CommandLine, AResultThatCannotBeWrittenIsAFailure) {
  if (!std::filesystem::exists("/dev/full"))
    GTEST_SKIP() << "there is no /dev/full here";
  build();
  const Outcome outcome = run({"inspect", hierarchy()}, "/dev/full");
  EXPECT_EQ(outcome.code, kIo);
  EXPECT_THAT(outcome.messages, HasSubstr("standard output"));
}

TEST_F(CommandLine, HelpThatCannotBeWrittenIsAFailure) {
  if (!std::filesystem::exists("/dev/full"))
    GTEST_SKIP() << "there is no /dev/full here";
  for (const Arguments& arguments :
       {Arguments{"--help"}, {"--version"}, {"build", "--help"}, {"build", "--help-config"}}) {
    const Outcome outcome = run(arguments, "/dev/full");
    EXPECT_EQ(outcome.code, kIo) << arguments[0];
    EXPECT_THAT(outcome.messages, HasSubstr("standard output"));
  }
}

// ---- interruption

/// A pipe that is full: whoever writes to it waits until the test reads.
class FullPipe {
 public:
  FullPipe() {
    EXPECT_EQ(pipe2(ends_, O_CLOEXEC), 0);
    const int flags = fcntl(ends_[1], F_GETFL);
    fcntl(ends_[1], F_SETFL, flags | O_NONBLOCK);
    const std::string filling(4096, '.');
    while (write(ends_[1], filling.data(), filling.size()) > 0) {
    }
    while (write(ends_[1], filling.data(), 1) > 0) {
    }
    fcntl(ends_[1], F_SETFL, flags);
  }
  ~FullPipe() {
    close_writer();
    close(ends_[0]);
  }
  int writer() const { return ends_[1]; }
  void close_writer() {
    if (ends_[1] >= 0)
      close(std::exchange(ends_[1], -1));
  }
  /// All that comes until every writer is gone.
  std::string drain() {
    close_writer();
    std::string text;
    char buffer[4096];
    for (ssize_t count = 0; (count = read(ends_[0], buffer, sizeof buffer)) > 0;) {
      text.append(buffer, static_cast<std::size_t>(count));
    }
    return text;
  }

 private:
  int ends_[2] = {-1, -1};
};

/// True once the process has its own handler for the signal, as the kernel tells it.
bool handles(pid_t process, int signal_number) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("SigCgt:"))
      return (std::stoull(line.substr(7), nullptr, 16) >> (signal_number - 1) & 1) != 0;
  }
  return false;
}

bool has_ended(pid_t process) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
         info.si_pid == process;
}

/// Waits until the process has, or has no longer, its own handler for the signal; false if it ends
/// before that.
bool wait_for_handler(pid_t process, int signal_number, bool wanted) {
  while (handles(process, signal_number) != wanted) {
    if (has_ended(process))
      return false;
    usleep(1000);
  }
  return true;
}

/// Starts a build that cannot get past its first line of progress, sends it the signal, then lets
/// it go on. So the signal always comes in the middle, however fast or slow the machine is.
class Interrupted : public CommandLine {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/proc/self/status"))
      GTEST_SKIP() << "there is no /proc here";
  }

  pid_t start_build(const FullPipe& messages) const {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, messages.writer(), STDERR_FILENO);
    const pid_t process =
        spawn({"build", write_config(), "--force", "--progress", "json"}, actions);
    posix_spawn_file_actions_destroy(&actions);
    return process;
  }

  Outcome interrupt_build(int signal_number) const {
    FullPipe messages;
    const pid_t process = start_build(messages);
    EXPECT_TRUE(wait_for_handler(process, signal_number, true));
    kill(process, signal_number);
    Outcome outcome;
    outcome.messages = messages.drain();
    outcome.code = wait_for(process);
    return outcome;
  }
};

TEST_F(Interrupted, BuildStopsWithItsCodeAndGoesOn) {
  write_mesh("a.ply");
  for (const int signal_number : {SIGINT, SIGTERM}) {
    const Outcome outcome = interrupt_build(signal_number);
    EXPECT_EQ(outcome.code, kInterrupted);
    EXPECT_THAT(outcome.messages, HasSubstr(R"("code":130)"));
    EXPECT_FALSE(std::filesystem::exists(hierarchy()));
  }
  EXPECT_EQ(run({"build", (work() / "a.json").string()}).code, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply"}));
}

TEST_F(Interrupted, BuildKeepsTheOutputItWasToReplace) {
  build();
  const auto before = contents(hierarchy());
  write_mesh("a.ply", 2499, 0.5);
  EXPECT_EQ(interrupt_build(SIGINT).code, kInterrupted);
  EXPECT_EQ(contents(hierarchy()), before);
}

TEST_F(Interrupted, ASecondSignalKillsAtOnce) {
  write_mesh("a.ply");
  const FullPipe messages;
  const pid_t process = start_build(messages);
  ASSERT_TRUE(wait_for_handler(process, SIGINT, true));
  kill(process, SIGINT);
  ASSERT_TRUE(wait_for_handler(process, SIGINT, false));  // it has run: it gives the signal back
  kill(process, SIGINT);
  EXPECT_EQ(wait_for(process), 1000 + SIGINT);  // while nobody reads its messages
}

TEST_F(Interrupted, AnotherBuildOfTheOutputIsRefusedMeanwhile) {
  write_mesh("a.ply");
  FullPipe messages;
  const pid_t process = start_build(messages);
  ASSERT_TRUE(wait_for_handler(process, SIGINT, true));
  // Its messages nobody reads, so it stays where it is; the directory is there before the first.
  while (!std::filesystem::exists(work() / ".a.hier.meshhier-work" / "lock"))
    usleep(1000);
  const Outcome second = run({"build", (work() / "a.json").string()});
  EXPECT_EQ(second.code, kExists);
  EXPECT_THAT(second.messages, HasSubstr("at work"));
  const Outcome cleaned = run({"clean", work().string(), "--remove"});
  EXPECT_THAT(cleaned.out, HasSubstr("stays"));
  EXPECT_TRUE(std::filesystem::exists(work() / ".a.hier.meshhier-work" / "lock"));
  kill(process, SIGKILL);
  EXPECT_EQ(wait_for(process), 1000 + SIGKILL);
  EXPECT_EQ(run({"build", (work() / "a.json").string()}).code, 0) << "a dead one's lock is none";
}

/// Builds that are killed, for good.
class Killed : public CommandLine {
 protected:
  /// Starts a build and kills it after so many microseconds; whether it was still at work.
  bool kill_build(useconds_t after) const {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO})
      posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_WRONLY, 0);
    const pid_t process = spawn({"build", (work() / "a.json").string()}, actions);
    posix_spawn_file_actions_destroy(&actions);
    usleep(after);
    kill(process, SIGKILL);
    return wait_for(process) == 1000 + SIGKILL;
  }

  /// Whether all triangles were distributed.
  bool has_work() const {
    const Path journal = work() / ".a.hier.meshhier-work" / "journal";
    return std::filesystem::exists(journal) && text_of(journal).find("ingest") != std::string::npos;
  }

  /// Kills builds until one leaves work behind.
  void leave_work() const {
    for (useconds_t after = 5000; !has_work(); after = after % 400000 + 1000) {
      kill_build(after);
      std::filesystem::remove_all(hierarchy());
    }
  }
};

TEST_F(Killed, TheNextBuildMakesTheSame) {
  build();
  const auto expected = contents(hierarchy());
  std::filesystem::remove_all(hierarchy());
  int kills = 0;
  for (useconds_t after = 0; after < 120000; after += 4000) {
    kills += kill_build(after) ? 1 : 0;
    const Outcome outcome = run({"build", (work() / "a.json").string(), "--force"});
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
    EXPECT_EQ(contents(hierarchy()), expected) << after;
    EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply"}));
    std::filesystem::remove_all(hierarchy());
  }
  EXPECT_GT(kills, 0);
}

TEST_F(Killed, TheNextBuildMakesTheSameArchive) {
  write_mesh("a.ply");
  const Path archive = work() / "a.hier";
  const std::string config = write_config(R"(, "storage": {"container": "3tz"})");
  ASSERT_EQ(run({"build", config}).code, 0);
  const std::string expected = text_of(archive);
  for (useconds_t after = 10000; after < 120000; after += 11000) {
    std::filesystem::remove(archive);
    kill_build(after);
    const Outcome outcome = run({"build", config, "--force"});
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
    EXPECT_EQ(text_of(archive), expected) << after;
    EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply"}));
  }
}

TEST_F(Killed, WorkTowardsAnotherResultIsKeptUnlessItIsToRestart) {
  write_mesh("a.ply");
  write_config();
  leave_work();
  const std::string config = (work() / "a.json").string();
  const Outcome other = run({"build", config, "--set", "partition.vertices=400"});
  EXPECT_EQ(other.code, kExists);
  EXPECT_THAT(other.messages, AllOf(HasSubstr("config.partition.vertices was 500 and is 400"),
                                    HasSubstr("--restart")));
  const Outcome by_level = run({"build", config, "--set", "simplify.vertices=[300, 400]"});
  EXPECT_EQ(by_level.code, kExists);
  EXPECT_THAT(by_level.messages,
              HasSubstr("but config.simplify.vertices was 500 and is [300,400]; --restart"));
  EXPECT_TRUE(has_work());
  const Outcome same = run({"build", config, "--set", "memory_budget=256MiB", "threads=1"});
  EXPECT_EQ(same.code, 0) << same.messages;
  EXPECT_THAT(same.out, HasSubstr("went on"));
  std::filesystem::remove_all(hierarchy());
  leave_work();
  const Outcome anew = run({"build", config, "--set", "partition.vertices=400", "--restart"});
  EXPECT_EQ(anew.code, 0) << anew.messages;
  EXPECT_THAT(anew.out, Not(HasSubstr("went on")));
}

TEST_F(Killed, AnInputThatIsAnotherMeanwhileIsReadAgain) {
  write_mesh("a.ply");
  write_config();
  leave_work();
  write_mesh("a.ply", 2499, 0.5);
  const Outcome outcome = run({"build", (work() / "a.json").string(), "--restart"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  const auto expected = contents(hierarchy());
  std::filesystem::remove_all(hierarchy());
  write_mesh("a.ply");
  leave_work();
  std::string changed = text_of(work() / "a.ply");
  changed[changed.size() - 3] = changed[changed.size() - 3] == '7' ? '6' : '7';
  write_text(work() / "a.ply", changed);
  const Outcome again = run({"build", (work() / "a.json").string()});
  EXPECT_EQ(again.code, 0) << again.messages;
  EXPECT_THAT(again.out, HasSubstr("the input was changed"));
}

TEST_F(Killed, CleanListsAndRemovesWhatIsLeft) {
  write_mesh("a.ply");
  write_config();
  const Outcome nothing = run({"clean", work().string()});
  EXPECT_EQ(nothing.code, 0) << nothing.messages;
  EXPECT_THAT(nothing.out, HasSubstr("nothing"));
  leave_work();
  for (const Path& path : {work(), Path(hierarchy())}) {
    const Outcome listed = run({"clean", path.string()});
    EXPECT_EQ(listed.code, 0) << listed.messages;
    EXPECT_THAT(listed.out, HasSubstr(".a.hier.meshhier-work"));
    EXPECT_TRUE(has_work());
  }
  const json object = json::parse(run({"clean", work().string(), "--json"}).out);
  ASSERT_EQ(object.at("leftovers").size(), 1U);
  EXPECT_GT(object.at("leftovers").at(0).at("bytes").get<int>(), 10000);
  EXPECT_EQ(run({"clean", (work() / "b.hier").string(), "--remove"}).code, 0);
  EXPECT_TRUE(has_work()) << "of another output";
  EXPECT_EQ(run({"clean", work().string(), "--remove"}).code, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(Killed, CleanGivesAReplacedHierarchyItsNameBack) {
  build();
  const auto expected = contents(hierarchy());
  // As a kill between the two renames of a replacement leaves it.
  std::filesystem::rename(hierarchy(), work() / ".a.hier.meshhier-old");
  EXPECT_THAT(run({"clean", work().string()}).out, HasSubstr("only copy"));
  EXPECT_EQ(run({"clean", work().string(), "--remove"}).code, 0);
  EXPECT_EQ(contents(hierarchy()), expected);
}

TEST_F(Killed, CleanRemovesTheNoteOfAHierarchyThatIsGone) {
  build();
  const Path note = work() / ".a.hier.meshhier-input";
  write_text(note, "of serve --watch");
  EXPECT_THAT(run({"clean", work().string()}).out, HasSubstr("nothing")) << "it is still of use";
  std::filesystem::rename(hierarchy(), work() / ".a.hier.meshhier-old");
  EXPECT_EQ(run({"clean", work().string(), "--remove"}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(note)) << "its hierarchy has its name back";
  std::filesystem::remove_all(hierarchy());
  EXPECT_THAT(run({"clean", hierarchy()}).out, HasSubstr(note.filename().string()));
  EXPECT_EQ(run({"clean", work().string(), "--remove"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(note));
}

TEST_F(Killed, CleanGivesAReplacedArchiveItsNameBack) {
  write_mesh("a.ply");
  ASSERT_EQ(run({"build", write_config(R"(, "storage": {"container": "3tz"})")}).code, 0);
  const std::string expected = text_of(hierarchy());
  std::filesystem::rename(hierarchy(), work() / ".a.hier.meshhier-old");
  const json object = json::parse(run({"clean", hierarchy(), "--json"}).out);
  ASSERT_EQ(object.at("leftovers").size(), 1U);
  EXPECT_EQ(object.at("leftovers").at(0).at("bytes").get<std::size_t>(), expected.size());
  EXPECT_EQ(run({"clean", work().string(), "--remove"}).code, 0);
  EXPECT_EQ(text_of(hierarchy()), expected);
}

// ---- plan and task

class Tasks : public CommandLine {
 protected:
  std::string shared() const { return (work() / "shared").string(); }

  Outcome plan(const std::string& tasks = "3") const {
    return run({"plan", write_config(), "--work", shared(), "--tasks", tasks});
  }

  /// The stages as scripts read them.
  std::vector<std::string> stages() const {
    std::istringstream lines(run({"task", shared(), "--stages"}).out);
    std::vector<std::string> names;
    std::string name;
    int tasks = 0;
    while (lines >> name >> tasks) {
      EXPECT_TRUE(tasks == 1 || tasks == 3) << name;
      names.push_back(name);
    }
    return names;
  }
};

TEST_F(Tasks, MakeTheBytesOfABuild) {
  build();
  const auto whole = contents(hierarchy());
  std::filesystem::remove_all(hierarchy());
  const Outcome planned = plan();
  ASSERT_EQ(planned.code, 0) << planned.messages;
  EXPECT_THAT(planned.out, HasSubstr("leaves --index I      for I from 0 to 2"));
  Outcome last;
  for (const std::string& stage : stages()) {
    last = run({"task", shared(), stage});
    ASSERT_EQ(last.code, 0) << stage << last.messages;
  }
  EXPECT_EQ(contents(hierarchy()), whole);
  EXPECT_THAT(last.out, HasSubstr("made "));
  EXPECT_EQ(json::parse(run({"task", shared(), "--status", "--json"}).out).at("finished"), true);
}

TEST_F(Tasks, TakeTheirIndexFromTheScheduler) {
  write_mesh("a.ply");
  ASSERT_EQ(plan().code, 0);
  for (const char* stage : {"read", "distribute", "faces", "join"})
    ASSERT_EQ(run({"task", shared(), stage}).code, 0) << stage;
  ::setenv("JOB_COMPLETION_INDEX", "1", 1);
  const Outcome pod = run({"task", shared(), "leaves"});
  ::unsetenv("JOB_COMPLETION_INDEX");
  EXPECT_EQ(pod.out, "leaves: 1 task done\n");
  ::setenv("SLURM_PROCID", "0", 1);
  ::setenv("SLURM_NTASKS", "2", 1);
  const Outcome step = run({"task", shared(), "leaves"});
  ::unsetenv("SLURM_PROCID");
  ::unsetenv("SLURM_NTASKS");
  EXPECT_EQ(step.out, "leaves: 2 tasks done\n");
  EXPECT_EQ(run({"task", shared(), "leaves"}).out, "leaves: 0 tasks done, 3 before\n");
}

TEST_F(Tasks, SayWhatIsWrong) {
  write_mesh("a.ply");
  EXPECT_EQ(run({"task", shared(), "read"}).code, 2);
  ASSERT_EQ(plan().code, 0);
  EXPECT_EQ(plan().code, 0) << "the same plan";
  EXPECT_EQ(plan("4").code, 5);
  const Outcome unknown = run({"task", shared(), "leave"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.messages, HasSubstr("its stages are: read, distribute, faces, join, leaves"));
  EXPECT_EQ(run({"task", shared()}).code, 2);
  const Outcome early = run({"task", shared(), "leaves"});
  EXPECT_EQ(early.code, 4) << "worth another try";
  EXPECT_THAT(early.messages, HasSubstr("task 0 of stage read is not done"));
  EXPECT_EQ(run({"task", shared(), "leaves", "--index", "3", "--of", "3"}).code, 2);
  EXPECT_THAT(run({"task", shared(), "--status"}).out, HasSubstr("next: stage read"));
  write_text(Path(shared()) / "plan.json", "{}");
  EXPECT_EQ(run({"task", shared(), "read"}).code, 7);
}

}  // namespace
}  // namespace meshhier::app
