// `meshhier verify` and `compare`.
#include "tests/app/command_line.h"

#include <filesystem>
#include <fstream>
#include <string>

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

/// A square of two faces at `x`, which may have labels.
std::string square_at(int x, bool is_labelled) {
  const std::string label = is_labelled ? " 7\n" : "\n";
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 2\nproperty list uchar int vertex_indices\n";
  text += std::string(is_labelled ? "property int bone\n" : "") + "end_header\n";
  for (const char* rest : {" 0 0\n", " 1 0\n"})
    text += std::to_string(x) + rest + std::to_string(x + 1) + rest;
  return text + "3 0 1 2" + label + "3 1 3 2" + (is_labelled ? " 3\n" : "\n");
}

TEST_F(CommandLine, VerifyTakesAListOfWhichSomeFacesHaveValues) {
  const std::string a = work() / "labelled.ply", b = work() / "plain.ply";
  std::ofstream(a) << square_at(0, true);
  std::ofstream(b) << square_at(5, false);
  const std::string made = work() / "list.hier";
  ASSERT_EQ(run({"build", a, b, "-o", made}).code, 0);
  const Outcome outcome = run({"verify", made, "--input", a, "--input", b});
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("input: 10 vertices and 4 triangles compared"));
}

TEST_F(CommandLine, VerifySaysWhatATableOfObjectsIsNamedBy) {
  const std::string mesh = work() / "b.ply";
  std::ofstream(mesh) << square_at(0, true);
  std::filesystem::create_directory(work() / "tables");
  const std::string table = work() / "tables" / "bones.csv";
  std::ofstream(table) << "id,name\n3,femur\n7,tibia\n";
  const std::string made = work() / "bones.hier";
  ASSERT_EQ(
      run({"build", mesh, "--objects", "label:bone", "--object-table", table, "-o", made}).code, 0);
  const Outcome lacking = run({"verify", made, "--input", mesh});
  EXPECT_EQ(lacking.code, kUsage);
  EXPECT_THAT(lacking.messages, HasSubstr("bones.csv: the table of objects of the hierarchy is not "
                                          "there; name it by another --input"));
  EXPECT_EQ(run({"verify", made, "--input", mesh, "--input", table}).code, 0);
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

}  // namespace
}  // namespace meshhier::app
