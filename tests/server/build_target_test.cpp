#include "server/build_target.h"

#include "tests/server/served_folder.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using Target = BuildTarget::Kind;

class BuildTargetTest : public testing::Test {
 protected:
  BuildTarget target(const std::string& name, bool is_made_of = false) {
    return find_target({hierarchies_, *folder_, ".hier"}, name, inbox_, [&](const Model& model) {
      asked_.push_back(model.path);
      return is_made_of;
    });
  }
  tests::ServedFolder served_;
  std::shared_ptr<const storage::Folder> folder_ = storage::open_folder(served_.models());
  Hierarchies hierarchies_{folder_, [](const std::string&) {}};
  std::vector<std::string> inbox_{"new.ply", "plain.ply"};
  std::vector<std::string> asked_;  ///< about which hierarchies
};

void expect_target(const BuildTarget& target, Target kind, const std::string& name) {
  EXPECT_EQ(target.kind, kind) << target.name;
  EXPECT_EQ(target.name, name);
}

TEST(NameLengthTest, ANameIsAsLongAsWhatIsMadeOfItAllows) {
  EXPECT_EQ(excess_of_name("scan.ply", ".hier"), 0U);
  std::size_t longest = 0;
  while (excess_of_name(std::string(longest + 1, 'n') + ".ply", ".hier") == 0)
    ++longest;
  EXPECT_GT(longest, 190U);
  EXPECT_EQ(excess_of_name(std::string(longest + 7, 'n') + ".ply", ".hier"), 7U);
  EXPECT_EQ(excess_of_name(std::string(240, 'n') + "/a.ply", ".hier"),
            excess_of_name(std::string(240, 'n') + ".a.ply", ".hier"));
  EXPECT_GT(excess_of_name("house/" + std::string(240, 'n') + ".ply", ".hier"), 0U);
}

TEST_F(BuildTargetTest, ANewFileGetsItsStem) {
  expect_target(target("new.ply"), Target::build, "new.hier");
  expect_target(target("new.obj.gz"), Target::build, "new.hier");
}

TEST_F(BuildTargetTest, OfTwoWithOneStemTheSecondKeepsItsEnding) {
  inbox_ = {"new.obj", "new.ply"};
  expect_target(target("new.obj"), Target::build, "new.hier");
  expect_target(target("new.ply"), Target::build, "new.ply.hier");
}

TEST_F(BuildTargetTest, WhoWasThereFirstKeepsItsName) {
  inbox_ = {"plain.obj", "plain.ply"};
  expect_target(target("plain.obj"), Target::build, "plain.obj.hier");
  EXPECT_EQ(target("plain.ply").name, "plain.hier");
}

TEST_F(BuildTargetTest, AMeshInAFolderIsCalledAsTheFolder) {
  inbox_ = {"house/scan.obj", "scan.ply"};
  expect_target(target("house/scan.obj"), Target::build, "house.hier");
  inbox_ = {"house.ply", "house/scan.obj"};
  expect_target(target("house.ply"), Target::build, "house.hier");
  expect_target(target("house/scan.obj"), Target::build, "house.scan.obj.hier");
}

TEST_F(BuildTargetTest, AMeshInAFolderKnowsItsHierarchy) {
  inbox_ = {"plain/plain.ply"};
  expect_target(target("plain/plain.ply", true), Target::done, "plain.hier");
}

TEST_F(BuildTargetTest, WhatIsNoHierarchyOfOursIsLeftAlone) {
  fs::create_directory(served_.models() / "new.hier");
  expect_target(target("new.ply"), Target::build, "new.ply.hier");
  tests::write_text(served_.models() / "new.ply.hier", "");
  expect_target(target("new.ply"), Target::nowhere, "new.ply.hier");
}

TEST_F(BuildTargetTest, TheContentTellsWhatAHierarchyIsMadeOf) {
  expect_target(target("plain.ply", true), Target::done, "plain.hier");
  expect_target(target("plain.ply", false), Target::replace, "plain.hier");
  EXPECT_EQ(asked_, std::vector<std::string>(2, "plain.hier"));
}

}  // namespace
}  // namespace meshhier::server
