// A build that is stopped after some of its steps.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace meshhier::tests {

/// Cancels after so many steps.
class StoppedStage final : public execution::Progress {
 public:
  StoppedStage(execution::CancelToken& cancel, std::uint64_t after)
      : cancel_(cancel), after_(after) {}

  void stage(std::string_view name, std::uint64_t, std::string_view) override {
    stage_name = name;
    step();
  }
  void advance(std::uint64_t) override { step(); }
  void finish(std::string_view) override {}

  std::string stage_name;

 private:
  void step() {
    if (steps_++ >= after_)
      cancel_.cancel();
  }

  execution::CancelToken& cancel_;
  std::uint64_t after_, steps_ = 0;
};

}  // namespace meshhier::tests
