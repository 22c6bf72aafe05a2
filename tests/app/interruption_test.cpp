// Builds that are interrupted or killed, and `meshhier clean`.
#include "tests/app/command_line.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fcntl.h>
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
using ::testing::Not;

/// The messages of a program at work.
class Messages {
 public:
  Messages() { EXPECT_EQ(pipe2(ends_, O_CLOEXEC), 0); }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;
  ~Messages() {
    close_writer();
    close(ends_[0]);
  }

  /// The program writes to it.
  pid_t start(const Arguments& arguments) const {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends_[1], STDERR_FILENO);
    const pid_t process = spawn(arguments, actions);
    posix_spawn_file_actions_destroy(&actions);
    return process;
  }
  /// All that comes until `last` is among it, or the program is gone.
  std::string read_until(std::string_view last) {
    close_writer();
    std::string text;
    char buffer[4096];
    for (ssize_t count = 0; text.find(last) == std::string::npos &&
                            (count = read(ends_[0], buffer, sizeof buffer)) > 0;)
      text.append(buffer, static_cast<std::size_t>(count));
    return text;
  }
  /// From now on the program waits as soon as it writes, until the test reads.
  void fill() const {
    const int flags = fcntl(ends_[1], F_GETFL);
    fcntl(ends_[1], F_SETFL, flags | O_NONBLOCK);
    const std::string filling(4096, '.');
    while (write(ends_[1], filling.data(), filling.size()) > 0) {
    }
    while (write(ends_[1], filling.data(), 1) > 0) {
    }
    fcntl(ends_[1], F_SETFL, flags);
  }

 private:
  void close_writer() {
    if (ends_[1] >= 0)
      close(std::exchange(ends_[1], -1));
  }

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

  pid_t start_build(const Messages& messages) const {
    messages.fill();
    return messages.start({"build", write_config(), "--force", "--progress", "json"});
  }

  Outcome interrupt_build(int signal_number) const {
    Messages messages;
    const pid_t process = start_build(messages);
    EXPECT_TRUE(wait_for_handler(process, signal_number, true));
    kill(process, signal_number);
    Outcome outcome;
    outcome.messages = messages.read_until(R"("code":130)");
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
  const Messages messages;
  const pid_t process = start_build(messages);
  ASSERT_TRUE(wait_for_handler(process, SIGINT, true));
  kill(process, SIGINT);
  ASSERT_TRUE(wait_for_handler(process, SIGINT, false));  // it has run: it gives the signal back
  kill(process, SIGINT);
  EXPECT_EQ(wait_for(process), 1000 + SIGINT);  // while nobody reads its messages
}

TEST_F(Interrupted, SLOW_AnotherBuildOfTheOutputIsRefusedMeanwhile) {
  write_mesh("a.ply");
  const Messages messages;
  const pid_t process = start_build(messages);
  ASSERT_TRUE(wait_for_handler(process, SIGINT, true));
  // Its messages nobody reads, so it stays where it is; the directory is there before the first.
  while (!std::filesystem::exists(work() / ".a.hier.meshhier-work" / "lock"))
    usleep(1000);
  const Outcome second = run({"build", (work() / "a.json").string()});
  EXPECT_EQ(second.code, kLocked);
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

  /// Returns whether all triangles were distributed.
  bool has_work() const {
    const Path journal = work() / ".a.hier.meshhier-work" / "journal";
    return std::filesystem::exists(journal) && text_of(journal).find("ingest") != std::string::npos;
  }

  /// Kills builds in the middle until one leaves work behind.
  void leave_work() const {
    while (!has_work()) {
      std::filesystem::remove_all(hierarchy());
      Messages messages;
      const pid_t process =
          messages.start({"build", (work() / "a.json").string(), "--progress", "json"});
      messages.read_until(R"("stage":"leaves")");
      kill(process, SIGKILL);
      wait_for(process);
    }
    std::filesystem::remove_all(hierarchy());
  }
};

TEST_F(Killed, SLOW_TheNextBuildMakesTheSame) {
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

TEST_F(Killed, SLOW_TheNextBuildMakesTheSameArchive) {
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

TEST_F(Killed, SLOW_WorkTowardsAnotherResultIsKeptUnlessItIsToRestart) {
  write_mesh("a.ply");
  write_config();
  leave_work();
  const std::string config = (work() / "a.json").string();
  const Outcome other = run({"build", config, "--set", "partition.vertices=400"});
  EXPECT_EQ(other.code, kOtherWork);
  EXPECT_THAT(other.messages, AllOf(HasSubstr("config.partition.vertices was 500 and is 400"),
                                    HasSubstr("--restart")));
  const Outcome by_level = run({"build", config, "--set", "simplify.vertices=[300, 400]"});
  EXPECT_EQ(by_level.code, kOtherWork);
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

TEST_F(Killed, SLOW_AnUpdateBeginsAnewWhereWorkTowardsAnotherResultWasLeft) {
  write_mesh("a.ply");
  write_config();
  leave_work();
  const std::string config = (work() / "a.json").string();
  const Outcome anew = run({"build", config, "--set", "partition.vertices=400", "--update"});
  EXPECT_EQ(anew.code, 0) << anew.messages;
  EXPECT_THAT(anew.out, Not(HasSubstr("went on")));
  std::filesystem::remove_all(hierarchy());
  leave_work();
  const Outcome same = run({"build", config, "--update"});
  EXPECT_EQ(same.code, 0) << same.messages;
  EXPECT_THAT(same.out, HasSubstr("went on"));
}

TEST_F(Killed, SLOW_AnUpdateImportsOnceWhereWorkTowardsAnotherResultWasLeft) {
  write_mesh("a.ply");
  const std::string config = write_config(R"(, "weld": true)");
  leave_work();
  // Textures decide what is imported: nothing of the work is of use.
  const Outcome anew =
      run({"build", config, "--set", "texture.use=false", "--update", "--progress", "json"});
  EXPECT_EQ(anew.code, 0) << anew.messages;
  EXPECT_THAT(anew.out, HasSubstr("this one began anew"));
  const std::string stage = R"("event":"stage_start","stage":"import","done":0)";
  const std::size_t first = anew.messages.find(stage);
  ASSERT_NE(first, std::string::npos) << anew.messages;
  const std::size_t ingest = anew.messages.find(R"("stage":"ingest")");
  EXPECT_EQ(anew.messages.find(R"("stage":"import")", ingest), std::string::npos);
  EXPECT_FALSE(has_work());
}

TEST_F(Killed, SLOW_AnInputThatIsAnotherMeanwhileIsReadAgain) {
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

}  // namespace
}  // namespace meshhier::app
