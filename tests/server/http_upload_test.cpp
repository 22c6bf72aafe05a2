// Uploads through real sockets.
#include "server/http_server.h"
#include "server/site.h"
#include "server/uploads.h"
#include "storage/io/process.h"
#include "tests/server/form_text.h"
#include "tests/server/raw_client.h"
#include "tests/server/served_folder.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/sizes.h"
#include "tests/support/wait_until.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::RawClient;
using tests::RawReply;
using tests::text_of;

/// No test takes so long: what ends sooner was not ended by the clock.
constexpr std::chrono::hours kAnHour{1};

class HttpUploadTest : public testing::Test {
 protected:
  HttpUploadTest() {
    fs::create_directories(inbox());
    fs::create_directories(models());
  }
  ~HttpUploadTest() override { server_.reset(); }

  void start(ServerOptions options = {}) {
    options.port = 0;
    const auto unheard = [](const std::string&) {};
    upload_.inbox = inbox();
    uploads_.emplace(upload_, files_, unheard);
    hierarchies_.emplace(storage::open_folder(models()), unheard);
    site_.emplace(SiteOptions{.uploads = has_inbox_ ? &*uploads_ : nullptr}, *hierarchies_,
                  Site::Jobs(), unheard);
    server_.emplace(
        options, [this](const Request& request) { return site_->answer(request); },
        HttpServer::Log());
    server_->start();
  }
  std::uint16_t port() const { return server_->port(); }
  fs::path inbox() const { return directory_.path() / "inbox"; }
  fs::path models() const { return directory_.path() / "models"; }

  static std::string head(const std::string& name, std::size_t bytes,
                          const std::string& more = "") {
    return "PUT /inbox/" + name +
           " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(bytes) + "\r\n" +
           more + "\r\n";
  }
  std::vector<std::string> entries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(inbox()))
      names.push_back(entry.path().filename());
    return names;
  }
  /// The part of a running upload, once so many bytes are there.
  void wait_for_part(std::uint64_t bytes) const {
    tests::wait_until([&] {
      for (const auto& entry : fs::directory_iterator(inbox())) {
        if (entry.path().extension() == ".meshhier-part" && fs::file_size(entry.path()) >= bytes)
          return true;
      }
      return false;
    });
  }

  tests::TemporaryDirectory directory_;
  tests::FaultyFileSystem files_;
  UploadOptions upload_;
  bool has_inbox_ = true;
  std::optional<Uploads> uploads_;
  std::optional<Hierarchies> hierarchies_;
  std::optional<Site> site_;
  std::optional<HttpServer> server_;
};

TEST_F(HttpUploadTest, ABodyMayComeInPieces) {
  start();
  const std::string text = "0123456789";
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    RawClient sender(port());
    const std::string name = "a" + std::to_string(cut) + ".ply";
    sender.send(head(name, text.size()) + text.substr(0, cut));
    if (cut < text.size())
      wait_for_part(cut);
    sender.send(text.substr(cut));
    const RawReply reply = sender.receive();
    EXPECT_EQ(reply.status, 201);
    EXPECT_EQ(reply.body, name + " is in the inbox.\n");
    EXPECT_TRUE(sender.is_closed());
    EXPECT_EQ(text_of(inbox() / name), text);
  }
}

TEST_F(HttpUploadTest, BelowTheFloorNobodyIsToldToGoOn) {
  upload_.disk_floor = UINT64_MAX / 2;
  start();
  RawClient client(port());
  client.send(head("a.ply", 3, "Expect: 100-continue\r\n"));
  const RawReply reply = client.receive();
  EXPECT_EQ(reply.status, 507);
  EXPECT_THAT(reply.body, testing::HasSubstr("--disk-floor"));
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(entries().empty());
}

TEST_F(HttpUploadTest, WhatStandsBehindTheBodyIsNoPartOfIt) {
  start();
  RawClient client(port());
  client.send(head("a.ply", 3) + "abcGET /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(client.receive().status, 201);
  EXPECT_EQ(text_of(inbox() / "a.ply"), "abc");
}

TEST_F(HttpUploadTest, AFormBecomesAFolder) {
  start();
  const std::string form = tests::form_text({{"a.obj", "o"}, {"a.mtl", "m"}});
  RawClient client(port());
  client.send(
      "POST /inbox/house HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data; "
      "boundary=" +
      tests::kBoundary + "\r\nContent-Length: " + std::to_string(form.size()) + "\r\n\r\n" + form);
  EXPECT_EQ(client.receive().status, 201);
  EXPECT_EQ(text_of(inbox() / "house/a.obj"), "o");
  EXPECT_EQ(text_of(inbox() / "house/a.mtl"), "m");
}

TEST_F(HttpUploadTest, AnEmptyFileIsAFile) {
  start();
  RawClient client(port());
  client.send(head("a.ply", 0));
  EXPECT_EQ(client.receive().status, 201);
  EXPECT_EQ(text_of(inbox() / "a.ply"), "");
}

TEST_F(HttpUploadTest, WhoWaitsForItIsToldToGoOn) {
  start();
  RawClient client(port());
  client.send(head("a.ply", 3, "Expect: 100-continue\r\n"));
  EXPECT_EQ(client.receive().status, 100);
  client.send("abc");
  EXPECT_EQ(client.receive().status, 201);
  EXPECT_EQ(text_of(inbox() / "a.ply"), "abc");
}

TEST_F(HttpUploadTest, RefusalsComeBeforeTheBody) {
  upload_.limit_bytes = 1000;
  start();
  tests::write_text(inbox() / "taken.ply", "before");
  const auto status_of = [&](const std::string& request) {
    RawClient client(port());
    client.send(request);
    const RawReply reply = client.receive();
    EXPECT_TRUE(reply.body.ends_with(".\n")) << reply.body;
    return reply.status;
  };
  for (const char* expect : {"Expect: 100-continue\r\n", ""}) {
    EXPECT_EQ(status_of(head("a.ply", 1001, expect)), 413);
    EXPECT_EQ(status_of(head("taken.ply", 5, expect)), 409);
    EXPECT_EQ(status_of(head("a.txt", 5, expect)), 400);
    EXPECT_EQ(status_of(head("a.ply", 5, std::string(expect) + "If-Match: *\r\n")), 412);
    EXPECT_EQ(status_of(head("a.ply", 5, std::string(expect) + "Content-Encoding: gzip\r\n")), 415);
    EXPECT_EQ(status_of(head("a.ply", 5, std::string(expect) + "Origin: http://b\r\n")), 403);
    EXPECT_EQ(status_of(head("a.ply", 5,
                             std::string(expect) +
                                 "Origin: http://localhost\r\nOrigin: http://localhost\r\n")),
              403);
    EXPECT_EQ(status_of("PUT /models/a.ply HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n" +
                        std::string(expect) + "\r\n"),
              405);
    EXPECT_EQ(status_of("PUT /inbox/a.ply HTTP/1.1\r\nHost: evil.example\r\nContent-Length: 5\r\n" +
                        std::string(expect) + "\r\n"),
              421);
    EXPECT_EQ(status_of("PUT /inbox/a.ply HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: "
                        "chunked\r\n" +
                        std::string(expect) + "\r\n"),
              411);
  }
  EXPECT_THAT(entries(), testing::ElementsAre("taken.ply"));
}

TEST_F(HttpUploadTest, WhoPacksABodyIsToldHowToSendIt) {
  start();
  const auto reply_to = [&](const std::string& coding) {
    RawClient client(port());
    client.send(head("a.ply", 3, "Content-Encoding: " + coding + "\r\n") + "abc");
    return client.receive();
  };
  for (const char* coding :
       {"gzip", "GZIP", "br, identity", "identity\r\nContent-Encoding: gzip"}) {
    const RawReply reply = reply_to(coding);
    EXPECT_EQ(reply.status, 415) << coding;
    EXPECT_EQ(reply.headers.at("accept-encoding"), "identity") << coding;
    EXPECT_THAT(reply.body, HasSubstr("scan.ply.gz")) << coding;
  }
  EXPECT_THAT(entries(), IsEmpty());
  EXPECT_EQ(reply_to("Identity").status, 201);
}

TEST_F(HttpUploadTest, WhoSendsOnAfterARefusalCanReadIt) {
  upload_.limit_bytes = 1000;
  start();
  RawClient client(port());
  client.send(head("a.ply", 100'000) + std::string(100'000, 'x'));
  EXPECT_EQ(client.receive().status, 413);
}

TEST_F(HttpUploadTest, WithoutAnInboxNothingIsTaken) {
  has_inbox_ = false;
  start();
  RawClient client(port());
  client.send(head("a.ply", 3) + "abc");
  const RawReply reply = client.receive();
  EXPECT_EQ(reply.status, 405);
  EXPECT_EQ(reply.headers.at("allow"), "GET, HEAD, OPTIONS");
  EXPECT_THAT(entries(), IsEmpty());
}

TEST_F(HttpUploadTest, ThePageIsToldWhatItMaySend) {
  upload_.limit_bytes = 1000;
  start();
  EXPECT_THAT(RawClient(port()).get("/models.json").body,
              HasSubstr(R"("upload":{"limit":1000,"token":false})"));
  RawClient client(port());
  const auto allowed = [&](const std::string& target) {
    client.send("OPTIONS " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return client.receive().headers.at("allow");
  };
  EXPECT_EQ(allowed("/inbox/a.ply"), "GET, HEAD, OPTIONS, POST, PUT");
  EXPECT_EQ(allowed("*"), "GET, HEAD, OPTIONS, POST, PUT");
  EXPECT_EQ(allowed("/models.json"), "GET, HEAD, OPTIONS");
}

TEST_F(HttpUploadTest, AConnectionThatEndsEarlyLeavesNothing) {
  start();
  {
    RawClient client(port());
    client.send(head("a.ply", 1000) + "half");
    wait_for_part(0);
  }
  tests::wait_until([&] { return entries().empty(); });
}

TEST_F(HttpUploadTest, WhoSendsNothingIsLeft) {
  ServerOptions options;
  options.limits.stall = std::chrono::milliseconds(100);
  start(options);
  RawClient client(port());
  client.send(head("a.ply", 1000) + "half");
  EXPECT_EQ(client.receive().status, 408);
  EXPECT_THAT(entries(), IsEmpty());
}

TEST_F(HttpUploadTest, ASlowLineIsServedWhileNobodyWaits) {
  ServerOptions options;
  options.limits.grace = std::chrono::milliseconds(0);
  options.limits.least_rate = std::size_t{1} << 60;
  start(options);
  RawClient client(port());
  client.send(head("a.ply", 4) + "ab");
  wait_for_part(0);
  client.send("cd");
  EXPECT_EQ(client.receive().status, 201);
}

TEST_F(HttpUploadTest, SlowSendersMakeRoomForOthers) {
  ServerOptions options{.threads = 1};
  options.limits.grace = std::chrono::milliseconds(0);
  options.limits.least_rate = std::size_t{1} << 60;
  options.limits.stall = kAnHour;
  start(options);
  RawClient slow(port());
  slow.send(head("a.ply", 1'000'000) + "half");
  wait_for_part(0);
  RawClient other(port());
  other.send("GET /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n");
  std::atomic<bool> is_over = false;
  std::thread drip([&] {
    while (!is_over) {  // to its end it takes a quarter of an hour
      slow.send("x");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_EQ(other.receive().status, 200);
  is_over = true;
  drip.join();
  EXPECT_FALSE(fs::exists(inbox() / "a.ply"));
}

TEST_F(HttpUploadTest, SlowSendersOfOneAddressHoldNotAllThreads) {
  ServerOptions options{.threads = 4};
  options.limits.stall = kAnHour;
  start(options);
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 8; ++i) {
    slow.push_back(std::make_unique<RawClient>(port()));
    slow.back()->send(head("a" + std::to_string(i) + ".ply", 1000) + "half");
  }
  tests::wait_until([&] { return server_->traffic().served == 3; });
  EXPECT_EQ(RawClient(port(), 0, "127.0.0.2").get("/models.json").status, 200);
}

TEST_F(HttpUploadTest, ManyAtOnceAreAllStored) {
  start();
  constexpr int kSenders = 8;
  std::vector<std::thread> threads;
  for (int i = 0; i < kSenders; ++i) {
    threads.emplace_back([&, i] {
      RawClient client(port());
      const std::string text(1'000'000 + static_cast<std::size_t>(i), static_cast<char>('a' + i));
      client.send(head("m" + std::to_string(i) + ".ply", text.size()) + text);
      EXPECT_EQ(client.receive().status, 201);
      EXPECT_EQ(text_of(inbox() / ("m" + std::to_string(i) + ".ply")), text);
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(entries().size(), 8U);
}

TEST_F(HttpUploadTest, OfManyWithOneNameOneIsStored) {
  start();
  std::atomic<int> stored{0}, taken{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&, i] {
      RawClient client(port());
      const std::string text(200'000, static_cast<char>('a' + i));
      client.send(head("a.ply", text.size()) + text);
      const int status = client.receive().status;
      stored += status == 201 ? 1 : 0;
      taken += status == 409 ? 1 : 0;
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(stored, 1);
  EXPECT_EQ(taken, 7);
  EXPECT_THAT(entries(), testing::ElementsAre("a.ply"));
  const std::string text = text_of(inbox() / "a.ply");
  EXPECT_EQ(text, std::string(200'000, text[0])) << "it is one of them";
}

TEST_F(HttpUploadTest, AFileOfAnySizeTakesLittleMemory) {
  start();
  const std::uint64_t before = storage::process_usage().peak_resident_bytes;
  RawClient client(port());
  client.send(head("a.ply", 256 * tests::kMiB));
  const std::string piece(tests::kMiB, 'x');
  for (int i = 0; i < 256; ++i)
    client.send(piece);
  EXPECT_EQ(client.receive().status, 201);
  EXPECT_EQ(fs::file_size(inbox() / "a.ply"), 256 * tests::kMiB);
  EXPECT_LT(storage::process_usage().peak_resident_bytes - before, 32 * tests::kMiB);
}

TEST_F(HttpUploadTest, AFullDiskIsTold) {
  files_.limit_writes(100'000);
  start();
  RawClient client(port());
  client.send(head("a.ply", 200'000) + std::string(200'000, 'x'));
  EXPECT_EQ(client.receive().status, 507);
  EXPECT_THAT(entries(), IsEmpty());
}

TEST_F(HttpUploadTest, StoppingWaitsForNoSenderThatNeverPauses) {
  start();
  std::atomic<bool> is_over = false;
  std::thread sender([&] {
    const RawClient client(port());
    client.send(head("a.ply", std::size_t{1} << 30));
    while (!is_over) {  // to its end it takes two minutes
      client.send(std::string(50'000, 'x'));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  wait_for_part(1'000'000);
  const auto begin = std::chrono::steady_clock::now();
  server_->stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  is_over = true;
  sender.join();
  EXPECT_THAT(entries(), IsEmpty());
}

TEST_F(HttpUploadTest, StoppingEndsWhatIsUnderWay) {
  ServerOptions options;
  options.limits.stall = kAnHour;
  start(options);
  RawClient client(port());
  client.send(head("a.ply", 1000) + "half");
  wait_for_part(0);
  server_->stop();
  EXPECT_THAT(entries(), IsEmpty());
}

}  // namespace
}  // namespace meshhier::server
