#include "server/input_notes.h"

#include "tests/server/served_folder.h"

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

constexpr storage::FileVersion kVersion{
    .device = 1, .inode = 2, .bytes = 3, .modified_ns = -4, .changed_ns = 5};

class InputNotesTest : public testing::Test {
 protected:
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  InputNotes notes_{*files_, storage::open_folder(directory_.path())};
};

TEST_F(InputNotesTest, ANoteIsFoundForItsVersionAlone) {
  EXPECT_EQ(notes_.find("a.hier", kVersion), std::nullopt);
  notes_.write("a.hier", kVersion, 42);
  EXPECT_EQ(notes_.find("a.hier", kVersion), 42U);
  EXPECT_EQ(notes_.find("b.hier", kVersion), std::nullopt);
  for (const auto& change : std::vector<std::function<void(storage::FileVersion&)>>{
           [](auto& v) { ++v.inode; }, [](auto& v) { ++v.bytes; }, [](auto& v) { --v.modified_ns; },
           [](auto& v) { --v.changed_ns; }}) {
    storage::FileVersion other = kVersion;
    change(other);
    EXPECT_EQ(notes_.find("a.hier", other), std::nullopt);
  }
}

TEST_F(InputNotesTest, ADeviceMayGetAnotherNumber) {
  notes_.write("a.hier", kVersion, 42);
  storage::FileVersion mounted_again = kVersion;
  mounted_again.device = 9;
  EXPECT_EQ(notes_.find("a.hier", mounted_again), 42U);
}

TEST_F(InputNotesTest, ADamagedNoteIsNone) {
  notes_.write("a.hier", kVersion, 42);
  const auto path = directory_.path() / ".a.hier.meshhier-input";
  std::string text = tests::text_of(path);
  text[text.find("\"content\": \"") + 14] = '1';
  for (const std::string& damaged : {text, std::string("{}"), std::string()}) {
    tests::write_text(path, damaged);
    EXPECT_EQ(notes_.find("a.hier", kVersion), std::nullopt) << damaged;
  }
}

}  // namespace
}  // namespace meshhier::server
