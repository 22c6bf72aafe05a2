#include "storage/io/child_process.h"

#include "storage/io/own_program.h"

#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

using std::chrono::milliseconds;

std::string all_of(ChildProcess& child) {
  std::string text;
  while (child.hear(text, milliseconds(1000))) {
  }
  return text;
}

std::vector<std::string> shell(const std::string& script) {
  return {"/bin/sh", "-c", script};
}

TEST(ChildProcessTest, ItsWordsAndItsCodeAreHeard) {
  ChildProcess child(shell("echo result; echo one >&2; echo two >&2; exit 7"));
  EXPECT_EQ(all_of(child), "one\ntwo\n");
  EXPECT_EQ(child.wait(), 7);
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

TEST(ChildProcessTest, OneIsSpokenWith) {
  ChildProcess child({"/bin/cat"}, ChildProcess::Errors::dropped, ChildProcess::Speech::socket);
  for (const std::string said : {"one", "and two"}) {
    ASSERT_TRUE(child.send(bytes_of(said)));
    std::string heard(said.size(), ' ');
    ASSERT_TRUE(child.receive(std::as_writable_bytes(std::span(heard))));
    EXPECT_EQ(heard, said);
  }
}

TEST(ChildProcessTest, OneThatHasEndedIsNotHeard) {
  ChildProcess child(shell("echo half; exit 3"), ChildProcess::Errors::dropped,
                     ChildProcess::Speech::socket);
  std::string heard(6, ' ');
  EXPECT_FALSE(child.receive(std::as_writable_bytes(std::span(heard))));
  EXPECT_FALSE(child.send(bytes_of("anybody?")));
  EXPECT_EQ(child.wait(), 3);
}

TEST(ChildProcessTest, ProgramsAreFoundByName) {
  EXPECT_TRUE(find_program("sh"));
  EXPECT_FALSE(find_program("no program has this name"));
}

TEST(ChildProcessTest, WhatNobodyHearsHoldsNothingUp) {
  ChildProcess child(shell("head -c 200000 /dev/zero >&2; exit 7"), ChildProcess::Errors::dropped);
  EXPECT_EQ(child.wait(), 7);
  EXPECT_EQ(all_of(child), "");
}

TEST(ChildProcessTest, DeathBySignalIsACode) {
  ChildProcess child(shell("kill -ABRT $$"));
  EXPECT_EQ(all_of(child), "");
  EXPECT_EQ(child.wait(), 128 + SIGABRT);
}

TEST(ChildProcessTest, ItCanBeAskedToStop) {
  ChildProcess child(
      shell("trap 'echo bye >&2; exit 3' TERM; echo up >&2; while :; do sleep 0.01; done"));
  std::string text;
  while (text.empty())
    child.hear(text, milliseconds(100));
  child.ask_to_stop();
  EXPECT_EQ(all_of(child), "bye\n");
  EXPECT_EQ(child.wait(), 3);
}

TEST(ChildProcessTest, ItCanBeAskedToStopBeforeItHasBegun) {
  const auto handler = std::signal(SIGTERM, [](int) {});  // this process's own
  for (int i = 0; i < 20; ++i) {
    ChildProcess child(shell("exec sleep 10"));
    child.ask_to_stop();
    ASSERT_EQ(child.wait(), 128 + SIGTERM);
  }
  std::signal(SIGTERM, handler);
}

TEST(ChildProcessTest, WhatCannotBeStartedEndsWith127) {
  ChildProcess child({"/nowhere/program"});
  EXPECT_EQ(child.wait(), 127);
}

TEST(ChildProcessTest, ItHasNoFilesOfOurs) {
  const int file = ::dup(STDERR_FILENO);  // without close-on-exec
  ChildProcess child(shell("exec ls /proc/self/fd >&2"));
  const std::string files = all_of(child);
  ::close(file);
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(files, "0\n1\n2\n3\n") << "3 is the directory that is listed";
}

TEST(ChildProcessTest, ItDoesNotOutliveItsObjectOrItsThread) {
  pid_t process = -1;
  const auto start = [&](std::unique_ptr<ChildProcess>& child) {
    child = std::make_unique<ChildProcess>(shell("echo $$ >&2; exec sleep 1000"));
    std::string text;
    while (text.find('\n') == std::string::npos)
      child->hear(text, milliseconds(100));
    process = std::stoi(text);
  };
  std::unique_ptr<ChildProcess> child;
  start(child);
  EXPECT_EQ(::kill(process, 0), 0);
  child.reset();
  EXPECT_EQ(::kill(process, 0), -1);
  std::thread([&] { start(child); }).join();
  EXPECT_EQ(child->wait(), 128 + SIGKILL);
}

TEST(ChildProcessTest, OwnProgramIsThisOne) {
  EXPECT_TRUE(std::filesystem::equivalent(own_program(), "/proc/self/exe"));
  EXPECT_EQ(own_directory(), std::filesystem::path(own_program()).parent_path().string());
  EXPECT_EQ(::access(own_program().c_str(), X_OK), 0);
  EXPECT_TRUE(std::filesystem::equivalent(own_code(), "/proc/self/exe"));
  // That of another program, which started this one.
  ::setenv("MESHHIER_PROGRAM", "/opt/meshhier/bin/meshhier", 1);
  EXPECT_TRUE(std::filesystem::equivalent(own_program(), "/proc/self/exe"));
  EXPECT_TRUE(std::filesystem::equivalent(own_code(), "/proc/self/exe"));
  ::unsetenv("MESHHIER_PROGRAM");
}

}  // namespace
}  // namespace meshhier::storage
