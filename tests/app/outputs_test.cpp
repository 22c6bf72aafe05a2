// Outputs of all commands: what is replaced, and what cannot be written.
#include "tests/app/command_line.h"

#include <cstdlib>
#include <filesystem>
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
using ::testing::Not;
using ::testing::StartsWith;

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
        {"draw", hierarchy(), "--cut-height", "0", "-o", "/proc/x.dxf"},
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

TEST_F(CommandLine, AClosedStandardOutputTakesNothing) {
  build();
  const std::string ply = (work() / "x.ply").string();
  const std::string command = "'" MESHHIER_BINARY "' export '" + hierarchy() +
                              "' --level 0 --progress none 2>/dev/null >&- -o '";
  EXPECT_EQ(WEXITSTATUS(std::system((command + "-'").c_str())), kIo);
  EXPECT_EQ(WEXITSTATUS(std::system((command + ply + "'").c_str())), kIo);  // the summary is lost
  EXPECT_THAT(text_of(ply), AllOf(StartsWith("ply\n"), Not(HasSubstr("level 0: "))));
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.json", "a.ply", "x.ply"}));
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

}  // namespace
}  // namespace meshhier::app
