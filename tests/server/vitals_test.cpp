#include "server/vitals.h"

#include "base/error.h"
#include "tests/server/served_folder.h"
#include "tests/support/faulty_file_system.h"

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::Call;

constexpr const char* kWord = "0123456789abcdef";

class VitalsTest : public testing::Test {
 protected:
  VitalsTest() {
    fs::create_directories(folder());
    fs::create_directories(inbox());
  }
  fs::path folder() const { return directory_.path() / "models"; }
  fs::path inbox() const { return directory_.path() / "inbox"; }

  Vitals make(ReadinessOptions readiness, std::string token = {}) {
    readiness.folder = storage::open_folder(folder());
    return Vitals(
        {std::move(readiness), std::move(token)}, files_, [this] { return figures_; },
        [this](LogLevel level, const std::string& message) {
          told_.push_back(std::string(name_in(kLogLevels, level)) + ": " + message);
        });
  }
  static Request from(const std::string& client) { return {.client = client}; }
  /// The names of the checks that fail.
  static std::vector<std::string> failing(Vitals& vitals) {
    const Reply reply = vitals.answer({}, "readyz");
    const json document = json::parse(reply.text);
    std::vector<std::string> names;
    for (const json& check : document["checks"]) {
      EXPECT_EQ(check["ok"].get<bool>(), !check.contains("reason"));
      if (!check["ok"].get<bool>())
        names.push_back(check["name"]);
    }
    EXPECT_EQ(reply.status, names.empty() ? 200 : 503);
    EXPECT_EQ(document["status"], names.empty() ? "ready" : "not ready");
    return names;
  }

  tests::TemporaryDirectory directory_;
  tests::FaultyFileSystem files_;
  Figures figures_{.models = 3};
  std::vector<std::string> told_;
};

TEST_F(VitalsTest, OnlyTheseThreePathsAreVital) {
  for (const char* path : {"healthz", "readyz", "metrics"})
    EXPECT_TRUE(Vitals::is_vital(path));
  for (const char* path : {"", "healthz/", "models/healthz", "Healthz", "healthz.hier", "readyz2"})
    EXPECT_FALSE(Vitals::is_vital(path)) << path;
}

TEST_F(VitalsTest, IsAliveAndKeptByNobody) {
  Vitals vitals = make({});
  const Reply reply = vitals.answer({}, "healthz");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(json::parse(reply.text), json({{"status", "alive"}}));
  EXPECT_EQ(reply.header("Cache-Control"), "no-store");
}

TEST_F(VitalsTest, AFolderThatIsOnlyReadNeedsNoDisk) {
  Vitals vitals = make({.disk_floor = UINT64_MAX});
  EXPECT_THAT(failing(vitals), IsEmpty());
  fs::remove(folder());
  EXPECT_THAT(failing(vitals), ElementsAre("folder"));
}

TEST_F(VitalsTest, AFolderThatTookThePlaceOfTheShownOneIsNotReady) {
  Vitals vitals = make({});
  const fs::path aside = directory_.path() / "aside";
  fs::rename(folder(), aside);
  EXPECT_THAT(failing(vitals), ElementsAre("folder"));
  fs::create_directory(folder());
  EXPECT_THAT(failing(vitals), ElementsAre("folder"));
  EXPECT_THAT(vitals.answer({}, "readyz").text, HasSubstr("start the server again"));
  fs::remove(folder());
  fs::rename(aside, folder());
  EXPECT_THAT(failing(vitals), IsEmpty());
}

TEST_F(VitalsTest, WhatIsWrittenNeedsDisk) {
  Vitals vitals = make({.inbox = inbox(), .disk_floor = 1});
  EXPECT_THAT(failing(vitals), IsEmpty());
  Vitals full = make({.inbox = inbox(), .disk_floor = UINT64_MAX});
  EXPECT_THAT(failing(full), ElementsAre("disk"));
  EXPECT_THAT(full.answer({}, "readyz").text, HasSubstr("--disk-floor"));
  files_.fail(Call::free_bytes, 1);
  EXPECT_THAT(failing(vitals), ElementsAre("disk"));
}

TEST_F(VitalsTest, ReasonsNameNoPlaceOfThisMachineAndAreToldOnce) {
  Vitals vitals = make({.inbox = inbox(), .takes_uploads = true, .disk_floor = 1});
  fs::remove(inbox());
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(vitals.answer({}, "readyz").text,
                AllOf(HasSubstr("inbox"), Not(HasSubstr(directory_.path().string()))));
  }
  fs::create_directory(inbox());
  for (int i = 0; i < 3; ++i)
    EXPECT_THAT(failing(vitals), IsEmpty());
  EXPECT_THAT(told_, ElementsAre(HasSubstr("warning: not ready: inbox: "), "info: ready again"));
}

TEST_F(VitalsTest, FiguresAreForThisMachine) {
  Vitals vitals = make({});
  EXPECT_EQ(vitals.answer(from("127.0.0.1"), "metrics").status, 200);
  EXPECT_EQ(vitals.answer(from("::ffff:127.0.0.1"), "metrics").status, 200);
  for (const char* other : {"", "10.0.0.1", "::2", "1.127.0.0"})
    EXPECT_EQ(vitals.answer(from(other), "metrics").status, 403) << other;
  Request request = from("::1");
  request.is_passed_on = true;
  EXPECT_EQ(vitals.answer(request, "metrics").status, 403) << "a proxy asks for somebody else";
  request = from("::1");
  request.origin = "http://localhost:8080";
  EXPECT_EQ(vitals.answer(request, "metrics").status, 403) << "a page asks";
  request = from("10.0.0.1");
  request.authorization = "Bearer ";
  EXPECT_EQ(vitals.answer(request, "metrics").status, 403) << "there is no word to know";
}

TEST_F(VitalsTest, OrForThoseWhoKnowTheWord) {
  Vitals vitals = make({}, kWord);
  Request request = from("127.0.0.1");
  EXPECT_EQ(vitals.answer(request, "metrics").status, 401);
  EXPECT_EQ(vitals.answer(request, "healthz").status, 200);
  request = from("10.0.0.1");
  for (const std::string wrong : {"Bearer", "Bearer 0", "Basic 0123456789abcdef"}) {
    request.authorization = wrong;
    EXPECT_EQ(vitals.answer(request, "metrics").status, 401) << wrong;
  }
  request.authorization = std::string("bearer ") + kWord;
  EXPECT_EQ(vitals.answer(request, "metrics").status, 200);
}

TEST_F(VitalsTest, TheNumberOfSamplesDoesNotDependOnRequests) {
  Vitals vitals = make({.inbox = inbox()});
  figures_.builds = BuildCounts{.done = 2, .failed = 1, .seconds = 1.5, .at_work = 1};
  figures_.uploads = UploadCounts{.taken = 4};
  const auto lines = [&] {
    std::istringstream text(vitals.answer(from("::1"), "metrics").text);
    std::size_t count = 0;
    for (std::string line; std::getline(text, line);)
      ++count;
    return count;
  };
  const std::size_t before = lines();
  for (const char* method : {"GET", "PUT", "BREW", "X\"}\n", ""}) {
    for (const int status : {0, 99, 100, 200, 206, 304, 404, 503, 700, -1})
      vitals.count({"::1", method, "/", status, 0});
  }
  EXPECT_EQ(lines(), before);
  const std::string text = vitals.answer(from("::1"), "metrics").text;
  EXPECT_THAT(
      text, AllOf(HasSubstr("meshhier_requests_total{method=\"GET\",status=\"2xx\"} 2\n"),
                  HasSubstr("meshhier_requests_total{method=\"GET\",status=\"3xx\"} 1\n"),
                  HasSubstr("meshhier_requests_total{method=\"other\",status=\"4xx\"} 3\n"),
                  HasSubstr("meshhier_builds_total{result=\"failed\"} 1\n"),
                  HasSubstr("meshhier_build_seconds_total 1.5\n"),
                  HasSubstr("meshhier_inbox_meshes{state=\"building\"} 1\n"),
                  HasSubstr("meshhier_uploads_total{result=\"taken\"} 4\n"),
                  HasSubstr("meshhier_disk_free_bytes{place=\"inbox\"} "), Not(HasSubstr("BREW"))));
}

}  // namespace
}  // namespace meshhier::server
