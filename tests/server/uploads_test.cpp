#include "server/uploads.h"

#include "base/error.h"
#include "server/build_target.h"
#include "server/secret.h"
#include "server/staged_upload.h"
#include "storage/io/output_file.h"
#include "tests/server/form_text.h"
#include "tests/server/served_folder.h"
#include "tests/server/text_body.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/zip_archive.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::Call;
using tests::form_text;
using tests::text_of;
using tests::TextBody;
using tests::write_text;

class UploadsTest : public testing::Test {
 protected:
  Uploads& uploads() {
    if (!uploads_) {
      uploads_.emplace(options_, files_,
                       [this](const std::string& message) { told_.push_back(message); });
    }
    return *uploads_;
  }
  const fs::path& inbox() const { return options_.inbox; }

  static Request request(const std::string& method, Body* body) {
    return {.method = method, .host = "localhost:8080", .body = body};
  }
  Reply put(const std::string& name, Body& body) {
    return uploads().take(request("PUT", &body), "/" + name);
  }
  Reply put(const std::string& name, const std::string& text) {
    TextBody body(text);
    return put(name, body);
  }
  Reply post(const std::string& name, Body& body) {
    Request sent = request("POST", &body);
    sent.content_type = "multipart/form-data; boundary=" + tests::kBoundary;
    return uploads().take(sent, "/" + name);
  }
  Reply post(const std::string& name, const tests::FormFiles& files) {
    TextBody body(form_text(files));
    return post(name, body);
  }

  /// Paths and contents of all that is in the inbox, hidden or not.
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(inbox())) {
      found[entry.path().lexically_relative(inbox())] =
          entry.is_regular_file() ? text_of(entry.path()) : "";
    }
    return found;
  }
  void expect_nothing_left(const std::string& what) const {
    EXPECT_THAT(contents(), IsEmpty()) << what;
  }

  tests::TemporaryDirectory directory_;
  tests::FaultyFileSystem files_;
  UploadOptions options_{.inbox = directory_.path()};
  std::vector<std::string> told_;
  std::optional<Uploads> uploads_;
};

TEST_F(UploadsTest, AMeshIsThereAsItWasSent) {
  const std::string text(1'000'000, 'x');
  TextBody body(text, {.most_at_once = 1001});
  const Reply reply = put("My%20scan.ply.gz", body);
  EXPECT_EQ(reply.status, 201);
  EXPECT_EQ(reply.text, "My scan.ply.gz is in the inbox.\n");
  EXPECT_THAT(contents(), ElementsAre(testing::Pair("My scan.ply.gz", text)));
  EXPECT_EQ(put(std::string(200, 'n') + ".ply", "x").status, 201) << "204 bytes";
}

TEST_F(UploadsTest, AnArchiveIsTakenUnlessItIsAHierarchy) {
  const Reply reply = put("made.3tz", tests::zip_of({{"hierarchy.json", "{}"}}));
  EXPECT_EQ(reply.status, 400);
  EXPECT_THAT(reply.text, HasSubstr("is a hierarchy already"));
  expect_nothing_left("made.3tz");
  EXPECT_EQ(put("town.3tz", tests::zip_of({{"tileset.json", "{}"}})).status, 201);
}

TEST_F(UploadsTest, ItHasItsNameOnlyWhenItIsWhole) {
  std::vector<std::string> visible;
  const auto look = [&] {
    for (const auto& entry : fs::directory_iterator(inbox())) {
      if (!entry.path().filename().string().starts_with('.'))
        visible.push_back(entry.path());
    }
  };
  TextBody file(std::string(1000, 'x'), {.most_at_once = 100, .on_read = look});
  EXPECT_EQ(put("a.ply", file).status, 201);
  EXPECT_THAT(visible, IsEmpty());
  fs::remove(inbox() / "a.ply");
  TextBody form(form_text({{"a.obj", "o"}, {"a.mtl", "m"}}), {.most_at_once = 10, .on_read = look});
  EXPECT_EQ(post("house", form).status, 201);
  EXPECT_THAT(visible, IsEmpty());
}

TEST_F(UploadsTest, FilesThatBelongTogetherBecomeAFolder) {
  EXPECT_EQ(post("house", {{"a.obj", "o"}, {"a.mtl", "m"}, {"wall 1.png", ""}}).status, 201);
  EXPECT_THAT(contents(), ElementsAre(testing::Pair("house", ""), testing::Pair("house/a.mtl", "m"),
                                      testing::Pair("house/a.obj", "o"),
                                      testing::Pair("house/wall 1.png", "")));
}

TEST_F(UploadsTest, FoldersThatAreNoModelAreRefused) {
  const auto refused = [&](const tests::FormFiles& files, const char* why) {
    const Reply reply = post("house", files);
    EXPECT_EQ(reply.status, 400) << why;
    EXPECT_THAT(reply.text, HasSubstr(why));
    expect_nothing_left(why);
  };
  refused({}, "no mesh");
  refused({{"a.mtl", "m"}}, "no mesh");
  refused({{"a.obj", "o"}, {"b.ply", "p"}}, "several meshes");
  refused({{"a.obj", "o"}, {"A.mtl", "m"}, {"a.MTL", "m"}}, "same name");
  for (const char* name : {"../a.mtl", ".a.mtl", "a/b.mtl", "/etc/a.mtl", "", "..", "a\tb"})
    refused({{"a.obj", "o"}, {name, "m"}}, "cannot be taken");
  TextBody cut(form_text({{"a.obj", "o"}}).substr(0, 150));
  EXPECT_EQ(post("house", cut).status, 400);
  expect_nothing_left("no whole form");
  TextBody body("x");
  EXPECT_EQ(uploads().take(request("POST", &body), "/house").status, 415);
}

TEST_F(UploadsTest, NamesThatCouldMeanMoreAreRefused) {
  for (const std::string& name :
       {std::string("..%2fa.ply"), std::string("../a.ply"), std::string(".a.ply"),
        std::string("a/b.ply"), std::string("a%2fb.ply"), std::string("a%5cb.ply"),
        std::string("a%00.ply"), std::string("a%0a.ply"), std::string(), std::string("a%zz.ply"),
        std::string("a.txt"), std::string("a.ply.part"), std::string("a"),
        std::string(252, 'n') + ".ply"}) {
    EXPECT_EQ(put(name, "x").status, 400) << name;
    expect_nothing_left(name);
  }
  EXPECT_EQ(post("a/b", {{"a.obj", "o"}}).status, 400);
  EXPECT_EQ(post(".house", {{"a.obj", "o"}}).status, 400);
}

TEST_F(UploadsTest, NamesThatNoModelCanBeMadeOfAreRefusedAtOnce) {
  for (std::size_t bytes = 190; bytes <= 255; ++bytes) {
    const std::string name = std::string(bytes - 4, 'n') + ".ply";
    const Reply reply = put(name, "x");
    EXPECT_EQ(reply.status, excess_of_name(name, ".hier") == 0 ? 201 : 400) << bytes;
    if (reply.status == 400) {
      EXPECT_THAT(reply.text, HasSubstr("too long"));
    }
  }
  EXPECT_EQ(put(std::string(240, 'n') + ".ply", "x").status, 400);
  EXPECT_EQ(post(std::string(240, 'h'), {{"a.obj", "o"}}).status, 400);
  EXPECT_EQ(post("house", {{std::string(240, 'n') + ".obj", "o"}}).status, 400);
  EXPECT_EQ(post("hut", {{"a.obj", "o"}, {std::string(240, 'n') + ".png", "p"}}).status, 201)
      << "a picture has nothing made of it";
}

TEST_F(UploadsTest, PartsOfFilesAreRefused) {
  TextBody body("x");
  Request part = request("PUT", &body);
  part.is_part = true;
  EXPECT_EQ(uploads().take(part, "/a.ply").status, 400);
  expect_nothing_left("a part");
}

TEST_F(UploadsTest, NothingIsReplaced) {
  write_text(inbox() / "a.ply", "before");
  fs::create_directory(inbox() / "house");
  fs::create_symlink("/nowhere", inbox() / "link.ply");
  EXPECT_EQ(put("a.ply", "after").status, 409);
  EXPECT_EQ(put("link.ply", "after").status, 409);
  EXPECT_EQ(post("house", {{"a.obj", "o"}}).status, 409);
  EXPECT_EQ(text_of(inbox() / "a.ply"), "before");
  EXPECT_FALSE(fs::exists("/nowhere"));
}

TEST_F(UploadsTest, OfTwoAtATimeTheFirstGetsTheName) {
  const auto other = [&] { write_text(inbox() / "a.ply", "other"); };
  TextBody body("mine", {.on_read = other});
  EXPECT_EQ(put("a.ply", body).status, 409);
  EXPECT_THAT(contents(), ElementsAre(testing::Pair("a.ply", "other")));
  const auto folder = [&] { fs::create_directories(inbox() / "house"); };
  TextBody form(form_text({{"a.obj", "o"}}), {.on_read = folder});
  EXPECT_EQ(post("house", form).status, 409);
  EXPECT_THAT(contents(), ElementsAre(testing::Pair("a.ply", "other"), testing::Pair("house", "")));
}

TEST_F(UploadsTest, WhatEndsEarlyLeavesNothing) {
  const std::vector<std::pair<Body::End, int>> ends{
      {Body::End::lost, 400}, {Body::End::slow, 408}, {Body::End::stopping, 503}};
  for (const auto& [end, status] : ends) {
    TextBody file("half", {.end = end, .missing_bytes = 4});
    EXPECT_EQ(put("a.ply", file).status, status);
    expect_nothing_left("a file");
    const std::string form = form_text({{"a.obj", "o"}, {"a.mtl", "m"}});
    for (std::size_t bytes = 0; bytes < form.size(); ++bytes) {
      TextBody body(form.substr(0, bytes), {.end = end, .missing_bytes = form.size() - bytes});
      EXPECT_EQ(post("house", body).status, status) << bytes;
      expect_nothing_left("a folder");
    }
  }
}

TEST_F(UploadsTest, WhatIsTooLargeIsRefusedUnread) {
  options_.limit_bytes = 1024;
  TextBody body(std::string(1025, 'x'), {.on_read = [] { FAIL() << "it is read"; }});
  const Reply reply = put("a.ply", body);
  EXPECT_EQ(reply.status, 413);
  EXPECT_EQ(reply.text, "It is larger than 1KiB, the limit (--upload-limit).\n");
  EXPECT_EQ(put("a.ply", std::string(1024, 'x')).status, 201);
}

TEST_F(UploadsTest, WhatHasNoLengthIsRefused) {
  EXPECT_EQ(uploads().take(request("PUT", nullptr), "/a.ply").status, 411);
}

TEST_F(UploadsTest, AFullDiskIsTold) {
  files_.limit_room(1000);
  TextBody body(std::string(1001, 'x'), {.on_read = [] { FAIL() << "it is read"; }});
  EXPECT_EQ(put("a.ply", body).status, 507);
  files_.limit_writes(1000);
  EXPECT_EQ(put("a.ply", std::string(1001, 'x')).status, 507);
  expect_nothing_left("a file");
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_THAT(told_[0], HasSubstr("a.ply: "));
  EXPECT_THAT(told_[0], HasSubstr("no space left"));
}

constexpr std::uint64_t kMiB = 1024 * 1024;

TEST_F(UploadsTest, WhatWouldGoBelowTheFloorIsRefusedUnread) {
  options_.disk_floor = 10 * kMiB;
  files_.limit_room(12 * kMiB);
  TextBody body(std::string(2 * kMiB + 1, 'x'), {.on_read = [] { FAIL() << "it is read"; }});
  const Reply reply = put("a.ply", body);
  EXPECT_EQ(reply.status, 507);
  EXPECT_EQ(reply.text,
            "The disk has no room for it: 12.0 MiB are free, and 10MiB must stay free "
            "(--disk-floor).\n");
  EXPECT_EQ(put("a.ply", std::string(kMiB, 'x')).status, 201);
  EXPECT_THAT(told_, IsEmpty()) << "the disk has not failed";
}

TEST_F(UploadsTest, WhatFallsBelowTheFloorMeanwhileEnds) {
  options_.disk_floor = 10 * kMiB;
  const auto shrink = [&] { files_.limit_room(9 * kMiB); };
  const auto status_of = [&](const auto& send, const std::string& text) {
    files_.limit_room(100 * kMiB);
    std::size_t reads = 0;
    TextBody body(text, {.most_at_once = 10'000, .on_read = [&] {
                           if (++reads == 10)
                             shrink();
                         }});
    const Reply reply = send(body);
    EXPECT_THAT(reply.text, HasSubstr("--disk-floor"));
    EXPECT_LT(reads, 200U) << "it is read to its end";
    expect_nothing_left("what had come");
    return reply.status;
  };
  EXPECT_EQ(
      status_of([&](TextBody& body) { return put("a.ply", body); }, std::string(3 * kMiB, 'x')),
      507);
  EXPECT_EQ(status_of([&](TextBody& body) { return post("house", body); },
                      form_text({{"a.obj", std::string(3 * kMiB, 'x')}})),
            507);
  tests::FormFiles many;
  for (int i = 0; i < 300; ++i)
    many.emplace_back(std::to_string(i) + ".png", std::string(5000, 'x'));
  EXPECT_EQ(status_of([&](TextBody& body) { return post("house", body); }, form_text(many)), 507);
}

TEST_F(UploadsTest, AnyCallMayFail) {
  uploads();
  bool has_failed = true;
  for (std::uint64_t n = 1; has_failed; ++n) {
    ASSERT_LT(n, 100U);
    files_.fail(Call::any, n);
    const Reply reply = post("house", {{"a.obj", "o"}, {"a.mtl", "m"}});
    files_.fail(Call::any, 1, 0);
    has_failed = reply.status != 201;
    EXPECT_TRUE(!has_failed || reply.status == 507) << n;
    if (fs::exists(inbox() / "house")) {
      EXPECT_EQ(contents().size(), 3U) << n << ": it is whole";
    }
    fs::remove_all(inbox() / "house");
    remove_stale_uploads(files_, inbox());  // a file could not be removed
    expect_nothing_left("call " + std::to_string(n));
  }
}

TEST_F(UploadsTest, OnlySoManyAreUnderWayAtOnce) {
  options_.most_at_once = 1;
  int status = 0;
  TextBody body("x", {.on_read = [&] { status = put("b.ply", "x").status; }});
  EXPECT_EQ(put("a.ply", body).status, 201);
  EXPECT_EQ(status, 503);
  EXPECT_EQ(put("b.ply", "x").status, 201) << "the place is free again";
}

TEST_F(UploadsTest, PagesOfOthersAreRefused) {
  const auto status_of = [&](const char* origin) {
    TextBody body("x");
    Request sent = request("PUT", &body);
    sent.origin = origin;
    fs::remove(inbox() / "a.ply");
    return uploads().take(sent, "/a.ply").status;
  };
  EXPECT_EQ(status_of("http://localhost:8080"), 201);
  EXPECT_EQ(status_of("https://localhost:8080"), 201) << "a proxy speaks TLS";
  for (const char* origin : {"http://localhost:3000", "http://localhost", "null", "",
                             "http://evil.example", "localhost:8080", "http://localhost:80801"})
    EXPECT_EQ(status_of(origin), 403) << origin;
}

TEST_F(UploadsTest, AcrossTheNetworkATokenIsAsked) {
  options_.is_loopback = false;
  options_.token = "0123456789abcdef";
  const auto status_of = [&](std::optional<std::string> authorization) {
    TextBody body("x");
    Request sent = request("PUT", &body);
    sent.authorization = std::move(authorization);
    fs::remove(inbox() / "a.ply");
    return uploads().take(sent, "/a.ply").status;
  };
  EXPECT_EQ(status_of("Bearer 0123456789abcdef"), 201);
  EXPECT_EQ(status_of("bearer  0123456789abcdef "), 201);
  for (const char* wrong : {"", "Bearer ", "Bearer 0123456789abcdeF", "0123456789abcdef",
                            "Basic 0123456789abcdef", "Bearer 0123456789abcdef0", "Bearer 0"})
    EXPECT_EQ(status_of(wrong), 401) << wrong;
  EXPECT_EQ(status_of(std::nullopt), 401);
  EXPECT_TRUE(uploads().offer()->needs_token);
  TextBody body("x");
  EXPECT_EQ(uploads().take(request("PUT", &body), "/a.ply").header("WWW-Authenticate"), "Bearer");
}

TEST_F(UploadsTest, AcrossTheNetworkNobodySendsWithoutAToken) {
  options_.is_loopback = false;
  EXPECT_EQ(put("a.ply", "x").status, 403);
  EXPECT_FALSE(uploads().offer());
}

TEST_F(UploadsTest, OnTheLoopbackATokenCountsAsWell) {
  EXPECT_FALSE(uploads().offer()->needs_token);
  uploads_.reset();
  options_.token = "0123456789abcdef";
  EXPECT_EQ(put("a.ply", "x").status, 401);
}

TEST_F(UploadsTest, WhatAKilledServerLeftIsRemoved) {
  const fs::path place = inbox() / "upload-0123456789abcdef";
  fs::create_directory(storage::unfinished_path(place));
  write_text(storage::unfinished_path(place) / "a.obj", "o");
  write_text(storage::output_lock_path(place), "");
  write_text(inbox() / ".other.ply.meshhier-part", "another program's");
  const auto at_work = std::make_unique<StagedUpload>(files_, inbox());
  write_text(at_work->path(), "half");
  uploads();
  EXPECT_FALSE(fs::exists(storage::unfinished_path(place)));
  EXPECT_FALSE(fs::exists(storage::output_lock_path(place)));
  EXPECT_TRUE(fs::exists(inbox() / ".other.ply.meshhier-part"));
  EXPECT_TRUE(fs::exists(at_work->path())) << "another server takes it";
}

TEST(SecretTest, SecretsAreEqualOrNot) {
  EXPECT_TRUE(is_same_secret("", ""));
  EXPECT_TRUE(is_same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abd", "bbc", "abcabc", "abca"}) {
    EXPECT_FALSE(is_same_secret("abc", other)) << other;
    EXPECT_FALSE(is_same_secret(other, "abc")) << other;
  }
}

}  // namespace
}  // namespace meshhier::server
