// `meshhier progressive` and `reconstruct`.
#include "tests/app/command_line.h"

#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

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

}  // namespace
}  // namespace meshhier::app
