#include "storage/io/worker_pool.h"

#include "base/error.h"
#include "storage/io/process.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kProtocol = 7;
constexpr std::array<std::uint32_t, 2> kNumbers{5, 3};  // the last one: bytes that follow
constexpr std::array kBytes{std::byte{'a'}, std::byte{'b'}, std::byte{'c'}};

/// Programs of the shell; what a script says of itself goes to a file beside.
class WorkerPoolTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// A pool of programs that greet, and do what `script` says.
  WorkerPool pool(const std::string& script) const {
    return WorkerPool("the helper", kProtocol, [script] {
      return std::vector<std::string>{"/bin/sh", "-c", "printf '\\007\\000\\000\\000'; " + script};
    });
  }

  static std::optional<WorkerPool::Answer> ask(WorkerPool& pool) {
    return pool.ask(kNumbers, kBytes);
  }
  static std::string text_of(const std::optional<WorkerPool::Answer>& answer) {
    return !answer ? "none"
                   : std::string(reinterpret_cast<const char*>(answer->bytes.data()),
                                 answer->bytes.size());
  }
  std::size_t started() const {
    std::ifstream file(path("started"));
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line);)
      ++lines;
    return lines;
  }

  const std::filesystem::path folder_ = make_temporary_directory();
};

constexpr const char* kAnswer = "printf '\\000\\000\\000\\000\\002\\000\\000\\000ok'";
constexpr const char* kReadQuestion = "head -c 11 >/dev/null";

TEST_F(WorkerPoolTest, OneProcessAnswersOneAfterAnother) {
  WorkerPool pool = this->pool("echo x >>'" + path("started") + "'; while " + kReadQuestion +
                               "; do " + kAnswer + "; done");
  for (int i = 0; i < 3; ++i) {
    const auto answer = ask(pool);
    EXPECT_EQ(text_of(answer), "ok");
    EXPECT_TRUE(answer->is_good);
  }
  EXPECT_EQ(started(), 1U);
  pool.end_idle();
  EXPECT_EQ(text_of(ask(pool)), "ok");
  EXPECT_EQ(started(), 2U);
}

TEST_F(WorkerPoolTest, WhyThereIsNoAnswerIsTold) {
  WorkerPool pool = this->pool(std::string(kReadQuestion) +
                               "; printf '\\001\\000\\000\\000\\003\\000\\000\\000why'");
  const auto answer = ask(pool);
  EXPECT_EQ(text_of(answer), "why");
  EXPECT_FALSE(answer->is_good);
}

TEST_F(WorkerPoolTest, OneThatEndsIsReplacedOnce) {
  const std::string mark = "'" + path("started") + "'";
  WorkerPool pool = this->pool("[ -e " + mark + " ] || { echo x >" + mark + "; exit; }; " +
                               kReadQuestion + "; " + kAnswer);
  EXPECT_EQ(text_of(ask(pool)), "ok");
  WorkerPool ending = this->pool("exit");
  EXPECT_EQ(text_of(ask(ending)), "none");
}

TEST_F(WorkerPoolTest, OneThatGreetsOtherwiseIsNotAsked) {
  WorkerPool other("the helper", kProtocol + 1, [] {
    return std::vector<std::string>{"/bin/sh", "-c", "printf '\\007\\000\\000\\000'"};
  });
  try {
    ask(other);
    ADD_FAILURE() << "it was asked";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_THAT(error.what(), HasSubstr("the helper does not start; \"/bin/sh -c printf"));
  }
}

}  // namespace
}  // namespace meshhier::storage
