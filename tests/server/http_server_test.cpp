// The real server, through real sockets.
#include "server/http_server.h"

#include "base/error.h"
#include "server/conditions.h"
#include "server/http_messages.h"
#include "server/site.h"
#include "storage/io/process.h"
#include "tests/server/path_tricks.h"
#include "tests/server/raw_client.h"
#include "tests/server/served_folder.h"
#include "tests/support/sizes.h"
#include "tests/support/wait_until.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <latch>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using std::string_literals::operator""s;
using testing::Not;
using tests::RawClient;
using tests::RawReply;
using tests::text_of;

class HttpServerTest : public testing::Test {
 protected:
  void start(ServerOptions options = {}) {
    options.port = 0;
    const auto unheard = [](const std::string&) {};
    hierarchies_.emplace(storage::open_folder(folder_.models()), unheard);
    site_.emplace(SiteOptions{.viewer = storage::open_folder(folder_.viewer())}, *hierarchies_,
                  Site::Jobs(), unheard);
    server_.emplace(
        options, [this](const Request& request) { return site_->answer(request); },
        [this](const Served& served) {
          const std::lock_guard lock(mutex_);
          log_.push_back(served);
        });
    server_->start();
  }
  std::uint16_t port() const { return server_->port(); }

  /// assets/large.bin, of zeros.
  void make_large(std::uint64_t bytes) const {
    const fs::path large = folder_.viewer() / "assets/large.bin";
    tests::write_text(large, "");
    fs::resize_file(large, bytes);
  }

  tests::ServedFolder folder_;
  std::optional<Hierarchies> hierarchies_;
  std::optional<Site> site_;
  std::mutex mutex_;
  std::vector<Served> log_;
  std::optional<HttpServer> server_;
};

TEST_F(HttpServerTest, AConnectionServesManyRequests) {
  start();
  RawClient client(port());
  const std::string tile = text_of(folder_.models() / "plain.hier/tiles/00/000000.glb");
  for (int i = 0; i < 3; ++i) {
    const RawReply reply = client.get("/models/plain.hier/tiles/00/000000.glb");
    EXPECT_EQ(reply.status, 200);
    EXPECT_EQ(reply.body, tile);
    EXPECT_EQ(reply.headers.at("content-type"), "model/gltf-binary");
  }
  EXPECT_EQ(client.get("/models.json").status, 200);
}

TEST_F(HttpServerTest, RequestsMayBeSentAhead) {
  start();
  RawClient client(port());
  const std::string request =
      "GET /models/plain.hier/tiles.bin HTTP/1.1\r\nHost: localhost\r\n\r\n";
  client.send(request + request + request);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(client.receive().body, text_of(folder_.models() / "plain.hier/tiles.bin"));
}

TEST_F(HttpServerTest, HeadIsTheHeadOfGet) {
  start();
  RawClient client(port());
  RawReply whole = client.get("/models/plain.hier/tiles.bin");
  client.send("HEAD /models/plain.hier/tiles.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const RawReply head = client.receive(true);
  EXPECT_EQ(head.status, 200);
  whole.headers["date"] = head.headers.at("date");
  EXPECT_EQ(head.headers, whole.headers);
  EXPECT_EQ(client.get("/models.json").status, 200) << "no body came behind the head";
}

TEST_F(HttpServerTest, PartsAndWhatIsKnownGoThroughTheWire) {
  start();
  RawClient client(port());
  const std::string target = "/models/plain.hier/tiles.bin";
  const std::string whole = text_of(folder_.models() / "plain.hier/tiles.bin");
  RawReply reply = client.get(target, "Range: bytes=5-9\r\n");
  EXPECT_EQ(reply.status, 206);
  EXPECT_EQ(reply.body, whole.substr(5, 5));
  EXPECT_EQ(reply.headers.at("content-range"), "bytes 5-9/" + std::to_string(whole.size()));
  EXPECT_EQ(reply.headers.at("content-length"), "5");
  EXPECT_EQ(client.get(target, "Range: bytes=999999-\r\n").status, 416);
  reply = client.get(target, "If-None-Match: " + reply.headers.at("etag") + "\r\n");
  EXPECT_EQ(reply.status, 304);
  EXPECT_FALSE(reply.headers.contains("content-length"));
  EXPECT_EQ(client.get(target).body, whole);
}

TEST_F(HttpServerTest, ALongRangeHeaderCostsNothing) {
  start();
  RawClient client(port());
  std::string ranges = "bytes=0-";
  while (ranges.size() < 8000)
    ranges += ",0-";
  const RawReply reply = client.get("/models/plain.hier/tiles.bin", "Range: " + ranges + "\r\n");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body, text_of(folder_.models() / "plain.hier/tiles.bin"));
}

TEST_F(HttpServerTest, GzipTilesGoOutAsTheyLie) {
  start();
  RawClient client(port());
  const RawReply reply = client.get("/models/sub%20dir/zipped.hier/tiles/00/000000.glb",
                                    "Accept-Encoding: gzip, br\r\n");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.headers.at("content-encoding"), "gzip");
  EXPECT_EQ(reply.body, text_of(folder_.models() / "sub dir/zipped.hier/tiles/00/000000.glb"));
  const RawReply list = client.get("/models.json", "Accept-Encoding: gzip, br\r\n");
  EXPECT_FALSE(list.headers.contains("content-encoding"));
}

TEST_F(HttpServerTest, NoTrickLeadsAnywhere) {
  start();
  for (const std::string& trick : tests::kPathTricks) {
    RawClient client(port());
    const RawReply reply = client.get(trick);
    EXPECT_TRUE(reply.status == 404 || reply.status == 400) << trick << " gave " << reply.status;
    EXPECT_THAT(reply.body, Not(HasSubstr("not for you"))) << trick;
  }
}

TEST_F(HttpServerTest, WhatIsNoRequestIsRefused) {
  start();
  for (const std::string& bytes :
       {"GET\r\n\r\n"s, "GET /models.json\r\n\r\n"s, "GET /models.json HTTP/1.1\r\n\r\n"s,
        "GET /models.json HTTP/1.1\r\nHost: local host\r\n\r\n"s,
        "\r\n\r\nGET /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n"s,
        "GET  /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n"s,
        "GET /models.json  HTTP/1.1\r\nHost: localhost\r\n\r\n"s,
        "GET /models.json HTTP/1.1 \r\nHost: localhost\r\n\r\n"s,
        "GET /\0 HTTP/1.1\r\nHost: localhost\r\n\r\n"s, "\x16\x03\x01\x02\r\n\r\n"s,
        "GET / HTTP/1.1\nHost: localhost\n\n\r\n\r\n"s,
        "GET /models.json HTTP/1.1\r\nHost: localhost\nRange: bytes=0-\r\n\r\n"s}) {
    RawClient client(port());
    client.send(bytes);
    const RawReply reply = client.receive();
    EXPECT_EQ(reply.status, 400) << bytes;
    EXPECT_EQ(reply.headers.at("connection"), "close") << bytes;
    EXPECT_THAT(reply.body, HasSubstr(".\n")) << "it says why: " << bytes;
    EXPECT_TRUE(reply.headers.contains("date")) << bytes;
    EXPECT_TRUE(client.is_closed()) << bytes;
  }
}

TEST_F(HttpServerTest, WhatIsOfAnotherHttpIsToldSo) {
  start();
  for (const auto& [line, status] : std::vector<std::pair<std::string, int>>{
           {"BREW / HTTP/1.1", 501}, {"PROPFIND / HTTP/1.1", 501}, {"GET / HTTP/9.9", 505}}) {
    RawClient client(port());
    client.send(line + "\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(client.receive().status, status) << line;
    EXPECT_TRUE(client.is_closed()) << line;
  }
}

TEST_F(HttpServerTest, AnEmptyLineBeforeARequestIsNone) {
  start();
  RawClient client(port());
  const std::string request = "GET /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n";
  client.send("\r\n" + request + "\r\n" + request + "\r\n");
  EXPECT_EQ(client.receive().status, 200);
  EXPECT_EQ(client.receive().status, 200);
  EXPECT_EQ(client.get("/models.json").status, 200);
}

TEST_F(HttpServerTest, RepliesSayWhenTheyWereMade) {
  EXPECT_EQ(http_date({}), "Thu, 01 Jan 1970 00:00:00 GMT");
  start();
  RawClient client(port());
  for (const char* target : {"/models.json", "/models/plain.hier/tiles.bin", "/none"})
    EXPECT_THAT(client.get(target).headers.at("date"), testing::EndsWith(" GMT")) << target;
}

TEST_F(HttpServerTest, AListMayBeInSeveralHeaders) {
  start();
  RawClient client(port());
  const std::string tag = client.get("/models.json").headers.at("etag");
  EXPECT_EQ(
      client.get("/models.json", "If-None-Match: \"a\"\r\nIf-None-Match: " + tag + "\r\n").status,
      304);
  EXPECT_EQ(client
                .get("/models/sub%20dir/zipped.hier/tiles/00/000000.glb",
                     "Accept-Encoding: br\r\nAccept-Encoding: identity\r\n")
                .status,
            406);
}

TEST_F(HttpServerTest, WhoClosesAmongOtherWordsIsHeard) {
  start();
  RawClient client(port());
  EXPECT_EQ(client.get("/models.json", "Connection: x, Close\r\n").headers.at("connection"),
            "close");
  EXPECT_TRUE(client.is_closed());
}

TEST_F(HttpServerTest, NoRequestHidesInAnother) {
  start();
  const std::string hidden = "GET /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n";
  for (const char* lines :
       {"Transfer-Encoding : chunked", "Transfer-Encoding:\r\n chunked", "X: a\r\n\tb",
        "Content-Length: 5\r\nContent-Length: 5", "Content-Length: 5\r\nTransfer-Encoding: chunked",
        "Content-Length: 5, 5", "Content-Length: -1", "Transfer-Encoding: gzip, chunked",
        "Host: localhost", "Host: evil.example", ": nameless", "A B: c", "nothing"}) {
    RawClient client(port());
    client.send("GET /models.json HTTP/1.1\r\nHost: localhost\r\n" + std::string(lines) +
                "\r\n\r\n" + hidden);
    EXPECT_EQ(client.receive().status, 400) << lines;
    EXPECT_TRUE(client.is_closed()) << lines;
  }
}

TEST_F(HttpServerTest, HostsOfOthersAreRefused) {
  start();
  for (const char* lines : {"Host: evil.example\r\n", "Host:\r\n"}) {
    RawClient client(port());
    client.send("GET /models.json HTTP/1.1\r\n" + std::string(lines) + "\r\n");
    EXPECT_EQ(client.receive().status, 421) << lines;
  }
}

TEST_F(HttpServerTest, AWholeAddressIsAskedAsItsPathUnderItsOwnHost) {
  start();
  const auto status_of = [&](const std::string& target, const std::string& rest) {
    RawClient client(port());
    client.send("GET " + target + " HTTP/1." + rest + "\r\n\r\n");
    return client.receive().status;
  };
  for (const char* host : {"localhost", "LOCALHOST:1", "127.0.0.1:8080", "[::1]"}) {
    const std::string address = "http://" + std::string(host);
    EXPECT_EQ(status_of(address + "/models.json?count=1", "1\r\nHost: evil.example"), 200) << host;
    EXPECT_EQ(status_of(address + "/models.json", "0"), 200) << host;
    EXPECT_EQ(status_of(address + "/none", "1\r\nHost: localhost"), 404) << host;
  }
  for (const char* host : {"evil.example", "localhost.evil.example", "127.0.0.1.evil", "a:80"}) {
    const std::string address = "http://" + std::string(host) + "/models.json";
    EXPECT_EQ(status_of(address, "1\r\nHost: localhost"), 421) << host;
    EXPECT_EQ(status_of(address, "0"), 421) << host << ": health checks name none";
  }
  EXPECT_EQ(status_of("http://localhost@evil.example/models.json", "1\r\nHost: localhost"), 400);
  EXPECT_EQ(status_of("ftp://localhost/models.json", "1\r\nHost: localhost"), 400);
}

TEST_F(HttpServerTest, TwoHostsAreRefusedWhateverTheVersion) {
  start();
  for (const char* version : {"0", "1"}) {
    RawClient client(port());
    client.send("GET /models.json HTTP/1." + std::string(version) +
                "\r\nHost: localhost\r\nHost: evil.example\r\n\r\n");
    EXPECT_EQ(client.receive().status, 400) << version;
    EXPECT_TRUE(client.is_closed()) << version;
  }
}

TEST_F(HttpServerTest, HealthChecksOfHttp10NameNoHost) {
  start();
  RawClient client(port());
  client.send("GET /models.json HTTP/1.0\r\n\r\n");
  EXPECT_EQ(client.receive().status, 200);
}

TEST_F(HttpServerTest, AHeadWithoutEndIsRefused) {
  start();
  for (const auto& [begin, status] :
       std::vector<std::pair<std::string, int>>{{"GET /", 414}, {"GET / HTTP/1.1\r\nX: ", 431}}) {
    RawClient client(port());
    client.send(begin + std::string(20'000, 'a'));
    EXPECT_EQ(client.receive().status, status);
    EXPECT_TRUE(client.is_closed());
  }
  std::string many = "GET /models.json HTTP/1.1\r\nHost: localhost\r\n";
  while (many.size() < 20'000)
    many += "a: b\r\n";
  RawClient client(port());
  client.send(many);
  EXPECT_EQ(client.receive().status, 431);
}

TEST_F(HttpServerTest, BodiesAreNotRead) {
  start();
  for (const char* method : {"POST", "PUT", "GET"}) {
    RawClient client(port());
    client.send(std::string(method) +
                " /models.json HTTP/1.1\r\nHost: localhost\r\nContent-Length: 44\r\n\r\n"
                "GET /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const RawReply reply = client.receive();
    EXPECT_EQ(reply.status, std::string(method) == "GET" ? 413 : 405);
    EXPECT_EQ(reply.headers.at("connection"), "close");
    EXPECT_TRUE(client.is_closed()) << "the body was taken for a request";
  }
}

/// No test takes so long: what ends sooner was not ended by the clock.
constexpr std::chrono::hours kForever{1};

/// Clients and server are one process here.
void allow_open_files(rlim_t count) {
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = std::max(limit.rlim_cur, std::min(limit.rlim_max, count));
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

TEST_F(HttpServerTest, AThousandRequestsAtOnceAreAllAnswered) {
  allow_open_files(2048);
  ServerOptions options;  // the clients wait for each other
  options.limits.idle = options.limits.patience = options.limits.head = kForever;
  start(options);
  const std::vector<std::string> names{"tiles.bin", "hierarchy.json", "outline.glb",
                                       "tiles/00/000000.glb", "tiles/01/000000.glb"};
  std::vector<std::string> contents;
  for (const std::string& name : names)
    contents.push_back(text_of(folder_.models() / "plain.hier" / name));
  constexpr std::size_t kClients = 1000;
  std::atomic<std::size_t> right{0};
  std::latch connected(kClients);
  const std::uint64_t before = storage::process_usage().peak_resident_bytes;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < kClients; ++i) {
    threads.emplace_back([&, i] {
      const std::size_t which = i % names.size();
      std::optional<RawClient> client;
      try {
        client.emplace(port());
      } catch (const std::exception&) {  // is missed below
      }
      connected.arrive_and_wait();
      const RawReply reply =
          client ? client->get("/models/plain.hier/" + names[which]) : RawReply();
      right += reply.status == 200 && reply.body == contents[which] ? 1 : 0;
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(right, kClients);
  // 64 threads with 64 KiB each, and the 1000 of this test.
  EXPECT_LT(storage::process_usage().peak_resident_bytes - before, 150 * tests::kMiB);
}

TEST_F(HttpServerTest, AFileOfAnySizeTakesLittleMemory) {
  make_large(256 * tests::kMiB);
  start();
  const std::uint64_t before = storage::process_usage().peak_resident_bytes;
  RawClient client(port(), 4096);  // takes it slowly enough to see it held
  client.send("GET /assets/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  RawClient other(port());
  EXPECT_EQ(other.get("/assets/large.bin", "Range: bytes=268435455-\r\n").body,
            std::string(1, '\0'));
  std::vector<std::unique_ptr<RawClient>> many;
  for (int i = 0; i < 32; ++i) {
    many.push_back(std::make_unique<RawClient>(port(), 4096));
    many.back()->send("GET /assets/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  EXPECT_EQ(other.get("/models.json").status, 200);
  EXPECT_LT(storage::process_usage().peak_resident_bytes - before, 64 * tests::kMiB);
}

/// Clients that have begun a request and say no more.
std::vector<std::unique_ptr<RawClient>> slow_clients(std::size_t count, std::uint16_t port) {
  std::vector<std::unique_ptr<RawClient>> clients;
  for (std::size_t i = 0; i < count; ++i) {
    clients.push_back(std::make_unique<RawClient>(port));
    clients.back()->send(i % 2 == 0 ? "GET /models.json HT" : "");
  }
  return clients;
}

TEST_F(HttpServerTest, WhoIsSlowToAskHoldsNoThread) {
  ServerOptions options;
  options.threads = 4;
  options.limits.idle = options.limits.patience = options.limits.head = kForever;
  start(options);
  const auto slow = slow_clients(200, port());
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(RawClient(port()).get("/models.json").status, 200);
  slow[0]->send("TP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(slow[0]->receive().status, 200) << "it was not crowded";
}

TEST_F(HttpServerTest, WhoIsSlowToAskMakesRoomWhenAllPlacesAreTaken) {
  ServerOptions options;
  options.most_connections = 8;
  options.limits.idle = options.limits.head = kForever;
  options.limits.patience = std::chrono::milliseconds(0);
  start(options);
  const auto slow = slow_clients(8, port());
  EXPECT_EQ(RawClient(port()).get("/models.json").status, 200);
  EXPECT_TRUE(slow[0]->is_closed()) << "it was there first";
}

TEST_F(HttpServerTest, AHeadThatDoesNotComeEndsItsConnection) {
  ServerOptions options;
  options.limits.idle = kForever;
  options.limits.head = std::chrono::milliseconds(100);
  start(options);
  RawClient client(port());
  client.send("GET /models.json HT");
  EXPECT_TRUE(client.is_closed());
}

TEST_F(HttpServerTest, OneAddressLeavesAThreadForTheNextOne) {
  make_large(64 * tests::kMiB);
  ServerOptions options;
  options.threads = 4;
  options.limits.stall = kForever;
  start(options);
  std::vector<std::unique_ptr<RawClient>> greedy;
  for (int i = 0; i < 8; ++i) {
    greedy.push_back(std::make_unique<RawClient>(port(), 4096));
    greedy.back()->send("GET /assets/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  tests::wait_until([&] { return server_->traffic().served == 3; });
  EXPECT_EQ(RawClient(port(), 0, "127.0.0.2").get("/models.json").status, 200);
  tests::wait_until([&] { return server_->traffic().served == 3; });
}

TEST_F(HttpServerTest, ClientsThatTakeNothingAreLeft) {
  make_large(64 * tests::kMiB);
  ServerOptions options;
  options.threads = 2;
  options.limits.stall = std::chrono::milliseconds(300);
  start(options);
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 4; ++i) {
    slow.push_back(std::make_unique<RawClient>(port(), 4096));
    slow.back()->send("GET /assets/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  RawClient quick(port());
  EXPECT_EQ(quick.get("/models.json").status, 200);
}

TEST_F(HttpServerTest, AClientThatTakesNothingIsLeftEvenIfNobodyWaits) {
  make_large(64 * tests::kMiB);
  ServerOptions options;
  options.limits.stall = std::chrono::milliseconds(100);
  start(options);
  RawClient slow(port(), 4096);
  slow.send("GET /assets/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  tests::wait_until([&] {
    const std::lock_guard lock(mutex_);
    return log_.size() == 1;
  });
  EXPECT_LT(slow.receive().body.size(), 64 * tests::kMiB);
}

/// Limits by which every client takes too little.
ConnectionLimits impatient() {
  ConnectionLimits limits;
  limits.grace = std::chrono::milliseconds(0);
  limits.least_rate = std::size_t{1} << 60;
  return limits;
}

TEST_F(HttpServerTest, ASlowLineIsServedWhileNobodyWaits) {
  make_large(16 * tests::kMiB);
  start({.limits = impatient()});
  RawClient client(port());
  EXPECT_EQ(client.get("/assets/large.bin").body.size(), 16 * tests::kMiB);
}

TEST_F(HttpServerTest, ClientsThatTakeTooLittleMakeRoomForOthers) {
  make_large(256 * tests::kMiB);
  start({.threads = 1, .limits = impatient()});
  RawClient slow(port(), 4096);
  slow.send("GET /assets/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  RawClient other(port());
  other.send("GET /models.json HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_LT(slow.receive().body.size(), 256 * tests::kMiB);
  EXPECT_EQ(other.receive().status, 200);
}

TEST_F(HttpServerTest, RequestsAtTheSameMomentCloseNoConnection) {
  start({.threads = 4});
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 2; ++i)
    clients.push_back(std::make_unique<RawClient>(port()));
  for (int round = 0; round < 500; ++round) {
    for (const auto& client : clients)
      client->send("GET /models/plain.hier/tiles.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
    for (const auto& client : clients) {
      const RawReply reply = client->receive();
      ASSERT_EQ(reply.status, 200) << "round " << round;
      ASSERT_FALSE(reply.headers.contains("connection")) << "round " << round;
    }
  }
}

TEST_F(HttpServerTest, RequestsAtTheSameMomentAreServedByAsManyThreads) {
  constexpr std::size_t kClients = 48;  // as many as one address gets of 64 threads
  std::atomic<std::size_t> begun{0};
  HttpServer server({.port = 0},
                    [&](const Request&) {
                      ++begun;
                      tests::wait_until([&] { return begun == kClients; });
                      return Reply{.status = 204};
                    },
                    {});
  server.start();
  std::vector<std::unique_ptr<RawClient>> clients;
  for (std::size_t i = 0; i < kClients; ++i)
    clients.push_back(std::make_unique<RawClient>(server.port()));
  for (const auto& client : clients)
    client->send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  for (const auto& client : clients)
    EXPECT_EQ(client->receive().status, 204);
}

TEST_F(HttpServerTest, AnIdleConnectionHoldsNoThread) {
  ServerOptions options;
  options.threads = 1;
  options.limits.idle = kForever;
  start(options);
  RawClient first(port());
  EXPECT_EQ(first.get("/models.json").status, 200);
  RawClient second(port());
  EXPECT_EQ(second.get("/models.json").status, 200);
  EXPECT_EQ(first.get("/models.json").status, 200);
}

TEST_F(HttpServerTest, StoppingEndsWhatIsUnderWay) {
  make_large(256 * tests::kMiB);
  start();
  RawClient idle(port());
  EXPECT_EQ(idle.get("/models.json").status, 200);
  RawClient silent(port());
  RawClient busy(port(), 4096);
  busy.send("GET /assets/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  server_->stop();
  EXPECT_TRUE(idle.is_closed());
  EXPECT_TRUE(silent.is_closed());
  server_->stop();
  EXPECT_THROW(RawClient{port()}, std::runtime_error);
}

/// Ends listening at that port, as if the network had failed.
void break_listening(std::uint16_t port) {
  for (int socket = 3; socket < 1024; ++socket) {
    int listens = 0;
    socklen_t bytes = sizeof(listens);
    sockaddr_in address{};
    socklen_t address_bytes = sizeof(address);
    if (::getsockopt(socket, SOL_SOCKET, SO_ACCEPTCONN, &listens, &bytes) == 0 && listens != 0 &&
        ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &address_bytes) == 0 &&
        address.sin_port == htons(port))
      ::shutdown(socket, SHUT_RDWR);
  }
}

TEST_F(HttpServerTest, TroubleInTheNetworkDoesNotEndIt) {
  start();
  EXPECT_EQ(RawClient(port()).get("/models.json").status, 200);
  break_listening(port());
  int status = 0;
  tests::wait_until([&] {
    try {
      status = RawClient(port()).get("/models.json").status;
    } catch (const std::runtime_error&) {  // nobody listens at this moment
    }
    return status == 200;
  });
  EXPECT_FALSE(server_->is_lost());
  server_->stop();
}

TEST_F(HttpServerTest, ABusyPortIsTold) {
  start();
  try {
    HttpServer({.host = "127.0.0.1", .port = port()}, {}, {});
    FAIL() << "two servers share a port";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_THAT(error.what(), HasSubstr("is in use"));
    EXPECT_THAT(error.what(), HasSubstr("--port 0"));
  }
}

TEST_F(HttpServerTest, AHostThatIsNotHereIsTold) {
  try {
    HttpServer({.host = "192.0.2.1", .port = 0}, {}, {});
    FAIL() << "this machine has an address that nobody has";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("--host must be an address of this machine"));
  }
}

TEST_F(HttpServerTest, EachRequestIsLogged) {
  start();
  {
    RawClient client(port());
    client.get("/models/plain.hier/tiles.bin?x=%41");
    client.get("/nothing");
  }
  server_->stop();
  ASSERT_EQ(log_.size(), 2U);
  EXPECT_EQ(log_[0].client, "127.0.0.1");
  EXPECT_EQ(log_[0].target, "/models/plain.hier/tiles.bin?x=%41");
  EXPECT_EQ(log_[0].status, 200);
  EXPECT_EQ(log_[0].bytes, fs::file_size(folder_.models() / "plain.hier/tiles.bin"));
  EXPECT_EQ(log_[1].status, 404);
}

TEST(ServerUrlTest, UrlsAreThoseABrowserTakes) {
  EXPECT_EQ(url_of("127.0.0.1", 8080), "http://127.0.0.1:8080/");
  EXPECT_EQ(url_of("::1", 1), "http://[::1]:1/");
  EXPECT_EQ(url_of("0.0.0.0", 80), "http://127.0.0.1:80/");
}

TEST(ServerUrlTest, OnTheLoopbackTheUrlNamesTheLoopback) {
  for (const std::string& host :
       {"127.0.0.1"s, "127.0.0.2"s, "127.1"s, "localhost"s, "LOCALHOST"s, "::1"s}) {
    EXPECT_TRUE(is_loopback_host(host)) << host;
    const std::string url = url_of(host, 8080);
    const std::string sent = url.substr(7, url.size() - 8);  // without "http://" and "/"
    EXPECT_TRUE(is_loopback_name(sent)) << sent;
  }
  for (const std::string& host :
       {"0.0.0.0"s, "::"s, "10.0.0.1"s, "127.evil.example"s, "::127.0.0.1"s, ""s})
    EXPECT_FALSE(is_loopback_host(host)) << host;
}

}  // namespace
}  // namespace meshhier::server
