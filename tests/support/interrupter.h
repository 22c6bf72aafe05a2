// Progress that interrupts the job it is told of.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace meshhier::tests {

/// Sets the token when so many units of work have been done in all, but for those of `passed`.
class Interrupter final : public execution::Progress {
 public:
  Interrupter(execution::CancelToken& token, std::uint64_t after,
              std::set<std::string, std::less<>> passed = {})
      : token_(token), after_(after), passed_(std::move(passed)) {}
  void stage(std::string_view name, std::uint64_t, std::string_view) override {
    const std::lock_guard lock(mutex_);
    stages_.insert(std::string(name));
    is_passed_ = passed_.contains(name);
  }
  void advance(std::uint64_t count) override {
    if (is_passed_)
      return;
    if (done_.fetch_add(count) + count >= after_)
      token_.cancel();
  }
  void finish(std::string_view) override {}
  std::uint64_t done() const { return done_; }
  const std::set<std::string>& stages() const { return stages_; }

 private:
  execution::CancelToken& token_;
  std::uint64_t after_;
  std::set<std::string, std::less<>> passed_;
  std::atomic<bool> is_passed_{false};
  std::atomic<std::uint64_t> done_{0};
  std::mutex mutex_;
  std::set<std::string> stages_;
};

/// Calls a function at the beginning of the stage of that name.
class AtStage : public execution::Progress {
 public:
  AtStage(std::string stage, std::function<void()> begins)
      : stage_(std::move(stage)), begins_(std::move(begins)) {}
  void stage(std::string_view name, std::uint64_t, std::string_view) override {
    if (name == stage_)
      begins_();
  }
  void advance(std::uint64_t) override {}
  void finish(std::string_view) override {}

 private:
  std::string stage_;
  std::function<void()> begins_;
};

/// Sets the token at the beginning of the stage of that name.
class StageInterrupter final : public AtStage {
 public:
  StageInterrupter(execution::CancelToken& token, std::string stage)
      : AtStage(std::move(stage), [&token] { token.cancel(); }) {}
};

}  // namespace meshhier::tests
