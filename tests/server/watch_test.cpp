// A watched folder with the real program.
#include "server/watch.h"

#include "pipeline/build.h"
#include "storage/io/file_checksum.h"
#include "tests/server/refusing_folder.h"
#include "tests/server/served_folder.h"
#include "tests/support/make_later.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_texture.h"
#include "tests/support/wait_until.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
using tests::text_of;
using tests::wait_until;

constexpr std::chrono::milliseconds kSettle{100};

class WatchTest : public testing::Test {
 protected:
  WatchTest() {
    fs::create_directories(inbox());
    fs::create_directories(models());
  }

  fs::path inbox() const { return directory_.path() / "inbox"; }
  fs::path models() const { return directory_.path() / "models"; }

  void start() {
    watch_.reset();
    WatchOptions options;
    options.inbox = inbox();
    options.folder = models();
    options.config = config_;
    options.program = program_.string();
    options.folders = Inbox::Folders::taken;
    options.settle = kSettle;
    options.look_every = std::chrono::milliseconds(50);
    options.try_again = std::chrono::milliseconds(100);
    folder_ = storage::open_folder(models());
    hierarchies_ = std::make_unique<Hierarchies>(
        std::make_shared<tests::RefusingFolder>(folder_, refused_), [](const std::string&) {});
    watch_ = std::make_unique<Watch>(options, *files_, *hierarchies_,
                                     [this](LogLevel, const std::string& message) {
                                       const std::lock_guard lock(mutex_);
                                       told_.push_back(message);
                                     });
    watch_->start();
  }

  /// Puts a file into the inbox, whole at once: one that is written there may be taken too early.
  void put(const std::string& name, const std::string& text) const {
    tests::write_text(directory_.path() / "made", text);
    fs::rename(directory_.path() / "made", inbox() / name);
  }
  void drop(const std::string& name, std::size_t triangles = 600) {
    tests::write_ply(tests::sphere(triangles), directory_.path() / "made.ply");
    fs::rename(directory_.path() / "made.ply", inbox() / name);
  }
  /// Another mesh than drop()'s, in as many bytes.
  void drop_other_shape(const std::string& name) {
    auto mesh = tests::sphere(600);
    mesh.positions[0].x += 1;
    tests::write_ply(mesh, directory_.path() / "made.ply");
    fs::rename(directory_.path() / "made.ply", inbox() / name);
  }
  /// A square picture of so many texels a side.
  void put_picture(const std::string& name, std::uint32_t side) {
    const std::vector<std::byte> png = tests::sample_png(side, side, false);
    fs::create_directories((inbox() / name).parent_path());
    put(name, {reinterpret_cast<const char*>(png.data()), png.size()});
  }
  void drop_library(const std::string& picture) {
    put("a.mtl", "newmtl m\nmap_Kd " + picture + '\n');
  }
  /// A triangle that shows textures/wall.png.
  void drop_textured() {
    put_picture("textures/wall.png", 16);
    drop_library("textures/wall.png");
    drop_obj();
  }
  /// The same, all in the folder "house".
  void drop_textured_folder() {
    drop_textured();
    fs::create_directory(directory_.path() / "house");
    for (const char* name : {"a.obj", "a.mtl", "textures"})
      fs::rename(inbox() / name, directory_.path() / "house" / name);
    fs::rename(directory_.path() / "house", inbox() / "house");
  }
  void drop_obj() {
    put("a.obj",
        "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
        "f 1/1 2/2 3/3\n");
  }
  void drop_gltf() {
    const std::array<float, 9> corners{0, 0, 0, 1, 0, 0, 0, 1, 0};
    put("t.bin", {reinterpret_cast<const char*>(corners.data()), sizeof corners});
    put("t.gltf",
        R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [0, 0, 0], "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"uri": "t.bin", "byteLength": 36}]})");
  }
  /// Returns the texels of the pictures that it was made of.
  std::uint64_t texels(const std::string& name = "a.hier") const {
    std::ifstream file(models() / name / "hierarchy.json");  // not there while it is replaced
    const auto manifest = nlohmann::json::parse(file, nullptr, false);
    const nlohmann::json::json_pointer texels("/source/textures/texels");
    return manifest.contains(texels) ? manifest[texels].get<std::uint64_t>() : 0;
  }
  std::ptrdiff_t builds_of(const std::string& name) {
    const std::vector<std::string> all = told();
    return std::count_if(all.begin(), all.end(), [&](const std::string& text) {
      return text.starts_with(name + ": building");
    });
  }
  fs::path other() const { return directory_.path() / "other.ply"; }

  /// The program is a script from now on.
  void run_instead(const std::string& lines) {
    program_ = directory_.path() / "build.sh";
    tests::write_text(program_, "#!/bin/sh\n" + lines);
    fs::permissions(program_, fs::perms::owner_all);
  }
  void run_before_the_build(const std::string& line) {
    run_instead(line + "\nexec '" MESHHIER_BINARY "' \"$@\"\n");
  }
  /// The manifest is the last file that is written.
  void run_before_the_end(const std::string& line) {
    run_instead(MESHHIER_BINARY " \"$@\"\ncode=$?\n" + line + "\ntouch " +
                (models() / "*/hierarchy.json").string() + "\nexit $code\n");
  }
  bool is_made_of(const std::string& name, const fs::path& mesh) {
    const auto file = files_->open(mesh);
    const auto model = hierarchies_->look(name);
    return model &&
           model->source_checksum == storage::FileChecksum(file->size()).complete(*file, [] {});
  }

  bool is_there(const std::string& name) const {
    return fs::exists(models() / name / "hierarchy.json");
  }

  /// The job's value, "" if there is no such job.
  std::string job(const std::string& name, const char* key) const {
    for (const auto& one : watch_->jobs()) {
      if (one["name"] == name)
        return one.value(key, "");
    }
    return "";
  }
  bool is_idle() const { return watch_->jobs().empty(); }

  /// Stops the build of a.ply when its journal has begun, and checks that it was not done by then:
  /// if it was, with a larger mesh.
  void stop_in_the_middle() {
    for (std::size_t triangles = 100'000; !fs::exists(models() / ".a.hier.meshhier-work");
         triangles *= 2) {
      fs::remove_all(models() / "a.hier");
      start();
      drop("a.ply", triangles);
      wait_until([&] { return job("a.ply", "stage") == "leaves" || is_there("a.hier"); });
      watch_->stop();
    }
    ASSERT_FALSE(is_there("a.hier"));
  }

  std::vector<std::string> told() {
    const std::lock_guard lock(mutex_);
    return told_;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  fs::path config_;
  fs::path program_ = MESHHIER_BINARY;
  std::set<std::string> refused_;  ///< among the models
  std::shared_ptr<const storage::Folder> folder_;
  std::unique_ptr<Hierarchies> hierarchies_;
  std::mutex mutex_;
  std::vector<std::string> told_;
  std::unique_ptr<Watch> watch_;
};

/// Name and content of each file below.
std::map<std::string, std::string> contents(const fs::path& directory) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(directory)] = text_of(entry.path());
  }
  return files;
}

TEST_F(WatchTest, AHierarchyThatMayNotBeReadHoldsUpNoOther) {
  refused_ = {"a.hier/hierarchy.json"};
  drop("a.ply");
  drop("b.ply");
  start();
  wait_until([&] { return is_there("b.hier"); });
  wait_until([&] { return job("b.ply", "state").empty(); });
  EXPECT_EQ(job("a.ply", "state"), "waiting");
  EXPECT_THAT(job("a.ply", "message"), HasSubstr("cannot open a.hier/hierarchy.json"));
  const std::vector<std::string> all = told();
  EXPECT_EQ(std::count_if(all.begin(), all.end(),
                          [](const std::string& text) { return text.starts_with("a.ply: "); }),
            1);
  EXPECT_FALSE(fs::exists(models() / "a.hier"));
}

TEST_F(WatchTest, WhatIsDroppedIsBuiltBrokenOnesAreTold) {
  start();
  put("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  put("notes.txt", "no mesh");
  put(".hidden.ply", "ply");
  put("unfinished.ply.part", "ply");
  drop("a.ply");
  drop("z.ply");
  wait_until([&] { return is_there("a.hier") && is_there("z.hier"); });
  wait_until([&] { return job("broken.ply", "state") == "failed"; });
  wait_until([&] { return watch_->jobs().size() == 1; });
  EXPECT_THAT(job("broken.ply", "message"), StartsWith("broken.ply: "))
      << "no path of this machine";
  EXPECT_FALSE(fs::exists(models() / "broken.hier"));
  EXPECT_THAT(told(), AllOf(Contains("a.ply: done"), Contains("z.ply: done"),
                            Contains(StartsWith("broken.ply: "))));
  EXPECT_EQ(text_of(inbox() / "notes.txt"), "no mesh");
}

TEST_F(WatchTest, WhatABuildSaysOfPlacesStaysHere) {
  config_ = directory_.path() / "all.json";
  tests::write_text(config_, "{}");
  run_instead("echo \"$@\" >&2\nexec sleep 600\n");
  start();
  drop("a.ply");
  wait_until(
      [&] { return !job("a.ply", "message").empty() && job("a.ply", "state") == "building"; });
  EXPECT_THAT(job("a.ply", "message"),
              AllOf(HasSubstr("input=a.ply output=a.hier"), HasSubstr("build all.json"),
                    Not(HasSubstr(directory_.path().string()))));
}

TEST_F(WatchTest, WarningsAreToldAndStayWithTheModel) {
  start();
  drop_obj();  // without its library
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  EXPECT_THAT(told(), Contains(AllOf(StartsWith("a.obj: "), HasSubstr("a.mtl"))));
  EXPECT_THAT(told(), Contains(StartsWith("a.obj: done, with ")));
  const auto warnings = [&] { return hierarchies_->list().at(0).warnings; };
  EXPECT_THAT(warnings(), Contains(HasSubstr("a.mtl")));
  EXPECT_THAT(warnings(), Not(Contains(HasSubstr(directory_.path().string()))));
  start();  // as after a restart
  EXPECT_THAT(warnings(), Contains(HasSubstr("a.mtl")));
  drop_library("textures/wall.png");
  put_picture("textures/wall.png", 8);
  wait_until([&] { return texels() == 8 * 8 && is_idle(); });
  EXPECT_THAT(warnings(), IsEmpty()) << "all is there now";
}

TEST_F(WatchTest, AccountsWarnToo) {
  start();
  put("p.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n");
  wait_until([&] { return is_there("p.hier") && is_idle(); });
  EXPECT_THAT(hierarchies_->list().at(0).warnings, Contains(HasSubstr("has no triangles")));
}

TEST_F(WatchTest, ANameThatNoHierarchyCanHaveIsTold) {
  start();
  const std::string name = std::string(245, 'n') + ".ply";
  drop(name);
  wait_until([&] { return job(name, "state") == "failed"; });
  EXPECT_THAT(job(name, "message"), HasSubstr("too long by"));
}

TEST_F(WatchTest, ABrokenFileIsTriedAgainWhenItIsAnother) {
  start();
  put("a.ply", "ply\n");
  wait_until([&] { return job("a.ply", "state") == "failed"; });
  drop("b.ply");  // a round goes by
  wait_until([&] { return is_there("b.hier"); });
  const std::vector<std::string> words = told();
  EXPECT_EQ(std::count(words.begin(), words.end(), "a.ply: building a.hier"), 1);
  drop("a.ply");
  wait_until([&] { return is_there("a.hier") && is_idle(); });
}

TEST_F(WatchTest, AGrowingFileWaits) {
  tests::write_ply(tests::sphere(600), directory_.path() / "whole.ply");
  const std::string bytes = text_of(directory_.path() / "whole.ply");
  start();
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t part = 1; part <= 10; ++part) {
    tests::write_text(inbox() / "a.ply", bytes.substr(0, bytes.size() * part / 10));
    const std::string state = job("a.ply", "state");
    if (std::chrono::steady_clock::now() - begin <
        kSettle) {  // else this test may have stood still
      EXPECT_NE(state, "failed");
    }
  }
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  EXPECT_EQ(job("a.ply", "state"), "");
}

TEST_F(WatchTest, TheResultIsThatOfABuildByHand) {
  config_ = directory_.path() / "config.json";
  tests::write_text(config_, R"({"input": "x", "output": "y", "partition": {"vertices": 100},
                                 "simplify": {"method": "half_edge"}, "storage": {"compression": "zlib", "normals": "smooth"}})");
  start();
  drop("a.ply");
  wait_until([&] { return is_there("a.hier"); });
  tests::build_small(directory_.path() / "a.ply", directory_.path() / "by_hand.hier",
                     storage::Compression::zlib);
  EXPECT_EQ(contents(models() / "a.hier"), contents(directory_.path() / "by_hand.hier"));
}

TEST_F(WatchTest, AFileThatChangesReplacesItsHierarchy) {
  start();
  drop("a.ply", 600);
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  drop("a.ply", 900);
  EXPECT_FALSE(is_made_of("a.hier", inbox() / "a.ply"));
  wait_until([&] { return is_made_of("a.hier", inbox() / "a.ply"); });
}

TEST_F(WatchTest, TwoOfOneStemHaveHierarchiesOfTheirOwn) {
  start();
  drop("a.ply");
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  put("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  wait_until([&] { return is_there("a.off.hier") && is_idle(); });
  EXPECT_EQ(hierarchies_->look("a.hier")->source, "a.ply");
  EXPECT_EQ(hierarchies_->look("a.off.hier")->source, "a.off");
}

TEST_F(WatchTest, AFolderIsBuiltAsOneModelAndNotAgain) {
  start();
  fs::create_directories(directory_.path() / "house");
  tests::write_text(directory_.path() / "house/a.obj",
                    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  tests::write_text(directory_.path() / "house/a.mtl", "newmtl a\n");
  fs::rename(directory_.path() / "house", inbox() / "house");
  wait_until([&] { return is_there("house.hier") && is_idle(); });
  EXPECT_EQ(hierarchies_->look("house.hier")->source, "a.obj");
  EXPECT_THAT(told(), ElementsAre("house/a.obj: building house.hier", "house/a.obj: done"));
  const auto manifest = folder_->open("house.hier/hierarchy.json")->version();
  start();
  drop("b.ply");
  wait_until([&] { return is_there("b.hier") && is_idle(); });
  EXPECT_EQ(folder_->open("house.hier/hierarchy.json")->version(), manifest);
}

TEST_F(WatchTest, AFolderWhosePictureChangesIsBuiltAgain) {
  drop_textured_folder();
  start();
  wait_until([&] { return is_there("house.hier") && is_idle(); });
  ASSERT_EQ(texels("house.hier"), 16U * 16U);
  put_picture("house/textures/wall.png", 32);
  wait_until([&] { return texels("house.hier") == 32 * 32 && is_idle(); });
  EXPECT_EQ(builds_of("house/a.obj"), 2);
  start();
  drop("b.ply");
  wait_until([&] { return is_there("b.hier") && is_idle(); });
  EXPECT_EQ(builds_of("house/a.obj"), 2) << "its files were noted";
}

TEST_F(WatchTest, ARestartBuildsNothingAgain) {
  start();
  drop("a.ply");
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  const auto manifest = folder_->open("a.hier/hierarchy.json")->version();
  told_.clear();
  start();
  drop("b.ply");
  wait_until([&] { return is_there("b.hier") && is_idle(); });
  EXPECT_EQ(folder_->open("a.hier/hierarchy.json")->version(), manifest);
  EXPECT_THAT(told(), Not(Contains(HasSubstr("a.ply"))));
}

TEST_F(WatchTest, AFileThatIsReplacedAtTheEndOfItsBuildIsBuiltAgain) {
  // The program itself replaces the file, by one of its size, before it says that it is done.
  tests::write_ply(tests::sphere(600), other());
  run_before_the_end("test -e " + other().string() + " && mv " + other().string() + " " +
                     (inbox() / "a.ply").string());
  start();
  drop_other_shape("a.ply");
  wait_until([&] { return is_there("a.hier") && !fs::exists(other()) && is_idle(); });
  EXPECT_TRUE(is_made_of("a.hier", inbox() / "a.ply"));
  EXPECT_THAT(told(), Contains("a.ply: it was changed while it was built; it is looked at again"));
}

TEST_F(WatchTest, AnOlderFileOfEqualSizeReplacesAtARestart) {
  drop_other_shape("a.ply");
  start();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  watch_->stop();
  drop("a.ply");
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(1000);
  fs::last_write_time(inbox() / "a.ply", long_ago);
  fs::last_write_time(models() / "a.hier/hierarchy.json",
                      fs::file_time_type::clock::now() + std::chrono::hours(1));
  start();
  wait_until([&] { return is_made_of("a.hier", inbox() / "a.ply"); });
}

TEST_F(WatchTest, AHierarchyMadeByHandIsLeftAsItIs) {
  drop("a.ply");
  tests::build_small(directory_.path() / "a.ply", models() / "a.hier");
  const auto manifest = storage::open_folder(models())->open("a.hier/hierarchy.json")->version();
  start();
  wait_until([&] { return is_idle() && fs::exists(models() / ".a.hier.meshhier-input"); });
  EXPECT_EQ(folder_->open("a.hier/hierarchy.json")->version(), manifest);
}

TEST_F(WatchTest, AFileThatBecomesALinkBeforeItIsOpenedIsNotFollowed) {
  const fs::path secret = directory_.path() / "secret.off";
  tests::write_text(secret, "OFF\nnobody may read this");
  run_before_the_build("ln -sfn " + secret.string() + " " + (inbox() / "a.off").string());
  start();
  put("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  wait_until([&] { return told().size() == 2; });
  EXPECT_THAT(told()[1], AllOf(HasSubstr("it is a link"), Not(HasSubstr("nobody"))));
  EXPECT_FALSE(fs::exists(models() / "a.hier"));
}

TEST_F(WatchTest, AFolderThatBecomesALinkIsNotFollowed) {
  const fs::path secret = directory_.path() / "secret";
  fs::create_directory(secret);
  tests::write_text(secret / "a.off", "OFF\nnobody may read this");
  tests::write_ply(tests::sphere(600), secret / "b.ply");
  run_before_the_build("mv " + (inbox() / "h").string() + " " + (directory_.path() / "h").string() +
                       " 2>/dev/null && ln -s " + secret.string() + " " + (inbox() / "h").string());
  fs::create_directory(directory_.path() / "new");
  tests::write_ply(tests::sphere(600), directory_.path() / "new/b.ply");
  fs::rename(directory_.path() / "new", inbox() / "h");
  start();
  wait_until([&] { return told().size() >= 2; });
  EXPECT_THAT(told()[1], HasSubstr("is a link"));
  EXPECT_TRUE(fs::is_empty(models()));
}

TEST_F(WatchTest, WhatLiesOutsideTheInboxIsMissing) {
  put_picture("wall.png", 16);
  fs::rename(inbox() / "wall.png", directory_.path() / "wall.png");
  drop_library("../wall.png");
  drop_obj();
  start();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  EXPECT_EQ(texels(), 0U);
  EXPECT_EQ(builds_of("a.obj"), 1);
}

TEST_F(WatchTest, StoppingStopsTheBuildAndTheNextOneGoesOn) {
  stop_in_the_middle();
  start();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  EXPECT_FALSE(fs::exists(models() / ".a.hier.meshhier-work"));
}

TEST_F(WatchTest, WorkOfAnotherConfigIsBegunAnew) {
  config_ = directory_.path() / "config.json";
  tests::write_text(config_, "{}");
  stop_in_the_middle();
  tests::write_text(config_, R"({"partition": {"vertices": 4000}})");
  start();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  EXPECT_FALSE(fs::exists(models() / ".a.hier.meshhier-work"));
  EXPECT_THAT(text_of(models() / "a.hier/hierarchy.json"), HasSubstr("4000"));
}

TEST_F(WatchTest, WhatAnotherBuildHasInHandWaits) {
  fs::create_directories(models() / ".a.hier.meshhier-work");
  auto lock = files_->try_lock(models() / ".a.hier.meshhier-work/lock");
  start();
  drop("a.ply");
  wait_until([&] {
    return job("a.ply", "state") == "waiting" &&
           job("a.ply", "message").find("another") != std::string::npos;
  });
  drop("b.ply");
  wait_until([&] { return is_there("b.hier"); });
  lock.reset();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
}

TEST_F(WatchTest, AChangedPictureOrLibraryBuildsAgain) {
  start();
  drop_textured();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  put_picture("textures/wall.png", 32);
  wait_until([&] { return texels() == 32 * 32 && is_idle(); });
  put_picture("textures/other.png", 8);
  drop_library("textures/other.png");
  wait_until([&] { return texels() == 8 * 8 && is_idle(); });
}

TEST_F(WatchTest, AMissingPictureOrLibraryThatAppearsBuildsAgain) {
  start();
  drop_obj();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  ASSERT_EQ(texels(), 0U);
  drop_library("textures/wall.png");
  wait_until([&] { return builds_of("a.obj") == 2 && is_idle(); });
  put_picture("wall.png", 8);  // beside the library is as good
  wait_until([&] { return texels() == 8 * 8 && is_idle(); });
  EXPECT_EQ(builds_of("a.obj"), 3);
}

TEST_F(WatchTest, APictureThatIsTouchedOrGoneBuildsNothing) {
  start();
  drop_textured();
  wait_until([&] { return is_there("a.hier") && is_idle(); });
  const fs::path picture = inbox() / "textures/wall.png";
  const fs::path note = models() / ".a.hier.meshhier-input";
  const std::string noted = text_of(note);
  tests::make_later(picture);
  wait_until([&] { return text_of(note) != noted && is_idle(); });
  fs::remove(picture);
  drop("b.ply");  // a round goes by
  wait_until([&] { return is_there("b.hier") && is_idle(); });
  EXPECT_EQ(builds_of("a.obj"), 1);
}

TEST_F(WatchTest, ARestartBuildsNothingWithCompanionsAgain) {
  start();
  drop_textured();
  drop_gltf();
  wait_until([&] { return is_there("a.hier") && is_there("t.hier") && is_idle(); });
  start();
  drop("z.ply");
  wait_until([&] { return is_there("z.hier") && is_idle(); });
  EXPECT_EQ(builds_of("a.obj"), 1);
  EXPECT_EQ(builds_of("t.gltf"), 1);
  watch_->stop();
  put_picture("textures/wall.png", 32);
  start();
  wait_until([&] { return texels() == 32 * 32 && is_idle(); });
}

TEST_F(WatchTest, AChangedBufferBuildsAgain) {
  start();
  drop_gltf();
  wait_until([&] { return is_there("t.hier") && is_idle(); });
  const std::uint64_t before = hierarchies_->look("t.hier")->source_checksum;
  put("t.bin", std::string(35, '\0') + '\x40');
  wait_until([&] {
    const auto model = hierarchies_->look("t.hier");
    return model && model->source_checksum != before;
  });
}

TEST_F(WatchTest, APictureThatIsReplacedAtTheEndOfItsBuildBuildsAgain) {
  put_picture("textures/wall.png", 32);
  fs::rename(inbox() / "textures/wall.png", directory_.path() / "other.png");
  run_before_the_end("test -e " + (directory_.path() / "other.png").string() + " && mv " +
                     (directory_.path() / "other.png").string() + " " +
                     (inbox() / "textures/wall.png").string());
  start();
  drop_textured();
  wait_until([&] { return is_there("a.hier") && texels() == 32 * 32 && is_idle(); });
  EXPECT_THAT(told(), Contains("a.obj: it was changed while it was built; it is looked at again"));
}

TEST_F(WatchTest, ATexturedHierarchyMadeByHandIsLeftAsItIs) {
  drop_textured();
  config::Config by_hand;
  by_hand.input = inbox() / "a.obj";
  by_hand.output = models() / "a.hier";
  execution::NoProgress progress;
  pipeline::build_hierarchy(by_hand, {}, {*files_, progress, execution::CancelToken()});
  const auto manifest = storage::open_folder(models())->open("a.hier/hierarchy.json")->version();
  start();
  wait_until([&] { return is_idle() && fs::exists(models() / ".a.hier.meshhier-input"); });
  EXPECT_EQ(folder_->open("a.hier/hierarchy.json")->version(), manifest);
}

TEST_F(WatchTest, AnInboxThatGoesAwayIsToldOnceAndComesBack) {
  start();
  fs::remove_all(inbox());
  wait_until([&] { return !told().empty(); });
  EXPECT_THAT(told(), ElementsAre(AllOf(HasSubstr("inbox"), HasSubstr("No such file"))));
  fs::create_directories(inbox());
  drop("a.ply");
  wait_until([&] { return is_there("a.hier"); });
  EXPECT_THAT(told().front(), HasSubstr("inbox"));
  EXPECT_THAT(told()[1], StartsWith("a.ply: building"));
}

}  // namespace
}  // namespace meshhier::server
