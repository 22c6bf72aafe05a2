#include "server/view_requests.h"

#include "base/error.h"
#include "server/site.h"
#include "storage/format/layout.h"
#include "storage/format/manifest.h"
#include "storage/format/view_edit.h"
#include "storage/io/forwarding_files.h"
#include "tests/server/served_folder.h"
#include "tests/server/text_body.h"
#include "tests/support/faulty_file_system.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::TextBody;

class ViewRequestsTest : public testing::Test {
 protected:
  ViewRequestsTest()
      : hierarchies_(storage::open_folder(folder_.models()), unheard),
        uploads_({.inbox = inbox_.path(), .token = token_}, files_, unheard),
        views_(folder_.models(), uploads_, hierarchies_, files_, unheard),
        site_({.uploads = &uploads_, .views = &views_}, hierarchies_, Site::Jobs(), unheard) {}

  Reply put(const std::string& target, const std::string& text) {
    TextBody body(text);
    return site_.answer({.method = "PUT",
                         .target = target,
                         .host = "localhost",
                         .authorization = "Bearer " + token_,
                         .has_body = true,
                         .body = &body});
  }
  storage::Manifest manifest(const std::string& name) const {
    const fs::path path = folder_.models() / name / "hierarchy.json";
    return storage::parse_manifest(tests::text_of(path), "manifest");
  }

  static void unheard(const std::string&) {}

  std::string token_ = "sixteen characters";
  tests::ServedFolder folder_;
  tests::TemporaryDirectory inbox_;
  tests::FaultyFileSystem files_;
  Hierarchies hierarchies_;
  Uploads uploads_;
  ViewRequests views_;
  Site site_;
};

constexpr const char* kPlain = "/models/plain.hier/view";

TEST_F(ViewRequestsTest, GiveAHierarchyAnotherViewAndTakeItAway) {
  const std::string before = tests::text_of(folder_.models() / "plain.hier/hierarchy.json");
  const Reply reply = put(kPlain, R"({"light": "raking", "up": "z"})");
  EXPECT_EQ(reply.status, 200) << reply.text;
  EXPECT_THAT(reply.text, HasSubstr("\"light\": \"raking\""));
  EXPECT_EQ(manifest("plain.hier").view.light, "raking");
  const std::string build = hierarchies_.look("plain.hier").value().build;
  EXPECT_THAT(reply.text, HasSubstr(build));
  EXPECT_EQ(put(std::string(kPlain) + "?build=" + build, "{}").status, 200);
  EXPECT_EQ(tests::text_of(folder_.models() / "plain.hier/hierarchy.json"), before);
  EXPECT_EQ(put("/models/sub%20dir/zipped.hier/view", R"({"stretch": 2})").status, 200);
}

TEST_F(ViewRequestsTest, ABuildThatComesMeanwhileIsTold) {
  /// Another build takes the hierarchy's place as soon as the manifest is opened.
  class Replacing final : public storage::ForwardingFiles {
   public:
    Replacing(storage::FileSystem& others, fs::path hierarchy, fs::path aside)
        : ForwardingFiles(others), hierarchy_(std::move(hierarchy)), aside_(std::move(aside)) {}
    std::unique_ptr<storage::File> open(const fs::path& path) override {
      auto file = ForwardingFiles::open(path);
      fs::rename(hierarchy_, aside_);
      fs::create_directory(hierarchy_);
      fs::copy_file(storage::manifest_path(aside_), storage::manifest_path(hierarchy_));
      return file;
    }

   private:
    fs::path hierarchy_, aside_;
  };
  const fs::path hierarchy = folder_.models() / "plain.hier";
  Replacing files(files_, hierarchy, folder_.path() / "aside");
  ModelView view;
  view.light = "raking";
  try {
    storage::replace_view(files, hierarchy, view);
    ADD_FAILURE() << "it went with the old one";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::exists) << error.what();
  }
}

TEST_F(ViewRequestsTest, RefuseWhatIsNoViewOrHasNoPlace) {
  EXPECT_EQ(put(kPlain, "{").status, 400);
  const Reply wrong = put(kPlain, R"({"ramp": "jet"})");
  EXPECT_EQ(wrong.status, 400);
  EXPECT_THAT(wrong.text, HasSubstr("view.ramp: expected one of \"viridis\""));
  EXPECT_EQ(put(kPlain, R"({"attribute": "nothing"})").status, 400);
  EXPECT_EQ(put(kPlain, std::string(70000, ' ')).status, 413);
  EXPECT_EQ(put(std::string(kPlain) + "?build=0123456789abcdef", "{}").status, 409);
  EXPECT_EQ(put("/models/packed.3tz/view", "{}").status, 409);
  EXPECT_EQ(put("/models/none.hier/view", "{}").status, 404);
  EXPECT_EQ(put("/models/../secret.txt/view", "{}").status, 404);
  EXPECT_EQ(put("/models/stream.prog/view", "{}").status, 404);
  EXPECT_EQ(put("/models/view", "{}").status, 404);
}

TEST_F(ViewRequestsTest, AreForWhoMaySendMeshes) {
  TextBody body("{}");
  Request request{.method = "PUT", .target = kPlain, .host = "localhost", .body = &body};
  EXPECT_EQ(site_.answer(request).status, 401);
  request.authorization = "Bearer " + token_;
  request.origin = "https://elsewhere.example";
  EXPECT_EQ(site_.answer(request).status, 403);
  Site reader({}, hierarchies_, Site::Jobs(), unheard);
  EXPECT_EQ(reader.answer(request).status, 405);
}

TEST_F(ViewRequestsTest, AreOfferedByTheListing) {
  const Reply reply = site_.answer({.target = "/models.json", .host = "localhost"});
  EXPECT_THAT(reply.text, HasSubstr("\"views\""));
}

}  // namespace
}  // namespace meshhier::server
