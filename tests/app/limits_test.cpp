// The program on a system that gives it little.
#include "tests/app/command_line.h"

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::app {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

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
  const Outcome file = run_after("TMPDIR='" + mesh + "'; export TMPDIR", {"compare", mesh, mesh});
  EXPECT_EQ(file.code, kIo);
  EXPECT_THAT(file.messages, HasSubstr("is no directory"));
}

TEST_F(CommandLine, ABudgetThatIsLessThanTheProgramTakesIsRefusedByAll) {
  const std::vector<Arguments> calls{{"verify", "x"},
                                     {"compare", "x", "y"},
                                     {"query", "x", "--points", "y"},
                                     {"export", "x", "--level", "0", "-o", "y"},
                                     {"preview", "x", "-o", "y.png"},
                                     {"draw", "x", "-o", "y.png"},
                                     {"progressive", "x", "-o", "y"},
                                     {"reconstruct", "x", "-o", "y.ply"}};
  for (Arguments call : calls) {
    call.insert(call.end(), {"--memory-budget", "1"});
    for (const char* less : {"1", "33554431"}) {
      call.back() = less;
      const Outcome outcome = run(call);
      EXPECT_EQ(outcome.code, kBudget) << call[0];
      EXPECT_THAT(outcome.messages, HasSubstr("nearly 32MiB; give that or more")) << call[0];
    }
    call.back() = "32MiB";
    const Outcome enough = run(call);  // refused for something else: there is no such hierarchy
    EXPECT_NE(enough.code, 0) << call[0];
    EXPECT_THAT(enough.messages, testing::Not(HasSubstr("the program itself"))) << call[0];
  }
}

TEST_F(CommandLine, AHierarchyThatIsNotThereIsToldByAllInTheSameWords) {
  const std::string points = (work() / "p.txt").string(), out = (work() / "out").string();
  std::filesystem::create_directories(work() / "empty");
  write_text(points, "0 0 0\n");
  for (const auto& [name, what] : std::vector<std::pair<std::string, std::string>>{
           {"none.hier", "such file or directory"}, {"empty", "hierarchy.json"}}) {
    const std::string place = (work() / name).string();
    const std::vector<Arguments> calls{{"inspect", place},
                                       {"verify", place},
                                       {"verify", place, "--error"},
                                       {"compare", place, place},
                                       {"query", place, "--points", points},
                                       {"export", place, "--level", "0", "-o", out + ".ply"},
                                       {"preview", place, "-o", out + ".png"},
                                       {"draw", place, "--plan", "-o", out + ".png"},
                                       {"view", place},
                                       {"view", place, "--set", "view.up=x"},
                                       {"progressive", place, "-o", out}};
    for (const Arguments& call : calls) {
      const Outcome outcome = run(call);
      EXPECT_EQ(outcome.code, kIo) << call[0];
      EXPECT_EQ(outcome.messages,
                "meshhier: " + place + ": not a hierarchy: there is no " + what + '\n')
          << call[0];
    }
  }
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
  // The system limits no user 0: another one, of whom nothing else runs, and who may open what user
  // 0 may, since the program and the folder of the tests may lie where nobody else comes.
  const std::string as_another =
      "exec setpriv --reuid=" + std::to_string(10'000 + ::getpid() % 50'000) +
      " --inh-caps=-all,+dac_override --ambient-caps=-all,+dac_override "
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

}  // namespace
}  // namespace meshhier::app
