// `meshhier build`: what it makes, tells and refuses.
#include "tests/app/command_line.h"

#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(CommandLine, BuildMakesAHierarchyAndNothingElse) {
  build();
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply"}));
  EXPECT_TRUE(std::filesystem::exists(work() / "a.hier" / "hierarchy.json"));
}

TEST_F(CommandLine, SLOW_ManyTilesAreInSeveralDirectories) {
  constexpr int kVertices = 40'004;  // vertices of a strip, four a partition
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

}  // namespace
}  // namespace meshhier::app
