// `meshhier serve` as a process: what it says, how it ends, and that nothing is lost when it is
// killed.
#include "storage/io/file.h"
#include "tests/server/form_text.h"
#include "tests/server/raw_client.h"
#include "tests/server/served_folder.h"
#include "tests/support/meshes.h"
#include "tests/support/wait_until.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace meshhier::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;
using tests::text_of;
using tests::wait_until;

/// A server at work.
class ServeProcess {
 public:
  /// Its output goes to files in `directory`.
  ServeProcess(const fs::path& directory, const std::vector<std::string>& arguments)
      : out_(directory / "serve.out"), messages_(directory / "serve.messages") {
    std::vector<std::string> words{MESHHIER_BINARY, "serve"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words)
      pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages_.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int error =
        posix_spawn(&process_, MESHHIER_BINARY, &actions, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0)
      throw std::runtime_error("cannot start " MESHHIER_BINARY);
  }
  ServeProcess(const ServeProcess&) = delete;
  ServeProcess& operator=(const ServeProcess&) = delete;
  ~ServeProcess() {
    if (process_ > 0)
      end(SIGKILL);
  }

  /// Once it listens.
  std::uint16_t port() {
    const auto url = [&] { return text_of(out_); };
    wait_until([&] { return url().find('\n') != std::string::npos || has_ended(); });
    const std::string text = url();
    return static_cast<std::uint16_t>(std::atoi(text.c_str() + text.rfind(':') + 1));
  }
  /// Its exit code; 1000 + n after death by signal n.
  int end(int signal) {
    if (process_ > 0)
      ::kill(process_, signal);
    return wait();
  }
  int wait() {
    int status = 0;
    while (::waitpid(process_, &status, 0) == -1 && errno == EINTR) {
    }
    process_ = -1;
    return WIFSIGNALED(status) ? 1000 + WTERMSIG(status) : WEXITSTATUS(status);
  }
  std::string out() const { return text_of(out_); }
  std::string messages() const { return text_of(messages_); }

 private:
  bool has_ended() const {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid != 0;
  }

  fs::path out_, messages_;
  pid_t process_ = -1;
};

class ServeTest : public testing::Test {
 protected:
  ServeProcess& serve(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {models().string(), "--port", "0"});
    process_ = std::make_unique<ServeProcess>(folder_.path(), arguments);
    return *process_;
  }
  /// Programs are looked for in `path`, as PATH has it.
  ServeProcess& serve_with_path(const std::string& path,
                                const std::vector<std::string>& arguments) {
    const std::string before = path_of_programs();
    ::setenv("PATH", path.c_str(), 1);
    ServeProcess& process = serve(arguments);
    ::setenv("PATH", before.c_str(), 1);
    return process;
  }
  static std::string path_of_programs() {
    const char* const path = std::getenv("PATH");
    return path == nullptr ? "" : path;
  }
  fs::path models() const { return folder_.models(); }
  fs::path inbox() const { return folder_.path() / "inbox"; }

  void drop(const std::string& name, std::size_t triangles) const {
    fs::create_directories(inbox());
    tests::write_ply(tests::sphere(triangles), folder_.path() / "made.ply");
    fs::rename(folder_.path() / "made.ply", inbox() / name);
  }
  json list() { return json::parse(tests::RawClient(process_->port()).get("/models.json").body); }
  /// The stage that the first job is in.
  std::string stage() {
    const json jobs = list()["jobs"];
    return jobs.empty() ? "" : jobs[0].value("stage", "");
  }

  tests::ServedFolder folder_;
  std::unique_ptr<ServeProcess> process_;
};

TEST_F(ServeTest, ItSaysItsUrlServesAndEndsWithoutAnError) {
  for (const int signal : {SIGINT, SIGTERM}) {
    ServeProcess& process = serve({"--viewer", folder_.viewer().string()});
    tests::RawClient client(process.port());
    EXPECT_EQ(client.get("/").body, text_of(folder_.viewer() / "index.html"));
    EXPECT_EQ(list()["models"].size(), 3U);
    EXPECT_EQ(process.end(signal), 0);
    EXPECT_THAT(process.out(), MatchesRegex("http://127.0.0.1:[0-9]+/\n"));
    EXPECT_THAT(process.messages(), HasSubstr("broken.hier"));
  }
}

TEST_F(ServeTest, WithFewOpenFilesManyAtOnceAreServedOrToldToComeAgain) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{64, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  ServeProcess& server = serve({"--quiet"});
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  const std::uint16_t port = server.port();
  std::atomic<int> served{0}, told{0}, others{0};
  const auto ask = [&](const char* target) {
    try {
      const auto reply =
          tests::RawClient(port).get(target, "Accept-Encoding: gzip\r\nConnection: close\r\n");
      const bool is_told = reply.status == 503 && reply.headers.contains("retry-after") &&
                           reply.headers.at("cache-control") == "no-store";
      ++(reply.status == 200 ? served : is_told ? told : others);
    } catch (const std::exception&) {
      ++others;
    }
  };
  const auto ask_all = [&] {
    for (const char* target : {"/models/plain.hier/hierarchy.json", "/models.json",
                               "/models/packed.3tz/tiles/00/000000.glb"})
      ask(target);
  };
  std::vector<std::thread> clients;
  for (int i = 0; i < 80; ++i)
    clients.emplace_back(ask_all);
  for (std::thread& client : clients)
    client.join();
  EXPECT_EQ(others, 0);
  EXPECT_EQ(served + told, 240);
  EXPECT_GT(served, 200);
}

TEST_F(ServeTest, RequestsAreToldOnlyWhereThatIsAskedFor) {
  ServeProcess& quiet = serve({"--viewer", folder_.viewer().string(), "--quiet"});
  tests::RawClient(quiet.port()).get("/models.json");
  quiet.end(SIGTERM);
  EXPECT_THAT(quiet.messages(), IsEmpty());
  ServeProcess& verbose = serve({"--viewer", folder_.viewer().string(), "--verbose"});
  tests::RawClient(verbose.port()).get("/nothing?x=geheim&build=1f");
  tests::RawClient(verbose.port()).get("/healthz");
  tests::RawClient(verbose.port()).get("/nothing?\x1b[31m");
  verbose.end(SIGTERM);
  EXPECT_THAT(
      verbose.messages(),
      AllOf(HasSubstr("Z info 127.0.0.1 GET /nothing?x=...&build=1f 404"),
            HasSubstr("127.0.0.1 - - 400 "), Not(HasSubstr("geheim")), Not(HasSubstr("healthz"))));
}

TEST_F(ServeTest, IsAskedWhetherItIsWell) {
  const fs::path inbox = folder_.path() / "inbox";
  fs::create_directory(inbox);
  ServeProcess& process = serve({"--inbox", inbox.string(), "--log", "json", "--verbose"});
  const std::string port = std::to_string(process.port());
  const auto ask = [&](const char* what, int code) {
    ServeProcess question(folder_.path() / "viewer",
                          {models().string(), "--port", port, "--check", what});
    EXPECT_EQ(question.wait(), code) << what;
    return question.out() + question.messages();
  };
  EXPECT_EQ(ask("alive", 0), "{\"status\":\"alive\"}\n");
  EXPECT_THAT(ask("ready", 0), StartsWith("{\"status\":\"ready\""));
  fs::remove(inbox);
  EXPECT_THAT(ask("ready", 1), AllOf(HasSubstr("not ready"), HasSubstr("\"inbox\""),
                                     Not(HasSubstr(folder_.path().string()))));
  EXPECT_THAT(ask("alive", 0), HasSubstr("alive"));
  tests::RawClient client(process.port());  // a request counts before the next of its connection
  for (const char* target : {"/healthz", "/nothing", "/nothing", "/readyz"})
    client.get(target);
  EXPECT_THAT(client.get("/metrics").body,
              AllOf(HasSubstr("meshhier_requests_total{method=\"GET\",status=\"4xx\"} 2\n"),
                    ContainsRegex("method=\"GET\",status=\"2xx\"} [1-4]\n"),
                    ContainsRegex("method=\"GET\",status=\"5xx\"} [12]\n"),
                    HasSubstr("meshhier_models 3\n")));
  process.end(SIGTERM);
  EXPECT_THAT(ask("alive", 1), HasSubstr("no answer: does a server run there"));
  std::vector<std::string> levels;
  std::istringstream lines(process.messages());
  for (std::string line; std::getline(lines, line);)
    levels.push_back(json::parse(line).at("level"));
  EXPECT_THAT(levels, testing::Contains("warning")) << process.messages();
}

TEST_F(ServeTest, OtherCommandsReadWhatIsServed) {
  const std::uint16_t port = serve({}).port();
  const auto run = [&](const std::string& words) {
    const fs::path out = folder_.path() / "out";
    const std::string line = "'" MESHHIER_BINARY "' " + words + " > '" + out.string() + "' 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << words << '\n' << text_of(out);
    return text_of(out);
  };
  const std::string local = "'" + (folder_.models() / "packed.3tz").string() + "'";
  for (const char* name : {"packed.3tz", "packed.3tz/"}) {
    const std::string address = fmt::format("http://127.0.0.1:{}/models/{}", port, name);
    EXPECT_THAT(run("inspect " + address), HasSubstr("fetched "));
    EXPECT_THAT(run("verify " + address), HasSubstr("No problem found."));
    const std::string here = (folder_.path() / "here.ply").string();
    const std::string there = (folder_.path() / "there.ply").string();
    run("export " + local + " --level 1 --force -o '" + here + "'");
    EXPECT_THAT(run("export " + address + " --level 1 --force -o '" + there + "'"),
                HasSubstr("fetched "));
    EXPECT_EQ(text_of(there), text_of(here));
    run("preview " + address + " --size 64x64 --force -o '" + here + ".png'");
  }
}

TEST_F(ServeTest, APortThatIsTakenIsAnError) {
  ServeProcess& first = serve({});
  const std::string port = std::to_string(first.port());
  ServeProcess second(folder_.path() / "viewer", {models().string(), "--port", port});
  EXPECT_EQ(second.wait(), 4);
  EXPECT_THAT(second.messages(), AllOf(HasSubstr("port " + port), HasSubstr("--port 0")));
}

TEST_F(ServeTest, WhatIsWrongIsToldBeforeAnythingBegins) {
  const auto fails = [&](const std::vector<std::string>& arguments, int code, const char* message) {
    ServeProcess process(folder_.path(), arguments);
    EXPECT_EQ(process.wait(), code) << message;
    EXPECT_THAT(process.messages(), HasSubstr(message));
    EXPECT_THAT(process.out(), IsEmpty());
  };
  const std::string folder = models().string();
  fails({"nowhere"}, 4, "there is no such directory");
  fails({folder + "/packed.3tz"}, 2, "name the one it lies in");
  fails({folder, "--viewer", folder}, 4, "npm run build");
  fails({folder, "--watch", "nowhere"}, 4, "--watch nowhere");
  fails({folder, "--port", "65536"}, 2, "0 to 65535");
  fails({folder, "--cors", "example.org"}, 2, "expected an origin");
  fails({folder, "--frame", "https://a.example; script-src *"}, 2, "expected an origin");
  fails({folder, "--log", "yaml"}, 2, "json or text");
  fails({folder, "--check", "well"}, 2, "alive or ready");
  fails({folder, "--metrics-token-file", "nowhere"}, 4, "nowhere");
  fails({folder, "--config", "x.json"}, 2, "--watch");
  fails({folder, "--disk-floor", "1GiB"}, 2, "--watch");
  fails({folder, "--settle", "1"}, 2, "--inbox");
  for (const char* seconds : {"nan", "inf", "-1", "86401", "1,5", ""})
    fails({folder, "--watch", folder, "--settle", seconds}, 2, "from 0 to 86400");
  fails({folder, "--inbox", "nowhere"}, 4, "--inbox nowhere");
  fails({folder, "--inbox", folder, "--watch", folder}, 2, "excludes");
  fails({folder, "--watch", folder, "--upload-limit", "1G"}, 2, "requires --inbox");
  fails({folder, "--inbox", folder, "--upload-limit", "much"}, 2, "expected a size");
  fails({folder, "--inbox", folder, "--upload-token-file", "nowhere"}, 4, "nowhere");
  for (const char* token : {"", "short\n", "0123456789 abcdefgh\n", "0123456789abcd\xc3\xa4\n"}) {
    tests::write_text(folder_.path() / "token", token);
    fails({folder, "--inbox", folder, "--upload-token-file", (folder_.path() / "token").string()},
          2, "openssl rand");
  }
  tests::write_text(folder_.path() / "wrong.json", R"({"partition": {"vertces": 5}})");
  fails({folder, "--watch", folder, "--config", (folder_.path() / "wrong.json").string()}, 2,
        "did you mean");
}

TEST_F(ServeTest, ABrowserThatIsMissingDoesNotStopIt) {
  ServeProcess& process =
      serve_with_path(folder_.path(), {"--open", "--viewer", folder_.viewer().string()});
  EXPECT_EQ(tests::RawClient(process.port()).get("/models.json").status, 200);
  EXPECT_EQ(process.end(SIGTERM), 0);
  EXPECT_THAT(process.messages(), HasSubstr("no xdg-open"));
}

TEST_F(ServeTest, WhatIsMissingIsToldToTheQuiet) {
  ServeProcess& process =
      serve_with_path(folder_.path(), {"--open", "--quiet", "--viewer", folder_.viewer().string()});
  tests::RawClient(process.port()).get("/models.json");
  EXPECT_EQ(process.end(SIGTERM), 0);
  EXPECT_THAT(process.messages(),
              MatchesRegex("20[-0-9]*T[0-9:.]*Z warning --open: there is no xdg-open[^\n]*\n"));
}

TEST_F(ServeTest, ABrowserThatHasMuchToSayIsNotHeldUp) {
  const fs::path opener = folder_.path() / "programs/xdg-open";
  const fs::path opened = folder_.path() / "programs/opened";
  fs::create_directory(opener.parent_path());
  tests::write_text(
      opener,
      "#!/bin/sh\nhead -c 200000 /dev/zero >&2 && echo \"$1\" >\"$0.new\" && mv \"$0.new\" '" +
          opened.string() + "'\n");
  fs::permissions(opener, fs::perms::owner_all);
  ServeProcess& process = serve_with_path(opener.parent_path().string() + ':' + path_of_programs(),
                                          {"--open", "--viewer", folder_.viewer().string()});
  wait_until([&] { return fs::exists(opened); });
  EXPECT_EQ(text_of(opened), process.out());
  EXPECT_EQ(process.end(SIGTERM), 0);
  EXPECT_LT(process.messages().size(), 1000U) << "what it said is its own business";
}

TEST_F(ServeTest, WhatIsDroppedAppearsWithItsProgressThenAsAModel) {
  drop("new.ply", 20'000);
  tests::write_text(inbox() / "broken.ply", "ply\n");
  serve({"--watch", inbox().string(), "--settle", "0.1"});
  wait_until([&] { return list()["models"].size() == 4; });
  wait_until([&] { return list()["jobs"].size() == 1; });
  const json job = list()["jobs"][0];
  EXPECT_EQ(job["name"], "broken.ply");
  EXPECT_EQ(job["state"], "failed");
  EXPECT_EQ(tests::RawClient(process_->port()).get("/models/new.hier/tiles/00/000000.glb").status,
            200);
  EXPECT_EQ(process_->end(SIGTERM), 0);
}

/// A mesh as it is sent.
std::string put_request(const std::string& name, const std::string& text,
                        const std::string& more_headers = "") {
  return "PUT /inbox/" + name +
         " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(text.size()) + "\r\n" +
         more_headers + "\r\n" + text;
}

TEST_F(ServeTest, WhatIsSentBecomesAModel) {
  drop("new.ply", 600);
  const std::string mesh = text_of(inbox() / "new.ply");
  fs::remove(inbox() / "new.ply");
  const std::uint16_t port = serve({"--inbox", inbox().string(), "--settle", "0.1"}).port();
  tests::RawClient client(port);
  client.send(put_request("sent.ply", mesh));
  EXPECT_EQ(client.receive().status, 201);
  const std::string form = tests::form_text(
      {{"a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}, {"a.mtl", "newmtl a\n"}});
  tests::RawClient other(port);
  other.send(
      "POST /inbox/house HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data; "
      "boundary=" +
      tests::kBoundary + "\r\nContent-Length: " + std::to_string(form.size()) + "\r\n\r\n" + form);
  EXPECT_EQ(other.receive().status, 201);
  wait_until([&] { return list()["models"].size() == 5 && list()["jobs"].empty(); });
  EXPECT_TRUE(fs::exists(models() / "sent.hier"));
  EXPECT_TRUE(fs::exists(models() / "house.hier"));
  EXPECT_EQ(process_->end(SIGTERM), 0);
}

TEST_F(ServeTest, AWatchedFolderAloneTakesNothing) {
  fs::create_directories(inbox());
  tests::RawClient client(serve({"--watch", inbox().string()}).port());
  client.send(put_request("sent.ply", "ply"));
  EXPECT_EQ(client.receive().status, 405);
  EXPECT_FALSE(list().contains("upload"));
}

TEST_F(ServeTest, FromElsewhereATokenIsNeeded) {
  fs::create_directories(inbox());
  const auto status_of = [&](const std::string& headers) {
    tests::RawClient client(process_->port());
    client.send(put_request("sent.ply", "ply", headers));
    return client.receive().status;
  };
  serve({"--inbox", inbox().string(), "--host", "0.0.0.0"});
  EXPECT_EQ(status_of(""), 403);
  EXPECT_FALSE(list().contains("upload"));
  process_->end(SIGTERM);
  EXPECT_THAT(process_->messages(), HasSubstr("--upload-token-file"));
  const fs::path token = folder_.path() / "token";
  tests::write_text(token, "0123456789abcdef\n");
  serve({"--inbox", inbox().string(), "--host", "0.0.0.0", "--upload-token-file", token.string()});
  EXPECT_EQ(status_of(""), 401);
  EXPECT_EQ(status_of("Authorization: Bearer 0123456789abcdef\r\n"), 201);
  EXPECT_EQ(list()["upload"]["token"], true);
}

TEST_F(ServeTest, ASecretThatOthersMayReadIsToldAtTheStart) {
  fs::create_directories(inbox());
  const auto told = [&](fs::perms mode, const std::string& format) {
    const fs::path token = folder_.path() / "my token";
    tests::write_text(token, "0123456789abcdef\n");
    fs::permissions(token, mode);
    serve({"--inbox", inbox().string(), "--upload-token-file", token.string(),
           "--metrics-token-file", token.string(), "--log", format})
        .port();
    EXPECT_EQ(process_->end(SIGTERM), 0);
    return process_->messages();
  };
  using fs::perms;
  const perms own = perms::owner_read | perms::owner_write;
  EXPECT_THAT(told(own, "text"), Not(HasSubstr("chmod")));
  EXPECT_THAT(told(perms::owner_read, "text"), Not(HasSubstr("chmod")));
  for (const perms others : {perms::group_read, perms::others_read, perms::group_write}) {
    const std::string messages = told(own | others, "text");
    for (const char* option : {"--upload-token-file", "--metrics-token-file"})
      EXPECT_THAT(messages, HasSubstr(fmt::format("Z warning {} ", option)));
    EXPECT_THAT(messages, HasSubstr("chmod 600"));
  }
  std::istringstream lines(told(own | perms::others_all, "json"));
  std::size_t warnings = 0;
  for (std::string line; std::getline(lines, line);) {
    const json object = json::parse(line);
    const bool is_warning =
        object["message"].get<std::string>().find("chmod 600") != std::string::npos;
    EXPECT_TRUE(!is_warning || object["level"] == "warning");
    warnings += is_warning ? 1 : 0;
  }
  EXPECT_EQ(warnings, 2U);
}

TEST_F(ServeTest, OnAllAddressesItSaysHowOthersComeToIt) {
  const std::uint16_t port = serve({"--host", "0.0.0.0"}).port();
  process_->end(SIGTERM);
  EXPECT_THAT(process_->messages(), HasSubstr(fmt::format("others open http://ADDRESS:{}/", port)));
  serve({}).port();
  process_->end(SIGTERM);
  EXPECT_THAT(process_->messages(), Not(HasSubstr("ADDRESS")));
}

TEST_F(ServeTest, KilledInTheMiddleOfAnUploadItLeavesNothing) {
  fs::create_directories(inbox());
  const auto count = [&] {
    return std::distance(fs::directory_iterator(inbox()), fs::directory_iterator());
  };
  tests::RawClient client(serve({"--inbox", inbox().string()}).port());
  client.send("PUT /inbox/a.ply HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\nhalf");
  wait_until([&] { return count() == 2; });
  process_->end(SIGKILL);
  EXPECT_EQ(count(), 2) << "the part and its lock";
  serve({"--inbox", inbox().string()}).port();
  EXPECT_EQ(count(), 0);
}

TEST_F(ServeTest, KilledInTheMiddleOfABuildItGoesOnWhenItIsStartedAgain) {
  const std::vector<std::string> arguments{"--watch", inbox().string(), "--settle", "0.05"};
  const fs::path output = models() / "new.hier";
  const fs::path work = models() / ".new.hier.meshhier-work";
  // A machine that is quicker than this test gets a larger mesh.
  for (std::size_t triangles = 100'000; !fs::exists(work); triangles *= 2) {
    fs::remove_all(output);
    drop("new.ply", triangles);
    serve(arguments);
    wait_until([&] { return stage() == "leaves" || stage() == "simplify" || fs::exists(output); });
    EXPECT_EQ(process_->end(SIGKILL), 1000 + SIGKILL);
    // The build is gone with it: its lock is free.
    const auto files = storage::make_posix_file_system();
    wait_until([&] { return !files->is_locked(work / "lock"); });
  }
  EXPECT_FALSE(fs::exists(output));
  EXPECT_TRUE(fs::exists(work / "journal"));
  serve(arguments);
  wait_until([&] { return fs::exists(output) && list()["jobs"].empty(); });
  EXPECT_EQ(process_->end(SIGINT), 0);
  EXPECT_FALSE(fs::exists(work));

  const std::string build = "'" MESHHIER_BINARY "' build --set input='" +
                            (inbox() / "new.ply").string() + "' output='" +
                            (folder_.path() / "direct.hier").string() + "' >/dev/null";
  ASSERT_EQ(std::system(build.c_str()), 0);
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path() / "direct.hier")) {
    if (!entry.is_regular_file())
      continue;
    const fs::path name = entry.path().lexically_relative(folder_.path() / "direct.hier");
    EXPECT_EQ(text_of(output / name), text_of(entry.path())) << name;
    ++files;
  }
  EXPECT_GT(files, 10U);
}

TEST(ServeEmptyTest, AnEmptyFolderIsNamedAndSoIsTheInbox) {
  const tests::TemporaryDirectory directory;
  fs::create_directories(directory.path() / "models");
  fs::create_directories(directory.path() / "inbox");
  const std::string models = (directory.path() / "models").string();
  const std::string inbox = (directory.path() / "inbox").string();
  ServeProcess server(directory.path(), {models, "--watch", inbox, "--port", "0"});
  tests::RawClient client(server.port());
  const json listing = json::parse(client.get("/models.json").body);
  EXPECT_EQ(listing["folder"], fs::canonical(models).string());
  EXPECT_EQ(listing["inbox"], fs::canonical(inbox).string());
  server.end(SIGTERM);
  EXPECT_THAT(server.messages(), AllOf(HasSubstr("no hierarchies in " + models + " yet"),
                                       HasSubstr("put into " + inbox)));
}

TEST(ServeEmptyTest, OthersDoNotGetToKnowWhereTheFolderLies) {
  const tests::TemporaryDirectory directory;
  fs::create_directories(directory.path() / "models");
  ServeProcess server(directory.path(),
                      {(directory.path() / "models").string(), "--cors", "*", "--port", "0"});
  const json listing = json::parse(tests::RawClient(server.port()).get("/models.json").body);
  EXPECT_EQ(listing["folder"], "models");
  EXPECT_FALSE(listing.contains("inbox"));
}

}  // namespace
}  // namespace meshhier::app
