// `meshhier export`.
#include "tests/app/command_line.h"

#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

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

TEST_F(CommandLine, ExportDrawsRasters) {
  build();
  const std::string picture = (work() / "o.tif").string(), heights = (work() / "d.tif").string();
  const Outcome both =
      run({"export", hierarchy(), "--gsd", "0.05", "-o", picture, "--dsm", heights});
  EXPECT_EQ(both.code, 0) << both.messages;
  EXPECT_THAT(both.out, HasSubstr("o.tif and "));
  EXPECT_THAT(both.out, HasSubstr("pixels of 0.05"));
  EXPECT_THAT(text_of(picture), StartsWith("II*"));
  EXPECT_THAT(text_of(heights), StartsWith("II*"));
  const Outcome streamed = run({"export", hierarchy(), "--gsd", "0.05", "--dsm", "-"});
  EXPECT_TRUE(streamed.out == text_of(heights)) << "with a picture or without";
  EXPECT_THAT(streamed.messages, HasSubstr("pixels of 0.05"));
  EXPECT_EQ(run({"export", hierarchy(), "-o", picture}).code, kExists);
  for (const Arguments& wrong : {Arguments{"--gsd", "0", "-o", "x.tif"},
                                 {"--gsd", "1", "-o", "x.ply"},
                                 {"--align", "1", "-o", "x.tif"},
                                 {"--outline", "-o", "x.tif"},
                                 {"-o", "-", "--dsm", "-"},
                                 {"--dsm", "x.png"}}) {
    Arguments all{"export", hierarchy()};
    all.insert(all.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(run(all).code, kUsage) << wrong[0] << ' ' << wrong[1];
  }
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

}  // namespace
}  // namespace meshhier::app
