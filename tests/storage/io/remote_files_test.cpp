#include "storage/io/remote_files.h"

#include "base/error.h"
#include "storage/io/web_address.h"
#include "tests/support/error_message.h"
#include "tests/support/http_host.h"
#include "tests/support/wait_until.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using tests::answer_status;
using tests::answer_whole;
using tests::answer_with;
using tests::HostReply;
using tests::HostRequest;
using tests::HttpHost;

constexpr std::size_t kFetchedBlock = 65536;

std::string some_bytes(std::size_t count) {
  std::mt19937 next(7);
  std::string bytes(count, 0);
  std::ranges::generate(bytes, [&] { return static_cast<char>(next()); });
  return bytes;
}

std::string read(const File& file, std::uint64_t offset, std::size_t count) {
  std::string bytes(count, 0);
  bytes.resize(file.read_at(offset, std::as_writable_bytes(std::span(bytes))));
  return bytes;
}

class RemoteFilesTest : public testing::Test {
 protected:
  RemoteFiles& open(HttpHost::Answer answer, const std::string& name = "a.3tz",
                    HttpOptions options = {}) {
    host_ = std::make_unique<HttpHost>(std::move(answer));
    return reopen(host_->url() + name, std::move(options));
  }
  RemoteFiles& reopen(const std::string& address, HttpOptions options = {}) {
    options.first_wait = std::chrono::milliseconds(1);
    const fs::path scratch =
        fs::path(testing::TempDir()) / fmt::format("meshhier-remote-files-test-{}", getpid());
    remote_ = std::make_unique<RemoteFiles>(*local_, address, scratch, std::move(options),
                                            [this] { check_(); });
    EXPECT_FALSE(local_->exists(scratch));
    return *remote_;
  }
  /// Returns the error of opening it, or of reading at that place.
  std::string problem(RemoteFiles& remote, std::uint64_t offset = 0) {
    return tests::error_message(ErrorCode::io, [&] {
      std::array<std::byte, 100> some{};
      remote.open(remote.root())->read_exact(offset, some);
    });
  }

  std::function<void()> check_ = [] {};
  std::unique_ptr<FileSystem> local_ = make_posix_file_system();
  std::unique_ptr<HttpHost> host_;
  std::unique_ptr<RemoteFiles> remote_;
  std::string content_ = some_bytes(1'000'000);
};

TEST_F(RemoteFilesTest, PartsAreThoseOfTheFileAndAreFetchedOnce) {
  RemoteFiles& remote =
      open([&](const HostRequest& request) { return answer_with(request, content_); });
  const auto file = remote.open(remote.root());
  EXPECT_EQ(file->size(), content_.size());
  std::mt19937 next(3);
  for (int i = 0; i < 300; ++i) {
    const std::size_t offset = next() % (content_.size() + 10);
    const std::size_t count = next() % 5 == 0 ? next() % 300'000 : next() % 300;
    ASSERT_EQ(read(*file, offset, count),
              offset < content_.size() ? content_.substr(offset, count) : "")
        << offset << ' ' << count;
  }
  EXPECT_EQ(read(*file, 0, content_.size()), content_);
  EXPECT_LT(remote.counters().bytes, content_.size() + 40 * kFetchedBlock);
  const std::size_t requests = host_->requests();
  EXPECT_EQ(read(*remote.open(remote.root()), 0, content_.size()), content_);
  EXPECT_EQ(host_->requests(), requests);
}

TEST_F(RemoteFilesTest, WhatIsAnnouncedIsFetchedSeveralAtATime) {
  std::atomic<int> asked = 0;
  RemoteFiles& remote = open([&](const HostRequest& request) {
    if (request.range->first > 0) {
      ++asked;
      tests::wait_until([&] { return asked >= 3; });  // nothing is answered before
    }
    return answer_with(request, content_);
  });
  const auto file = remote.open(remote.root());
  std::vector<File::Range> ranges;
  for (std::uint64_t at = kFetchedBlock; at + 2 * kFetchedBlock < content_.size();
       at += 2 * kFetchedBlock)
    ranges.push_back({at, kFetchedBlock + 100});
  file->will_read(ranges);
  for (const File::Range& range : ranges)
    EXPECT_EQ(read(*file, range.offset, range.bytes), content_.substr(range.offset, range.bytes));
  EXPECT_EQ(host_->requests(), ranges.size() + 1);
}

TEST_F(RemoteFilesTest, FilesOfADirectoryAreOpenedAheadToo) {
  RemoteFiles& remote =
      open([&](const HostRequest& request) { return answer_with(request, request.target); },
           "some/a.hier");
  EXPECT_EQ(remote.kind(remote.root()), FileKind::directory);
  EXPECT_FALSE(remote.can_list(remote.root()));
  EXPECT_THROW(remote.list(remote.root()), Error);
  std::vector<fs::path> names;
  for (int i = 0; i < 20; ++i)
    names.push_back(remote.root() / fmt::format("tiles/{}.glb", i));
  remote.will_read(names);
  for (const fs::path& name : names) {
    const std::string expected = "/some/a.hier/tiles/" + name.filename().string();
    EXPECT_EQ(read(*remote.open(name), 0, 100), expected);
  }
  EXPECT_EQ(host_->requests(), 20U);
}

TEST_F(RemoteFilesTest, SecretsGoToTheHostAndIntoNoMessage) {
  open([](const HostRequest&) { return answer_status(403); });
  std::string address = host_->url() + "sub/a.3tz?signature=hush#there";
  address.insert(address.find("//") + 2, "somebody:quiet@");
  RemoteFiles& remote = reopen(address, {.headers = {"X-Key: silence"}});
  EXPECT_EQ(remote.root(), fs::path(host_->url() + "sub/a.3tz"));
  const std::string said = problem(remote);
  EXPECT_THAT(said, HasSubstr("the host does not let everybody read it (403)"));
  for (const char* secret : {"hush", "quiet", "silence", "somebody"})
    EXPECT_THAT(said, Not(HasSubstr(secret)));
  const std::string head = host_->heads().back();
  EXPECT_THAT(head, HasSubstr("GET /sub/a.3tz?signature=hush HTTP"));
  EXPECT_THAT(head, HasSubstr("X-Key: silence\r\n"));
  EXPECT_THAT(head, HasSubstr("Authorization: Basic "));
}

TEST_F(RemoteFilesTest, WhatMayPassIsTriedAgain) {
  std::atomic<int> tries = 0;
  RemoteFiles& remote = open([&](const HostRequest& request) -> HostReply {
    switch (++tries) {
      case 1:
        return answer_status(503, "Retry-After: 0\r\n");
      case 2:
        return {"", false};  // hung up
      case 3: {              // broke off
        HostReply reply = answer_with(request, content_);
        reply.bytes.resize(reply.bytes.size() - 1000);
        return {reply.bytes, false};
      }
      default:
        return answer_with(request, content_);
    }
  });
  EXPECT_EQ(read(*remote.open(remote.root()), 0, 60'000), content_.substr(0, 60'000));
  EXPECT_EQ(tries, 4);
  EXPECT_THAT(host_->heads().back(), HasSubstr("Range: bytes=64536-65535"));
}

TEST_F(RemoteFilesTest, WhatDoesNotPassIsToldAfterFiveTimes) {
  RemoteFiles& remote = open([](const HostRequest&) { return answer_status(502); });
  EXPECT_THAT(problem(remote), HasSubstr("a.3tz: the host answered 502, 5 times"));
  EXPECT_EQ(host_->requests(), 5U);
}

TEST_F(RemoteFilesTest, WhatIsNotThereIsToldAtOnce) {
  RemoteFiles& remote = open([](const HostRequest&) { return answer_status(404); });
  EXPECT_THAT(problem(remote), HasSubstr("a.3tz: there is no such file on the host"));
  EXPECT_EQ(host_->requests(), 1U);
  EXPECT_FALSE(remote.exists(remote.root() / "tileset.json"));
}

TEST_F(RemoteFilesTest, NobodyThereIsTold) {
  open([](const HostRequest&) { return answer_status(404); });
  const std::string address = host_->url() + "a.3tz";
  host_.reset();
  EXPECT_THAT(problem(reopen(address)), HasSubstr("a.3tz: Couldn't connect to server, 5 times"));
}

TEST_F(RemoteFilesTest, AHostThatTakesARequestAndSaysNothingIsAskedAgain) {
  std::atomic<int> asked = 0;
  HttpOptions options;
  options.silence = std::chrono::seconds(1);
  const auto answer = [&](const HostRequest& request) {
    if (++asked == 1)
      std::this_thread::sleep_for(std::chrono::seconds(4));
    return answer_with(request, content_);
  };
  RemoteFiles& remote = open(answer, "a.3tz", options);
  EXPECT_EQ(remote.open(remote.root())->size(), content_.size());
  EXPECT_GE(asked, 2) << "or more, where this machine keeps silent for a second";
  host_.reset();  // it answers the first time still, with what is here
}

TEST_F(RemoteFilesTest, ATextThatIsOpenedAgainIsAskedForAgain) {
  std::string text = "{}";
  RemoteFiles& remote =
      open([&](const HostRequest& request) { return answer_with(request, text); }, "a.hier");
  const fs::path path = remote.root() / "hierarchy.json";
  EXPECT_TRUE(remote.exists(path));
  EXPECT_EQ(read(*remote.open(path), 0, 100), "{}");
  EXPECT_EQ(host_->requests(), 1U);
  text = "{ }";
  EXPECT_EQ(read(*remote.open(path), 0, 100), "{ }");
  EXPECT_EQ(host_->requests(), 2U);
}

TEST_F(RemoteFilesTest, AHostWithoutRangesSendsSmallFilesWhole) {
  RemoteFiles& remote =
      open([&](const HostRequest& request) { return answer_whole(request, content_); });
  const auto file = remote.open(remote.root());
  EXPECT_EQ(file->size(), content_.size());
  EXPECT_EQ(read(*file, 500'000, 400'000), content_.substr(500'000, 400'000));
  EXPECT_EQ(host_->requests(), 1U);
}

TEST_F(RemoteFilesTest, APartThatFallsSilentGoesOnWhereItWas) {
  std::atomic<int> tries = 0;
  HttpOptions options;
  options.silence = std::chrono::seconds(1);
  const auto answer = [&](const HostRequest& request) {
    HostReply reply = answer_with(request, content_);
    if (++tries == 1)
      reply.bytes.resize(reply.bytes.size() - 1000);
    return reply;
  };
  RemoteFiles& remote = open(answer, "a.3tz", options);
  EXPECT_EQ(read(*remote.open(remote.root()), 0, 60'000), content_.substr(0, 60'000));
  EXPECT_GE(tries, 2) << "or more, where this machine keeps silent for a second";
  EXPECT_THAT(host_->heads().back(), HasSubstr("Range: bytes=64536-65535"));
}

TEST_F(RemoteFilesTest, AWholeFileThatBreaksOffBeginsAgain) {
  std::atomic<int> tries = 0;
  RemoteFiles& remote = open([&](const HostRequest& request) -> HostReply {
    HostReply reply = answer_whole(request, content_);
    if (++tries > 1)
      return reply;
    reply.bytes.resize(reply.bytes.size() - 1000);
    return {reply.bytes, false};
  });
  const auto file = remote.open(remote.root());
  EXPECT_EQ(file->size(), content_.size());
  EXPECT_EQ(read(*file, 0, content_.size() + 10), content_);
  EXPECT_EQ(tries, 2);
  EXPECT_THAT(host_->heads().back(), HasSubstr("Range: bytes=0-65535"));
}

TEST_F(RemoteFilesTest, APartComesBehindAWholeFileThatBrokeOff) {
  std::atomic<int> tries = 0;
  RemoteFiles& remote = open([&](const HostRequest& request) -> HostReply {
    if (++tries > 1)
      return answer_with(request, content_);
    HostReply reply = answer_whole(request, content_);
    reply.bytes.resize(reply.bytes.size() - 1000);
    return {reply.bytes, false};
  });
  const auto file = remote.open(remote.root());
  EXPECT_EQ(file->size(), content_.size());
  EXPECT_EQ(read(*file, 0, content_.size() + 10), content_);
}

TEST_F(RemoteFilesTest, AHostWithoutRangesIsToldOfALargeFile) {
  RemoteFiles& remote = open([&](const HostRequest&) -> HostReply {
    std::string reply = "HTTP/1.1 200 OK\r\nContent-Length: 99999999999\r\n\r\n";
    reply.resize(HttpClient::kMostWhole + 10'000);
    return {reply, false};
  });
  EXPECT_THAT(problem(remote), HasSubstr("no parts of them (HTTP ranges)"));
}

TEST_F(RemoteFilesTest, AFileThatBecomesAnotherOneIsTold) {
  std::atomic<int> version = 1;
  RemoteFiles& remote = open([&](const HostRequest& request) {
    return answer_with(request, content_, fmt::format("ETag: \"{}\"\r\n", version));
  });
  const auto file = remote.open(remote.root());
  EXPECT_EQ(read(*file, 200'000, 10), content_.substr(200'000, 10));
  version = 2;
  EXPECT_EQ(read(*file, 200'010, 10), content_.substr(200'010, 10));  // is there already
  try {
    read(*file, 700'000, 10);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.3tz: it has become another file on the host"));
  }
}

TEST_F(RemoteFilesTest, LiesAreTold) {
  const auto with = [&](const std::string& reply) {
    return [reply](const HostRequest&) -> HostReply { return {reply, false}; };
  };
  const std::string part = "HTTP/1.1 206 Partial Content\r\n";
  const auto say = [&](const std::string& range, std::size_t bytes) {
    return part +
           fmt::format("Content-Range: bytes {}\r\nContent-Length: {}\r\n\r\n", range, bytes) +
           std::string(bytes, 'x');
  };
  EXPECT_THAT(problem(open(with(say("5-104/1000", 100)))), HasSubstr("another part"));
  EXPECT_THAT(problem(open(with(say("0-65535/100", 65536)))), HasSubstr("another length"));
  EXPECT_THAT(problem(open(with(say("0-99/1000", 100)))), HasSubstr("another length"));
  EXPECT_THAT(problem(open(with(say("0-99999/100000", 100'000)))), HasSubstr("more than the part"));
  EXPECT_THAT(problem(open(with(say("0-65535/*", 65536)))), HasSubstr("how long it is"));
  for (const char* length :
       {"9223372036854775808", "18446744073709551616", "99999999999999999999999"}) {
    EXPECT_THAT(problem(open(with(say(fmt::format("0-99/{}", length), 100)))),
                HasSubstr(fmt::format("says that it has {} bytes, as no file has", length)));
    EXPECT_THAT(
        problem(open(with(fmt::format("HTTP/1.1 200 OK\r\nContent-Length: {}\r\n\r\nx", length)))),
        HasSubstr("as no file has"));
  }
  for (const std::string& header :
       {"X: " + std::string(200'000, 'x') + "\r\n", std::string(), std::string(500'000, 'y')}) {
    std::string reply = part + header;
    for (int i = 0; i < (header.empty() ? 2000 : 0); ++i)
      reply += fmt::format("X-{}: {}\r\n", i, std::string(100, 'x'));
    EXPECT_THAT(problem(open(with(reply + "Content-Range: bytes 0-99/100\r\n\r\n"))),
                HasSubstr("header of the host's answer has more than 65536 bytes"));
  }
  for (const std::size_t bytes : {30U, 70'000U}) {
    EXPECT_THAT(
        problem(open(with(part + "Content-Encoding: gzip\r\nContent-Range: bytes 0-99/100\r\n\r\n" +
                          std::string(bytes, 'x')))),
        HasSubstr("sends it packed (Content-Encoding)"));
  }
  EXPECT_THAT(problem(open(with("HTTP/1.1 204 None\r\n\r\n"))), HasSubstr("answered 204"));
  EXPECT_THAT(problem(open(with("no http at all"))), HasSubstr("a.3tz: "));
  EXPECT_THAT(problem(open(with("HTTP/1.1 302 Found\r\nLocation: file:///etc/passwd\r\n\r\n"))),
              HasSubstr("a.3tz: "));
}

TEST_F(RemoteFilesTest, ATileThatIsStoredPackedComesAsItIs) {
  RemoteFiles& remote = open(
      [&](const HostRequest& request) {
        return answer_with(request, content_, "ETag: \"1\"\r\nContent-Encoding: gzip\r\n");
      },
      "a.hier");
  EXPECT_EQ(read(*remote.open(remote.root() / "tiles/00/000000.glb"), 0, 100),
            content_.substr(0, 100));
}

TEST_F(RemoteFilesTest, RedirectsAreFollowed) {
  RemoteFiles& remote = open([&](const HostRequest& request) -> HostReply {
    if (request.target == "/a.3tz")
      return {"HTTP/1.1 302 Found\r\nETag: \"none\"\r\nContent-Length: 0\r\nLocation: /b\r\n\r\n"};
    return answer_with(request, content_);
  });
  EXPECT_EQ(read(*remote.open(remote.root()), 300'000, 100'000), content_.substr(300'000, 100'000));
}

TEST_F(RemoteFilesTest, SecretsStayAtTheirHostWhateverItRedirectsTo) {
  const HttpHost other([&](const HostRequest& request) -> HostReply {
    if (request.target == "/b")
      return {"HTTP/1.1 307 Go\r\nContent-Length: 0\r\nLocation: " + host_->url() + "c\r\n\r\n"};
    return answer_with(request, content_);
  });
  host_ = std::make_unique<HttpHost>([&](const HostRequest& request) -> HostReply {
    if (request.target == "/a.3tz")
      return {"HTTP/1.1 302 Go\r\nContent-Length: 0\r\nLocation: " + other.url() + "b\r\n\r\n"};
    return answer_with(request, content_);
  });
  std::string address = host_->url() + "a.3tz";
  address.insert(address.find("//") + 2, "me:word@");
  EXPECT_EQ(problem(reopen(address, {.headers = {"PRIVATE-TOKEN: 123"}})), "");
  ASSERT_EQ(other.requests(), 1U);
  EXPECT_THAT(other.heads()[0], Not(HasSubstr("PRIVATE-TOKEN")));
  EXPECT_THAT(other.heads()[0], Not(HasSubstr("Authorization")));
  ASSERT_EQ(host_->requests(), 2U);
  for (const std::string& head : host_->heads()) {
    EXPECT_THAT(head, HasSubstr("PRIVATE-TOKEN: 123"));
    EXPECT_THAT(head, HasSubstr("Authorization: Basic bWU6d29yZA=="));
  }
}

TEST_F(RemoteFilesTest, RedirectsWithoutEndEnd) {
  EXPECT_THAT(problem(open([&](const HostRequest& request) -> HostReply {
                return {"HTTP/1.1 302 Go\r\nContent-Length: 0\r\nLocation: " + request.target +
                        "x\r\n\r\n"};
              })),
              HasSubstr("a.3tz: "));
  EXPECT_EQ(host_->requests(), 11U);
}

TEST_F(RemoteFilesTest, WaitsEndWhenTheyAreNotWanted) {
  RemoteFiles& remote = open([](const HostRequest&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return answer_status(503, "Retry-After: 60\r\n");
  });
  std::atomic<int> checks = 0;
  check_ = [&] {
    if (++checks > 3)
      throw Error(ErrorCode::interrupted, "enough");
  };
  const auto began = std::chrono::steady_clock::now();
  EXPECT_THROW(remote.open(remote.root()), Error);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

TEST_F(RemoteFilesTest, WhatIsFetchedAheadAndNotAskedForHoldsNobodyUp) {
  RemoteFiles& remote = open([&](const HostRequest& request) -> HostReply {
    HostReply reply = answer_with(request, content_);
    if (request.range->first > 0)
      reply.bytes.resize(reply.bytes.size() - 1000);  // and then nothing
    return reply;
  });
  remote.open(remote.root())
      ->will_read(std::vector<File::Range>{{100'000, 100'000}, {300'000, 100'000}});
  const auto began = std::chrono::steady_clock::now();
  remote_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

TEST_F(RemoteFilesTest, AnEmptyFileIsOne) {
  RemoteFiles& remote = open([](const HostRequest& request) { return answer_with(request, ""); });
  const auto file = remote.open(remote.root());
  EXPECT_EQ(file->size(), 0U);
  EXPECT_EQ(read(*file, 0, 10), "");
}

TEST_F(RemoteFilesTest, AllElseIsOfTheOtherFileSystem) {
  RemoteFiles& remote = open([](const HostRequest&) { return answer_status(404); });
  const fs::path folder = testing::TempDir();
  EXPECT_TRUE(remote.is_directory(folder));
  EXPECT_TRUE(remote.can_list(folder));
  EXPECT_EQ(remote.canonical(folder), local_->canonical(folder));
  EXPECT_EQ(host_->requests(), 0U);
}

TEST(WebAddressTest, IsKnownByItsScheme) {
  for (const char* address : {"http://a/b", "https://a/b.3tz", "HTTPS://a"})
    EXPECT_TRUE(is_web_address(address)) << address;
  for (const char* other : {"a.hier", "http:a", "ftp://a", "/http://a", ""})
    EXPECT_FALSE(is_web_address(other)) << other;
}

TEST(WebAddressTest, HostsAreTheSameBySchemeNameAndPort) {
  for (const char* same : {"https://a/b", "HTTPS://me:word@A:443/c?d", "https://a"})
    EXPECT_TRUE(is_same_host("https://a/b.3tz", same)) << same;
  for (const char* other : {"http://a/b.3tz", "https://b/b.3tz", "https://a:444/b.3tz",
                            "https://a.b/b.3tz", "https://a@b/b.3tz", "a/b.3tz", "https://", ""})
    EXPECT_FALSE(is_same_host("https://a/b.3tz", other)) << other;
  EXPECT_FALSE(is_same_host("", ""));
}

}  // namespace
}  // namespace meshhier::storage
