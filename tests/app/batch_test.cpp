// Builds for cron and scripts: `build --update`, `build --each`, `serve --once`.
#include "storage/io/file.h"
#include "tests/app/command_line.h"
#include "tests/app/small_picture.h"
#include "tests/support/wait_until.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

namespace meshhier::app {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

void set_time(const fs::path& file, fs::file_time_type time) {
  fs::last_write_time(file, time);
}

class Update : public CommandLine {
 protected:
  /// Without a preview and normal maps, which take most of so small a build.
  static Arguments update(const fs::path& input, const Arguments& more = {}) {
    Arguments words{"build", input.string(),  "--update",
                    "--set", "preview=false", "storage.normals=smooth"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Whether a build with these words does nothing, and says so; else it must have succeeded.
  testing::AssertionResult is_up_to_date(const fs::path& input, const Arguments& more = {}) const {
    const Outcome outcome = run(update(input, more));
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    const bool says_so = outcome.out.ends_with(" is up to date\n");
    EXPECT_NE(says_so, outcome.out.starts_with("made ")) << outcome.out;
    return says_so ? testing::AssertionSuccess() : testing::AssertionFailure() << outcome.out;
  }
  fs::path output() const { return work() / "a.hier"; }
  fs::path note() const { return work() / ".a.hier.meshhier-input"; }

  fs::path write_obj() const {
    write_text(work() / "a.obj",
               "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
               "usemtl m\nf 1/1 2/2 3/3\nf 2/2 4/4 3/3\n");
    return work() / "a.obj";
  }
};

TEST_F(Update, BuildsWhatIsNotThereAndNothingTwice) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_FALSE(is_up_to_date(mesh));
  const auto before = contents(output());
  const auto time = fs::last_write_time(output() / "hierarchy.json");
  EXPECT_TRUE(is_up_to_date(mesh));
  EXPECT_TRUE(is_up_to_date(mesh, {"threads=1", "memory_budget=300MiB"}))
      << "these do not decide the result";
  EXPECT_EQ(fs::last_write_time(output() / "hierarchy.json"), time);
  EXPECT_EQ(contents(output()), before);
  EXPECT_EQ(names(), (std::set<std::string>{".a.hier.meshhier-input", "a.hier", "a.ply"}));
  EXPECT_EQ(run({"clean", work()}).out.find("meshhier-input"), std::string::npos);
}

TEST_F(Update, TheNoteChangesNoByteOfTheHierarchy) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_FALSE(is_up_to_date(mesh));
  const auto updated = contents(output());
  ASSERT_EQ(
      run({"build", mesh, "--force", "--set", "preview=false", "storage.normals=smooth"}).code, 0);
  EXPECT_EQ(contents(output()), updated);
  EXPECT_TRUE(is_up_to_date(mesh)) << "the note is as true as before";
}

TEST_F(Update, AConfigOfAnotherResultIsBuilt) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_FALSE(is_up_to_date(mesh));
  EXPECT_FALSE(is_up_to_date(mesh, {"partition.vertices=500"}));
  EXPECT_TRUE(is_up_to_date(mesh, {"partition.vertices=500"}));
  EXPECT_FALSE(is_up_to_date(mesh, {"partition.vertices=500", "licence=mine"}));
  EXPECT_FALSE(is_up_to_date(mesh, {"texture.use=false"}))
      << "of a mesh without pictures it decides nothing, but nobody asks the mesh";
}

TEST_F(Update, ATouchedFileIsReadAndAChangedOneBuilt) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_FALSE(is_up_to_date(mesh));
  set_time(mesh, fs::last_write_time(mesh) + std::chrono::hours(1));
  const std::string before = text_of(note());
  EXPECT_TRUE(is_up_to_date(mesh));
  EXPECT_NE(text_of(note()), before) << "it is not read again";
  // Another content of the same size and time.
  const auto time = fs::last_write_time(mesh);
  std::string text = text_of(mesh);
  text.replace(text.find("end_header\n0 0 0"), 16, "end_header\n0 0 9");
  write_text(mesh, text);
  set_time(mesh, time);
  EXPECT_FALSE(is_up_to_date(mesh));
  EXPECT_TRUE(is_up_to_date(mesh));
}

TEST_F(Update, FilesThatTheMeshNamesCount) {
  const fs::path mesh = write_obj();
  EXPECT_FALSE(is_up_to_date(mesh));
  EXPECT_TRUE(is_up_to_date(mesh));
  write_text(work() / "a.mtl", "newmtl m\nKd 1 0 0\n");
  EXPECT_FALSE(is_up_to_date(mesh)) << "a library that was missing has appeared";
  EXPECT_TRUE(is_up_to_date(mesh));
  write_text(work() / "a.mtl", "newmtl m\nKd 0 1 0\n");
  EXPECT_FALSE(is_up_to_date(mesh));
  write_text(work() / "a.mtl", "newmtl m\nmap_Kd wood.png\n");
  EXPECT_FALSE(is_up_to_date(mesh));
  EXPECT_TRUE(is_up_to_date(mesh)) << "the picture is still missing";
  write_picture(work() / "wood.png");
  EXPECT_FALSE(is_up_to_date(mesh)) << "the picture has appeared";
  EXPECT_TRUE(is_up_to_date(mesh));
  fs::remove(work() / "wood.png");
  EXPECT_FALSE(is_up_to_date(mesh)) << "it is gone";
}

TEST_F(Update, TheTableOfObjectsCounts) {
  const fs::path mesh = write_obj();
  const Path table = work() / "t.csv";
  write_text(table, "id,colour\n0,red\n");
  const Arguments with{"objects.from=material", "--object-table", table};
  EXPECT_FALSE(is_up_to_date(mesh, with));
  EXPECT_TRUE(is_up_to_date(mesh, with));
  write_text(table, "id,colour\n0,blue\n");
  EXPECT_FALSE(is_up_to_date(mesh, with));
  EXPECT_FALSE(is_up_to_date(mesh, {"objects.from=material"})) << "it is left out";
}

TEST_F(Update, AListOfMeshesIsComparedInItsOrder) {
  const Path a = write_mesh("a.ply"), b = write_mesh("b.ply", 2499, 0.5);
  const auto is_done = [&](const std::string& first, const std::string& second) {
    return is_up_to_date(first, {"-o", output().string(), second});
  };
  EXPECT_FALSE(is_done(a, b));
  EXPECT_TRUE(is_done(a, b));
  EXPECT_FALSE(is_done(b, a));
  EXPECT_FALSE(is_up_to_date(b, {"-o", output().string()}));
}

TEST_F(Update, AHierarchyThatWasBuiltByHandIsKnownByReadingItsMesh) {
  const Path mesh = write_mesh("a.ply");
  ASSERT_EQ(run({"build", mesh, "--set", "preview=false", "storage.normals=smooth"}).code, 0);
  EXPECT_TRUE(is_up_to_date(mesh));
  EXPECT_TRUE(fs::exists(note()));
  const fs::path other = write_obj();
  ASSERT_EQ(run({"build", other, "-o", work() / "b.hier"}).code, 0);
  EXPECT_FALSE(is_up_to_date(other, {"-o", (work() / "b.hier").string()}))
      << "nobody knows which library it lacked";
}

TEST_F(Update, AMeshWhoseNameIsNoUtf8IsKnownByReadingIt) {
  const Path mesh = write_mesh("a\xff.ply");
  ASSERT_EQ(
      run({"build", mesh, "-o", output(), "--set", "preview=false", "storage.normals=smooth"}).code,
      0);
  EXPECT_TRUE(is_up_to_date(mesh, {"-o", output()}));
  EXPECT_TRUE(is_up_to_date(mesh, {"-o", output()}));
  const Path other = write_mesh("a\xfe.ply");
  EXPECT_FALSE(is_up_to_date(other, {"-o", output()})) << "it has another name";
}

TEST_F(Update, ADryRunTellsWhatIsDue) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_THAT(run(update(mesh, {"--dry-run"})).out, HasSubstr("hierarchy   1 partition"));
  EXPECT_FALSE(fs::exists(output()));
  EXPECT_FALSE(is_up_to_date(mesh));
  EXPECT_EQ(run(update(mesh, {"--dry-run"})).out, output().string() + " is up to date\n");
  EXPECT_THAT(run(update(mesh, {"--dry-run", "--json"})).out, HasSubstr("\"up_to_date\": true"));
}

TEST_F(Update, AViewThatWasGivenLaterStays) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_FALSE(is_up_to_date(mesh));
  ASSERT_EQ(run({"view", output(), "--set", "view.light=raking"}).code, 0);
  EXPECT_TRUE(is_up_to_date(mesh));
}

TEST_F(Update, WhatIsNoHierarchyIsNeverReplaced) {
  const Path mesh = write_mesh("a.ply");
  fs::create_directory(output());
  write_text(output() / "diary.txt", "precious");
  const Outcome foreign = run(update(mesh));
  EXPECT_EQ(foreign.code, kExists);
  EXPECT_THAT(foreign.messages,
              AllOf(HasSubstr("is never replaced: move it away"), Not(HasSubstr("--force"))));
  EXPECT_EQ(text_of(output() / "diary.txt"), "precious");
  fs::remove_all(output());
  write_text(output(), "a file");
  EXPECT_EQ(run(update(mesh)).code, kExists);
  EXPECT_EQ(text_of(output()), "a file");
}

TEST_F(Update, ADamagedHierarchyIsBuiltAnew) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_FALSE(is_up_to_date(mesh));
  std::string manifest = text_of(output() / "hierarchy.json");
  manifest[manifest.size() / 2] ^= 1;
  write_text(output() / "hierarchy.json", manifest);
  EXPECT_FALSE(is_up_to_date(mesh));
  write_text(note(), "no note\n");
  EXPECT_EQ(run(update(mesh, {"partition.vertices=500"})).code, kExists)
      << "a file in the note's place that is no note stays";
  EXPECT_EQ(text_of(note()), "no note\n");
}

TEST_F(Update, NothingIsWrittenThroughALinkInThePlaceOfTheNote) {
  const Path mesh = write_mesh("a.ply"), other = work() / "other";
  write_text(other, "mine\n");
  fs::create_symlink(other, note());
  EXPECT_EQ(run(update(mesh)).code, kExists) << "before the build";
  EXPECT_FALSE(fs::exists(output()));
  ASSERT_EQ(run({"build", mesh, "--set", "preview=false", "storage.normals=smooth"}).code, 0);
  EXPECT_TRUE(is_up_to_date(mesh)) << "by reading the mesh";
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(note()))) << "in the place of the link";
  EXPECT_EQ(text_of(other), "mine\n");
}

TEST_F(Update, AFifoInThePlaceOfTheNoteIsNotWaitedFor) {
  const Path mesh = write_mesh("a.ply");
  ASSERT_EQ(::mkfifo(note().c_str(), 0600), 0);
  EXPECT_EQ(run(update(mesh)).code, kExists);
  ASSERT_EQ(run({"build", mesh, "--set", "preview=false", "storage.normals=smooth"}).code, 0);
  EXPECT_TRUE(is_up_to_date(mesh)) << "by reading the mesh";
  EXPECT_TRUE(fs::is_regular_file(note()));
}

TEST_F(Update, AnAccountIsReplacedAndNoOtherFile) {
  const Path mesh = write_mesh("a.ply"), account = work() / "stats.json";
  EXPECT_FALSE(is_up_to_date(mesh, {"--stats", account}));
  EXPECT_FALSE(is_up_to_date(mesh, {"partition.vertices=500", "--stats", account}));
  write_text(account, "my notes\n");
  EXPECT_EQ(run(update(mesh, {"--stats", account})).code, kExists);
  EXPECT_EQ(text_of(account), "my notes\n");
}

TEST_F(Update, AnArchiveIsUpdatedToo) {
  const Path mesh = write_mesh("a.ply");
  const Arguments packed{"-o", (work() / "a.3tz").string()};
  EXPECT_FALSE(is_up_to_date(mesh, packed));
  EXPECT_TRUE(is_up_to_date(mesh, packed));
  EXPECT_FALSE(is_up_to_date(mesh, {"partition.vertices=500", "-o", packed[1]}));
}

/// Two updates at once, each with a folder for what it prints.
class UpdatesAtOnce : public Update {
 protected:
  fs::path lock() const { return work() / ".a.hier.meshhier-work" / "lock"; }
  fs::path folder(std::size_t i) const { return work() / ("of " + std::to_string(i)); }

  /// Lets both find that a build is due before one can begin. They wait for each other for some
  /// seconds: where a build takes longer, all is done again.
  std::array<Outcome, 2> run_both(const fs::path& mesh) const {
    std::array<Outcome, 2> outcomes;
    constexpr int kMostTries = 20;
    for (int tries = 0; tries < kMostTries; ++tries) {
      for (const fs::path& made : {output(), note(), folder(0), folder(1)})
        fs::remove_all(made);
      run_both_once(mesh, outcomes);
      if (std::ranges::none_of(outcomes, [](const Outcome& one) { return one.code == kLocked; }))
        break;
    }
    return outcomes;
  }

 private:
  void run_both_once(const fs::path& mesh, std::array<Outcome, 2>& outcomes) const {
    fs::create_directory(lock().parent_path());
    auto held = storage::make_posix_file_system()->try_lock(lock());
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      fs::create_directory(folder(i));
      threads.emplace_back([&, i] {
        outcomes.at(i) = run_program(update(mesh, {"--progress", "json"}), folder(i));
      });
    }
    for (std::size_t i = 0; i < outcomes.size(); ++i)
      tests::wait_until([&] { return is_due(i); });
    held.reset();
    for (std::thread& thread : threads)
      thread.join();
  }
  bool is_due(std::size_t i) const {
    const fs::path messages = folder(i) / "messages";
    return fs::exists(messages) && text_of(messages).find("outdated") != std::string::npos;
  }
};

TEST_F(UpdatesAtOnce, OneBuildsAndTheOtherFindsItDone) {
  for (const bool is_ply : {true, false}) {
    const fs::path mesh = is_ply ? work() / "a.ply" : write_obj();
    if (is_ply)
      write_text(mesh,
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    std::size_t builds = 0;
    for (const Outcome& outcome : run_both(mesh)) {
      EXPECT_EQ(outcome.code, 0) << outcome.messages;
      const bool has_built = outcome.messages.find("stage_end") != std::string::npos;
      const bool says_so = outcome.messages.find("up_to_date") != std::string::npos;
      EXPECT_NE(has_built, says_so) << outcome.messages;
      builds += has_built ? 1 : 0;
    }
    EXPECT_EQ(builds, 1U) << mesh;
    EXPECT_TRUE(is_up_to_date(mesh));
    EXPECT_FALSE(fs::exists(lock().parent_path()));
  }
}

TEST_F(Update, ALinkThatWasNamedForTheNoteIsFollowed) {
  const Path mesh = write_mesh("a.ply"), link = work() / "link";
  fs::create_symlink("elsewhere", link);
  const Arguments named{"--input-note", link.string()};
  EXPECT_FALSE(is_up_to_date(mesh, named));
  set_time(mesh, fs::last_write_time(mesh) + std::chrono::hours(1));
  EXPECT_TRUE(is_up_to_date(mesh, named));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_FALSE(
      is_up_to_date(mesh, {"--input-note", link.string(), "--set", "partition.vertices=500"}));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(fs::is_regular_file(work() / "elsewhere"));
}

TEST_F(Update, ANoteThatCannotBeReadAgainIsRefused) {
  const Path mesh = write_mesh("a.ply"), fifo = work() / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  for (const std::string& name : {std::string("-"), fifo.string()}) {
    const Outcome outcome = run(update(mesh, {"--input-note", name}));
    EXPECT_EQ(outcome.code, kUsage) << name;
    EXPECT_THAT(outcome.messages, HasSubstr("--update reads it again"));
  }
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(Update, ProgramsAreTold) {
  const Path mesh = write_mesh("a.ply");
  EXPECT_THAT(run(update(mesh, {"--progress", "json"})).messages,
              HasSubstr(R"({"event":"outdated","message":")"));
  const Outcome second = run(update(mesh, {"--progress", "json"}));
  EXPECT_THAT(second.messages,
              AllOf(HasSubstr(R"({"event":"up_to_date","message":")"), Not(HasSubstr("stage"))));
  EXPECT_EQ(second.out, "");
}

class Each : public CommandLine {
 protected:
  Arguments each(const Arguments& inputs, const Arguments& more = {}) const {
    Arguments words{"build", "--each"};
    words.insert(words.end(), inputs.begin(), inputs.end());
    words.insert(words.end(), {"-o", models().string()});
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--set", "preview=false", "storage.normals=smooth"});
    return words;
  }
  fs::path models() const { return work() / "models"; }
  std::set<std::string> made() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(models()))
      found.insert(entry.path().filename());
    return found;
  }
};

TEST_F(Each, MakesAHierarchyOfEachFileAndTellsOfAll) {
  const Path a = write_mesh("a.ply"), b = write_mesh("b.ply", 2499, 0.5);
  const Outcome outcome = run(each({a, b, a, fs::relative(a.string()).string()}, {"--jobs", "2"}));
  EXPECT_EQ(outcome.code, 0) << outcome.messages << outcome.out;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("done        " + (models() / "a.hier").string() + ", in "),
                    HasSubstr("2 models: 2 done\n")));
  EXPECT_EQ(made(), (std::set<std::string>{"a.hier", "b.hier"}));
  ASSERT_EQ(run({"build", a, "-o", work() / "alone.hier", "--set", "preview=false",
                 "storage.normals=smooth"})
                .code,
            0);
  EXPECT_EQ(contents(models() / "a.hier"), contents(work() / "alone.hier"));
  EXPECT_EQ(run(each({a, b})).code, kExists) << "both are there";
}

TEST_F(Each, ADryRunTellsOfAllAndOfTheirDiskAndBuildsNothing) {
  const Path a = write_mesh("a.ply"), b = write_mesh("b.ply", 2499, 0.5);
  ASSERT_EQ(run(each({a}, {"--update"})).code, 0);
  const auto before = made();
  const Outcome plan = run(each({a, b}, {"--update", "--dry-run"}));
  EXPECT_EQ(plan.code, 0) << plan.messages << plan.out;
  EXPECT_THAT(plan.out,
              AllOf(HasSubstr("up to date  " + (models() / "a.hier").string() + "\n"),
                    HasSubstr("to build    " + (models() / "b.hier").string() + ", about "),
                    HasSubstr("2 models: 1 up to date, 1 to build\ndisk        "),
                    HasSubstr(" free in " + models().string() + "\ntime        about ")));
  EXPECT_EQ(made(), before);
  const Outcome refused = run(each({a, b}, {"--dry-run", "--json", "--jobs", "2"}));
  EXPECT_EQ(refused.code, kExists) << "as the builds";
  const auto told = nlohmann::json::parse(refused.out);
  EXPECT_EQ(told.at("models").at(0).at("code"), kExists);
  EXPECT_EQ(told.at("models").at(1).at("result"), "to build");
  EXPECT_GT(told.at("models").at(1).at("predicted_output_bytes"), 10'000);
  EXPECT_EQ(told.at("disks").size(), 1U);
  EXPECT_EQ(told.at("disks").at(0).at("predicted_room_bytes"),
            told.at("models").at(1).at("predicted_room_bytes"));
}

TEST_F(Each, APatternThatMatchesWhatWasMadeMayBeRepeated) {
  const Path a = write_mesh("a.ply");
  const Arguments all{a, work() / "a.hier", work() / "b.3tz", models()};
  ASSERT_EQ(run({"build", a, "-o", work() / "a.hier"}).code, 0);
  ASSERT_EQ(run({"build", a, "-o", work() / "b.3tz"}).code, 0);
  fs::create_directory(models());
  const Outcome outcome = run(each(all, {"--update"}));
  EXPECT_EQ(outcome.code, 0) << outcome.messages << outcome.out;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("left out    " + (work() / "a.hier").string() + "\n"),
                                 HasSubstr("4 models: 3 left out, 1 done\n")));
  EXPECT_EQ(made(), (std::set<std::string>{".a.hier.meshhier-input", "a.hier"}));
}

TEST_F(Each, MeshesMayLieInTheFolderOfTheOutputs) {
  fs::create_directory(models());
  const Path a = write_mesh("models/a.ply");
  const Outcome outcome = run(each({a}, {"--update"}));
  EXPECT_EQ(outcome.code, 0) << outcome.messages << outcome.out;
  EXPECT_EQ(made(), (std::set<std::string>{".a.hier.meshhier-input", "a.hier", "a.ply"}));
}

TEST_F(Each, AFailureStopsNoOther) {
  const Path a = write_mesh("a.ply"), broken = write_mesh("broken.ply", 9999);
  const Path b = write_mesh("b.ply", 2499, 0.5);
  write_text(work() / "text.txt", "this is no mesh\n");
  const Outcome outcome =
      run(each({broken, a, work() / "text.txt", b, work() / "*.stl"}, {"--update", "--jobs", "2"}));
  EXPECT_EQ(outcome.code, 10) << "the reasons differ";
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("failed      " + (models() / "broken.hier").string() + " (3): "),
                    HasSubstr("text.txt (2): "),
                    HasSubstr("*.stl (4): " + (work() / "*.stl").string() + ": no file has a name"),
                    HasSubstr("5 models: 2 done, 3 failed\n")));
  EXPECT_LT(outcome.out.find("b.hier"), outcome.out.find("broken.hier")) << "failures come last";
  const Outcome again = run(each({broken, a, b}, {"--update"}));
  EXPECT_EQ(again.code, kInput) << "the reason of all that failed";
  EXPECT_THAT(again.out, HasSubstr("3 models: 2 up to date, 1 failed\n"));
}

TEST_F(Each, TwoFilesOfOneOutputAreRefusedBeforeAnythingIsBuilt) {
  fs::create_directory(work() / "one");
  fs::create_directory(work() / "two");
  const Path a = write_mesh("one/a.ply"), b = write_mesh("two/a.ply", 2499, 0.5);
  const Outcome outcome = run(each({a, b}));
  EXPECT_EQ(outcome.code, kUsage);
  EXPECT_THAT(outcome.messages, AllOf(HasSubstr("one/a.ply and "), HasSubstr("two/a.ply"),
                                      HasSubstr("models/a.hier")));
  EXPECT_FALSE(fs::exists(models()));
  const Outcome beside = run({"build", "--each", a, b, "--set", "preview=false"});
  EXPECT_EQ(beside.code, 0) << beside.messages << beside.out;
  EXPECT_TRUE(fs::exists(work() / "one" / "a.hier"));
  EXPECT_TRUE(fs::exists(work() / "two" / "a.hier"));
}

TEST_F(Each, TakesConfigsAndFoldersAndMakesArchives) {
  write_mesh("a.ply");
  const std::string config = write_config();
  fs::create_directory(work() / "town");
  write_text(work() / "town" / "tileset.json",
             R"({"asset": {"version": "1.1"}, "geometricError": 1, "root": {
 "boundingVolume": {"sphere": [0, 0, 0, 1]}, "geometricError": 0, "content": {"uri": "t.glb"}}})");
  const Outcome outcome = run(each({config, work() / "town"}, {"--update"}));
  EXPECT_EQ(outcome.code, kInput) << "the tile is not there";
  EXPECT_THAT(outcome.out, HasSubstr((models() / "town.hier").string() + " (3): "));
  EXPECT_EQ(made(), (std::set<std::string>{".a.hier.meshhier-input", "a.hier"}));
  EXPECT_EQ(run({"build", "--each", work() / "a.ply", "-o", models(), "--set",
                 "storage.container=3tz", "preview=false"})
                .code,
            0);
  EXPECT_TRUE(fs::is_regular_file(models() / "a.3tz"));
}

TEST_F(Each, WordsThatDoNotGoTogetherAreRefused) {
  const Path a = write_mesh("a.ply");
  EXPECT_EQ(run({"build", "--each"}).code, kUsage);
  EXPECT_THAT(run({"build", "--each", a, ""}).messages,
              HasSubstr("FILE: expected a name, found nothing"));
  EXPECT_EQ(run({"build", "--each", a, "--stats", work() / "s.json"}).code, kUsage);
  EXPECT_EQ(run({"build", a, "--jobs", "2"}).code, kUsage);
  EXPECT_EQ(run(each({a}, {"--set", "output=x.hier"})).code, kUsage);
  EXPECT_EQ(run(each({a}, {"--set", "partition.vertex=5"})).code, kUsage) << "no such key";
  EXPECT_EQ(run({"build", "--each", a, "-o", a}).code, kUsage) << "a file is no folder";
  for (const char* name : {"all.3tz", "all.hier", "all.glb"}) {
    const Outcome outcome = run({"build", "--each", a, "-o", work() / name});
    EXPECT_EQ(outcome.code, kUsage) << name;
    EXPECT_THAT(outcome.messages, HasSubstr("names the folder of all outputs"));
    EXPECT_FALSE(fs::exists(work() / name));
  }
  EXPECT_EQ(run({"build", a, "--update", "--force"}).code, kUsage);
}

TEST_F(Each, ProgramsAreToldOfEachModel) {
  const Path a = write_mesh("a.ply"), broken = write_mesh("broken.ply", 9999);
  const Outcome outcome = run(each({a, broken}, {"--progress", "json"}));
  std::istringstream lines(outcome.messages);
  std::vector<std::string> ends;
  std::set<std::string> models_told;
  for (std::string line; std::getline(lines, line);) {
    const auto event = nlohmann::json::parse(line);
    models_told.insert(event.at("model"));
    if (event.at("event") == "model_end")
      ends.push_back(event.at("result").get<std::string>() + event.at("code").dump());
  }
  EXPECT_THAT(ends, testing::UnorderedElementsAre("done0", "failed3"));
  EXPECT_EQ(models_told, (std::set<std::string>{(models() / "a.hier").string(),
                                                (models() / "broken.hier").string()}));
}

TEST_F(Each, ProgramsAreToldTheBytesOfNamesThatAreNoUtf8) {
  const Path a = write_mesh("a\xff.ply");
  const auto told = [&](const Arguments& more, const char* key) {
    std::istringstream lines(run(each({a}, more)).messages);
    std::set<std::string> values;
    for (std::string line; std::getline(lines, line);) {
      const auto event = nlohmann::json::parse(line);
      if (event.contains(key))
        values.insert(event.at(key));
    }
    return values;
  };
  EXPECT_THAT(told({"--progress", "json"}, "input_escaped"),
              ElementsAre(testing::EndsWith("a%FF.ply")));
  EXPECT_THAT(told({"--progress", "json", "--update"}, "output_escaped"), testing::SizeIs(1));
}

/// The program at work in the background, whose output nobody reads.
pid_t start(const Arguments& arguments) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_RDWR, 0600);
  const pid_t process = spawn(arguments, actions);
  posix_spawn_file_actions_destroy(&actions);
  return process;
}

TEST_F(Each, WhatWasStoppedOrKilledGoesOn) {
  const Path a = write_mesh("a.ply"), b = write_mesh("b.ply", 2499, 0.5);
  const auto files = storage::make_posix_file_system();
  for (const int signal : {SIGINT, SIGKILL}) {
    const pid_t process = start(each({a, b}, {"--update", "--jobs", "2"}));
    tests::wait_until([&] { return fs::exists(models()); });
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    kill(process, signal);
    const int code = wait_for(process);
    if (code != 0) {
      EXPECT_EQ(code, signal == SIGKILL ? 1000 + SIGKILL : kInterrupted);
    }
    // Its builds die with it, but may do so after it.
    for (const char* lock : {".a.hier.meshhier-work/lock", ".b.hier.meshhier-work/lock"})
      tests::wait_until([&] { return !files->is_locked(models() / lock); });
  }
  const Outcome rest = run(each({a, b}, {"--update", "--jobs", "2"}));
  EXPECT_EQ(rest.code, 0) << rest.out << rest.messages;
  EXPECT_EQ(run({"verify", models() / "a.hier", "--input", a}).code, 0);
  EXPECT_EQ(run({"verify", models() / "b.hier", "--input", b}).code, 0);
  EXPECT_THAT(run({"clean", models()}).out, Not(HasSubstr("stopped")));
}

class Once : public CommandLine {
 protected:
  Once() {
    fs::create_directory(inbox());
    fs::create_directory(models());
    write_text(
        work() / "quick.json",
        R"({"preview": false, "storage": {"normals": "smooth"}, "partition": {"vertices": 500}})");
  }
  Arguments once(const std::string& settle = "0") const {
    return {"serve", models(),   "--watch",
            inbox(), "--once",   "--settle",
            settle,  "--config", work() / "quick.json"};
  }
  Path inbox() const { return work() / "inbox"; }
  Path models() const { return work() / "models"; }
};

TEST_F(Once, WhatIsInTheInboxIsBuiltAndNoPortIsOpened) {
  write_mesh("inbox/a.ply");
  const Outcome first = run(once());
  EXPECT_EQ(first.code, 0) << first.messages;
  EXPECT_EQ(first.out, "1 built, 0 up to date, 0 failed, 0 left for the next time\n");
  EXPECT_EQ(run({"verify", models() / "a.hier", "--input", inbox() / "a.ply"}).code, 0);
  const Outcome second = run(once());
  EXPECT_EQ(second.code, 0) << second.messages;
  EXPECT_EQ(second.out, "0 built, 1 up to date, 0 failed, 0 left for the next time\n");
  write_mesh("inbox/broken.ply", 9999);
  const Outcome broken = run(once());
  EXPECT_EQ(broken.code, kInput);
  EXPECT_THAT(broken.messages, HasSubstr("broken.ply: "));
  EXPECT_EQ(broken.out, "0 built, 1 up to date, 1 failed, 0 left for the next time\n");
  EXPECT_EQ(run({"serve", models(), "--once"}).code, kUsage) << "of which inbox?";
  for (const Arguments& page : {Arguments{"--port", "0"}, Arguments{"--frame", "*"}}) {
    Arguments with_page = once();
    with_page.insert(with_page.end(), page.begin(), page.end());
    EXPECT_EQ(run(with_page).code, kUsage) << page.front();
  }
}

TEST_F(Once, QuietMeansThatOnlyFailuresAreTold) {
  write_mesh("inbox/a.ply");
  Arguments quiet = once();
  quiet.push_back("--quiet");
  const Outcome fine = run(quiet);
  EXPECT_EQ(fine.code, 0);
  EXPECT_EQ(fine.out + fine.messages, "");
  write_mesh("inbox/broken.ply", 9999);
  const Outcome broken = run(quiet);
  EXPECT_EQ(broken.code, kInput);
  EXPECT_THAT(broken.messages, AllOf(HasSubstr("error broken.ply: "), Not(HasSubstr(" info "))));
  EXPECT_EQ(broken.out, "0 built, 1 up to date, 1 failed, 0 left for the next time\n");
}

TEST_F(Once, ASecondOneIsRefusedUntilTheFirstHasEnded) {
  write_mesh("inbox/a.ply");
  const pid_t first = start(once("60"));
  const auto lock = models() / ".serve-once.meshhier-lock";
  tests::wait_until([&] { return fs::exists(lock); });
  const Outcome second = run(once());
  EXPECT_EQ(second.code, kLocked);
  EXPECT_THAT(second.messages, HasSubstr("another \"meshhier serve --once\""));
  kill(first, SIGTERM);
  EXPECT_EQ(wait_for(first), kInterrupted);
  EXPECT_EQ(run(once()).code, 0);
  EXPECT_FALSE(fs::exists(lock));
}

}  // namespace
}  // namespace meshhier::app
