#include "server/static_site.h"

#include "tests/server/served_folder.h"

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
                .begin = [](std::uint64_t) {},
                .copied = [] {}});
  }
  fs::path site() const { return folder_.path() / "site"; }

  tests::ServedFolder folder_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::vector<std::string> told_;
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

}  // namespace
}  // namespace meshhier::server
