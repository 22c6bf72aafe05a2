#include "execution/progress.h"

#include "execution/cancel.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::execution {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

/// Time that passes only when a test says so.
struct Hand {
  double now = 100;
  Clock clock() {
    return [this] { return now; };
  }
};

std::vector<nlohmann::json> json_lines(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(nlohmann::json::parse(line));
  return lines;
}

/// Returns the lines that a terminal shows: "\r" goes back to the start of the line, later letters
/// replace earlier ones.
std::vector<std::string> on_terminal(const std::string& text) {
  std::vector<std::string> lines{""};
  std::size_t column = 0;
  for (const char letter : text) {
    if (letter == '\r' || letter == '\n')
      column = 0;
    if (letter == '\n')
      lines.emplace_back();
    if (letter == '\r' || letter == '\n')
      continue;
    if (column == lines.back().size())
      lines.back().push_back(' ');
    lines.back()[column++] = letter;
  }
  for (std::string& line : lines)
    line.erase(line.find_last_not_of(' ') + 1);
  return lines;
}

TEST(JsonProgress, TellsStartProgressEndAndFinish) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::json, out, false, hand.clock());
  progress->stage("simplify", 400, "tiles");
  hand.now += 2;
  progress->advance(100);
  hand.now += 2;
  progress->stage("outline", 0, "sectors");
  hand.now += 1;
  progress->finish("all well");

  const auto lines = json_lines(out.str());
  ASSERT_THAT(lines, SizeIs(6));
  EXPECT_EQ(lines[0],
            nlohmann::json::parse(R"({"event":"stage_start","stage":"simplify","done":0,"total":400,
      "unit":"tiles","rate":0.0,"seconds":0.0,"eta_seconds":null,
      "job_done":0.0,"job_eta_seconds":null})"));
  EXPECT_EQ(lines[1],
            nlohmann::json::parse(R"({"event":"progress","stage":"simplify","done":100,"total":400,
      "unit":"tiles","rate":50.0,"seconds":2.0,"eta_seconds":6.0,
      "job_done":0.25,"job_eta_seconds":6.0})"));
  EXPECT_EQ(lines[2],
            nlohmann::json::parse(R"({"event":"stage_end","stage":"simplify","done":100,"total":400,
      "unit":"tiles","rate":25.0,"seconds":4.0,"eta_seconds":12.0,
      "job_done":0.25,"job_eta_seconds":12.0})"));
  EXPECT_EQ(lines[3]["stage"], "outline");
  EXPECT_EQ(lines[3]["total"], nullptr);
  EXPECT_EQ(lines[4]["event"], "stage_end");
  EXPECT_EQ(lines[5],
            nlohmann::json::parse(R"({"event":"finish","seconds":5.0,"summary":"all well"})"));
}

TEST(JsonProgress, TellsOfTheWholeJob) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::json, out, false, hand.clock());
  progress->expect({{"leaves", "partitions", 10, 10}, {"simplify", "tiles", 90, 90}});
  progress->stage("leaves", 10, "partitions");
  hand.now += 10;
  progress->advance(10);
  progress->stage("simplify", 90, "tiles");
  hand.now += 45;
  progress->advance(45);
  progress->finish("");
  const auto lines = json_lines(out.str());
  ASSERT_THAT(lines, SizeIs(7));
  EXPECT_EQ(lines[0]["job_done"], 0);
  EXPECT_EQ(lines[0]["job_eta_seconds"], 100);
  EXPECT_DOUBLE_EQ(lines[4]["job_done"], 0.55);
  EXPECT_DOUBLE_EQ(lines[4]["job_eta_seconds"], 45);
  EXPECT_EQ(lines[5]["job_done"], 1);
}

TEST(JsonProgress, WritesAtMostTwoEventsASecond) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::json, out, false, hand.clock());
  progress->stage("ingest", 4096, "blocks");
  for (int i = 0; i < 4096; ++i) {
    hand.now += 1.0 / 1024;
    progress->advance(1);
  }
  // 4 seconds: at 0.5, 1, ... 4, and the start.
  EXPECT_THAT(json_lines(out.str()), SizeIs(9));
  EXPECT_EQ(json_lines(out.str()).back()["done"], 4096);
}

TEST(JsonProgress, AnyBytesInTextsStayValidJson) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::json, out, false, hand.clock());
  progress->stage("in\"gest\n", 1, "blo\xff\xfe");
  progress->finish("\x80");
  EXPECT_THAT(json_lines(out.str()), SizeIs(3));
}

TEST(JsonProgress, CountsOfManyThreadsAddUp) {
  std::ostringstream out;
  std::atomic<int> ticks{0};
  const auto progress =
      make_progress(ProgressMode::json, out, false, [&] { return ticks++ * 0.01; });
  progress->stage("simplify", 40000, "tiles");
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 5000; ++i)
        progress->advance(2);
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  progress->finish("");
  const auto lines = json_lines(out.str());
  ASSERT_GE(lines.size(), 3u);
  EXPECT_EQ(lines[lines.size() - 2]["event"], "stage_end");
  EXPECT_EQ(lines[lines.size() - 2]["done"], 40000);
  for (std::size_t i = 1; i + 1 < lines.size(); ++i)
    EXPECT_GE(lines[i]["done"], lines[i - 1]["done"]);
}

TEST(BarProgress, ShowsTheJobWithItsTimeLeftAndTheStageBesideIt) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::bar, out, true, hand.clock());
  progress->expect({{"ingest", "vertices", 1000, 1}, {"simplify", "tiles", 4000, 99}});
  progress->stage("ingest", 1000, "vertices");
  progress->stage("simplify", 4000, "tiles");
  hand.now += 24.75;
  progress->advance(1000);
  EXPECT_THAT(on_terminal(out.str()),
              ElementsAre("[######..................]  25 %  1 min 12 s left  simplify"));
}

TEST(BarProgress, IsOneLineThatIsWipedAtTheEnd) {
  std::ostringstream out;
  Hand hand;
  {
    const auto progress = make_progress(ProgressMode::bar, out, true, hand.clock());
    progress->stage("ingest", 2500, "blocks");
    hand.now += 1.5;
    progress->advance(2500);
    progress->stage("outline", 0, "sectors");
    hand.now += 7200;
    progress->advance(64);
    EXPECT_THAT(on_terminal(out.str()), ElementsAre("64 sectors  outline"));
    progress->finish("128 tiles");
  }
  EXPECT_THAT(on_terminal(out.str()), ElementsAre(""));
  EXPECT_THAT(out.str(), EndsWith("\r"));
}

TEST(BarProgress, NeverWrapsWhateverTheWidth) {
  for (const std::size_t columns : {0U, 1U, 2U, 7U, 20U, 30U, 41U, 200U}) {
    std::ostringstream out;
    Hand hand;
    std::size_t now = columns;
    {
      const auto progress =
          make_progress(ProgressMode::bar, out, Terminal(true, [&] { return now; }), hand.clock());
      progress->expect({{"simplify", "tiles", 100, 5000}});
      progress->stage("simplify", 100, "tiles");
      hand.now += 1;
      progress->advance(50);
      now = columns / 2 + 1;  // somebody drags the window
      hand.now += 1;
      progress->advance(1);
    }
    std::istringstream pictures(out.str());
    const std::size_t most = (columns == 0 ? 80 : columns) - 1;
    for (std::string picture; std::getline(pictures, picture, '\r');)
      EXPECT_LE(picture.size(), most) << columns;
    EXPECT_THAT(out.str(), Not(HasSubstr("\n")));
  }
}

TEST(PlainProgress, HasALineForEachStageAndNoControlCharacter) {
  std::ostringstream out;
  Hand hand;
  {
    const auto progress = make_progress(ProgressMode::bar, out, false, hand.clock());
    progress->stage("ingest", 2500, "blocks");
    hand.now += 1.5;
    progress->advance(2500);
    progress->stage("outline", 0, "sectors");
    hand.now += 7200;
    progress->advance(64);
    progress->finish("128 tiles");
  }
  EXPECT_EQ(out.str(),
            "ingest     2.50 k blocks in 1.5 s\n"
            "outline    64 sectors in 2 h 00 min\n"
            "done       128 tiles, 2 h 00 min\n");
}

TEST(BarProgress, RedrawsAtMostTenTimesASecond) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::bar, out, true, hand.clock());
  progress->stage("ingest", 4096, "blocks");
  for (int i = 0; i < 4096; ++i) {
    hand.now += 1.0 / 1024;
    progress->advance(1);
  }
  const std::string text = out.str();
  const auto pictures = std::count(text.begin(), text.end(), '\r');
  EXPECT_LE(pictures, 41);
  EXPECT_GE(pictures, 30);
}

TEST(BarProgress, StaysWithinTheLineAndTheTotal) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::bar, out, true, hand.clock());
  progress->stage(std::string(200, 's'), 10, std::string(200, 'u'));
  hand.now += 1;
  progress->advance(std::numeric_limits<std::uint64_t>::max());
  for (const std::string& line : on_terminal(out.str()))
    EXPECT_LE(line.size(), 79u);

  progress->stage("a", 10, "b");
  hand.now += 1;
  progress->advance(500);
  EXPECT_THAT(on_terminal(out.str()).back(),
              AllOf(HasSubstr("] 100 %"), HasSubstr("  0.0 s left")));
}

TEST(BarProgress, AbortedJobLeavesAnEmptyLine) {
  std::ostringstream out;
  Hand hand;
  {
    const auto progress = make_progress(ProgressMode::bar, out, true, hand.clock());
    progress->stage("ingest", 10, "blocks");
  }
  EXPECT_THAT(on_terminal(out.str()), ElementsAre(""));
  EXPECT_THAT(out.str(), EndsWith("\r"));
}

TEST(BarProgress, AdvanceWithoutAStageIsIgnored) {
  std::ostringstream out;
  Hand hand;
  const auto progress = make_progress(ProgressMode::bar, out, true, hand.clock());
  progress->advance(5);
  progress->finish("");
  EXPECT_EQ(out.str(), "");
}

TEST(MakeProgress, AutomaticIsABarOnATerminalOnly) {
  Hand hand;
  for (const bool is_terminal : {true, false}) {
    std::ostringstream out;
    const auto progress = make_progress(ProgressMode::automatic, out, is_terminal, hand.clock());
    progress->stage("ingest", 1, "blocks");
    progress->finish("");
    EXPECT_EQ(out.str().empty(), !is_terminal);
    EXPECT_THAT(out.str(), Not(StartsWith("{")));
  }
}

TEST(MakeProgress, WarningsAreShownInEveryMode) {
  Hand hand;
  for (const ProgressMode mode : {ProgressMode::automatic, ProgressMode::bar, ProgressMode::none}) {
    for (const bool is_terminal : {true, false}) {
      std::ostringstream out;
      const auto progress = make_progress(mode, out, is_terminal, hand.clock());
      progress->stage("ingest", 0, "blocks");
      progress->warn("mind the gap");
      EXPECT_EQ(on_terminal(out.str()).front(), "warning: mind the gap");
    }
  }
  std::ostringstream out;
  make_progress(ProgressMode::json, out, true, hand.clock())->warn("mind the gap");
  EXPECT_EQ(out.str(), R"({"event":"warning","message":"mind the gap"})"
                       "\n");
}

TEST(MakeProgress, NoneWritesNothing) {
  std::ostringstream out;
  const auto progress = make_progress(ProgressMode::none, out, true);
  progress->stage("ingest", 1, "blocks");
  progress->advance(1);
  progress->finish("done");
  EXPECT_EQ(out.str(), "");
}

TEST(SteadyClock, DoesNotGoBack) {
  const Clock clock = steady_clock();
  const double before = clock();
  EXPECT_GE(clock(), before);
}

TEST(CancelToken, ThrowsInterruptedOnceCancelled) {
  CancelToken token;
  EXPECT_NO_THROW(token.check());
  EXPECT_FALSE(token.cancelled());
  token.cancel();
  EXPECT_TRUE(token.cancelled());
  try {
    token.check();
    FAIL() << "check() did not throw";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
}

}  // namespace
}  // namespace meshhier::execution
