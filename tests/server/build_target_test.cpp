#include "server/build_target.h"

#include "tests/server/served_folder.h"

#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using Kind = BuildTarget::Kind;

class BuildTargetTest : public testing::Test {
 protected:
  BuildTarget target(const std::string& name, const storage::FileVersion& version = {},
                     std::uint64_t checksum = 0) {
    return find_target({hierarchies_, *folder_, ".hier"}, name, version, inbox_, [&] {
      ++read_;
      return checksum;
    });
  }
  /// The hierarchy `name` with the facts about its source.
  Model model(const std::string& name) { return hierarchies_.look(name).value(); }

  tests::ServedFolder served_;
  std::shared_ptr<const storage::Folder> folder_ = storage::open_folder(served_.models());
  Hierarchies hierarchies_{folder_, [](const std::string&) {}};
  std::vector<std::string> inbox_{"new.ply", "plain.ply"};
  int read_ = 0;
};

void expect(const BuildTarget& target, Kind kind, const std::string& name) {
  EXPECT_EQ(target.kind, kind) << target.name;
  EXPECT_EQ(target.name, name);
}

TEST_F(BuildTargetTest, ANewFileGetsItsStem) {
  expect(target("new.ply"), Kind::build, "new.hier");
  expect(target("new.obj.gz"), Kind::build, "new.hier");
}

TEST_F(BuildTargetTest, OfTwoWithOneStemTheSecondKeepsItsEnding) {
  inbox_ = {"new.obj", "new.ply"};
  expect(target("new.obj"), Kind::build, "new.hier");
  expect(target("new.ply"), Kind::build, "new.ply.hier");
}

TEST_F(BuildTargetTest, WhoWasThereFirstKeepsItsName) {
  inbox_ = {"plain.obj", "plain.ply"};
  expect(target("plain.obj"), Kind::build, "plain.obj.hier");
  EXPECT_EQ(target("plain.ply").name, "plain.hier");
}

TEST_F(BuildTargetTest, WhatIsNoHierarchyOfOursIsLeftAlone) {
  fs::create_directory(served_.models() / "new.hier");
  expect(target("new.ply"), Kind::build, "new.ply.hier");
  tests::write_text(served_.models() / "new.ply.hier", "");
  expect(target("new.ply"), Kind::nowhere, "new.ply.hier");
}

TEST_F(BuildTargetTest, AHierarchyThatIsNewerIsMadeOfTheFile) {
  const Model made = model("plain.hier");
  storage::FileVersion version{
      .bytes = made.source_bytes, .modified_ns = made.built_ns, .changed_ns = made.built_ns};
  expect(target("plain.ply", version), Kind::done, "plain.hier");
  EXPECT_EQ(read_, 0);
  version.bytes += 1;
  expect(target("plain.ply", version, made.source_checksum), Kind::replace, "plain.hier");
  EXPECT_EQ(read_, 0);
}

TEST_F(BuildTargetTest, WhereTimesDoNotTellTheContentDoes) {
  const Model made = model("plain.hier");
  for (const std::int64_t later : {0, 1}) {
    const storage::FileVersion touched{.bytes = made.source_bytes,
                                       .modified_ns = made.built_ns + later,
                                       .changed_ns = made.built_ns + 1};
    expect(target("plain.ply", touched, made.source_checksum), Kind::done, "plain.hier");
    expect(target("plain.ply", touched, made.source_checksum + 1), Kind::replace, "plain.hier");
  }
  EXPECT_EQ(read_, 4);
}

}  // namespace
}  // namespace meshhier::server
