#include "server/static_site.h"

#include "base/error.h"
#include "storage/io/output_file.h"
#include "tests/server/served_folder.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::text_of;
using tests::write_text;

class StaticSiteTest : public testing::Test {
 protected:
  void make() {
    const auto viewer = storage::open_folder(folder_.viewer());
    write_site(*files_, {storage::open_folder(folder_.models()), *viewer, site(), true},
               {.check = [] {},
                .tell = [this](const std::string& message) { told_.push_back(message); },
                .begin = [this](std::uint64_t) { begin_(); },
                .copied = [] {}});
  }
  fs::path site() const { return folder_.path() / "site"; }

  tests::ServedFolder folder_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::vector<std::string> told_;
  std::function<void()> begin_ = [] {};
};

TEST_F(StaticSiteTest, AHostThatLeavesNamesOutIsToldNotTo) {
  make();
  EXPECT_TRUE(fs::is_regular_file(site() / ".nojekyll"));
}

TEST_F(StaticSiteTest, PicturesOfStoriesAreCopiedAndMissingOnesAreTold) {
  const auto picture = [](const std::string& name) {
    return R"({"body": {"type": "Image", "id": ")" + name + "\"}}";
  };
  write_text(folder_.models() / "sub dir/zipped.hier.story.json",
             "{\"items\": [" + picture("pictures/1%20a.png") + "," + picture("gone.jpg") + "," +
                 picture("../secret.png") + "]}");
  fs::create_directory(folder_.models() / "sub dir/pictures");
  write_text(folder_.models() / "sub dir/pictures/1 a.png", "one");
  write_text(folder_.models() / "sub dir/pictures/2.png", "nobody names it");
  write_text(folder_.models() / "secret.png", "secret");
  make();
  EXPECT_EQ(text_of(site() / "models/sub dir/pictures/1 a.png"), "one");
  EXPECT_FALSE(fs::exists(site() / "models/sub dir/pictures/2.png"));
  EXPECT_FALSE(fs::exists(site() / "models/secret.png"));
  EXPECT_THAT(told_, testing::Contains(HasSubstr("the picture gone.jpg, which is not there")));
}

TEST_F(StaticSiteTest, AHierarchyThatIsReplacedIsNotCopiedInPart) {
  begin_ = [&] {
    tests::build_small(folder_.path() / "meshes/plain.ply", folder_.models() / "plain.hier",
                       storage::Compression::none, 6000);
  };
  try {
    make();
    ADD_FAILURE() << "tiles of the new one are missing";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("another hierarchy has taken its place"));
  }
  EXPECT_FALSE(fs::exists(site()));
}

TEST_F(StaticSiteTest, OneWriterAtATime) {
  const auto lock = files_->try_lock(storage::output_lock_path(site()));
  try {
    make();
    ADD_FAILURE() << "another one is at work";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::locked);
  }
}

}  // namespace
}  // namespace meshhier::server
