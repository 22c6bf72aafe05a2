// `meshhier verify` and `compare`.
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
