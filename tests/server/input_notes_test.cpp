#include "server/input_notes.h"

#include "tests/server/served_folder.h"

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

const storage::InputNote kNote{UINT64_MAX,
                               {{"a.obj", {3, -4, 5}, 42}, {"b\xFF \xC3\xA4.png", {6, 7, 8}, 9}},
                               {"../c\xFF.png"}};

class InputNotesTest : public testing::Test {
 protected:
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  InputNotes notes_{*files_, storage::open_folder(directory_.path())};
};

TEST_F(InputNotesTest, ANoteComesBackWithNamesOfAnyBytes) {
  EXPECT_FALSE(notes_.find("a.hier"));
  notes_.write("a.hier", kNote);
  EXPECT_FALSE(notes_.find("b.hier"));
  const storage::InputNote note = notes_.find("a.hier").value();
  EXPECT_EQ(note.content, kNote.content);
  ASSERT_EQ(note.files.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(note.files[i].path, kNote.files[i].path);
    EXPECT_EQ(note.files[i].identity, kNote.files[i].identity);
    EXPECT_EQ(note.files[i].identity.changed_ns, kNote.files[i].identity.changed_ns);
    EXPECT_EQ(note.files[i].checksum, kNote.files[i].checksum);
  }
  EXPECT_EQ(note.awaited, kNote.awaited);
}

TEST_F(InputNotesTest, ManyPicturesAreNoHindrance) {
  storage::InputNote note = kNote;
  note.files.resize(20'000, kNote.files[1]);
  notes_.write("a.hier", note);
  EXPECT_EQ(notes_.find("a.hier").value().files.size(), note.files.size());
}

TEST_F(InputNotesTest, ADamagedNoteIsNone) {
  notes_.write("a.hier", kNote);
  const auto path = directory_.path() / ".a.hier.meshhier-input";
  std::string text = tests::text_of(path);
  text[text.find("\"content\": ") + 12] = '2';
  for (const std::string& damaged : {text, std::string("{}"), std::string()}) {
    tests::write_text(path, damaged);
    EXPECT_FALSE(notes_.find("a.hier")) << damaged;
  }
}

}  // namespace
}  // namespace meshhier::server
