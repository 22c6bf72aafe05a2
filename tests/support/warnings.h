// A progress that keeps its warnings.
#pragma once

#include "execution/progress.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::tests {

class Warnings final : public execution::Progress {
 public:
  void stage(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void finish(std::string_view) override {}
  void warn(std::string_view message) override { all.emplace_back(message); }

  std::vector<std::string> all;
};

}  // namespace meshhier::tests
