// A part of the memory budget that is set aside for one purpose.
#pragma once

#include "hierarchy/error.h"
#include "pipeline/size_text.h"

#include <cstdint>
#include <string>

#include <fmt/format.h>

namespace meshhier::pipeline {

struct MemoryShare {
  std::uint64_t budget = 0;  ///< bytes
  std::uint64_t parts = 1;   ///< into so many equal ones, of which this is one

  std::uint64_t bytes() const { return budget / parts; }

  /// Throws Error(budget) that tells what budget is needed, if `needed` bytes are more. `what`:
  /// "the tiles need".
  void require(const std::string& what, std::uint64_t needed) const {
    constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
    if (needed <= bytes())
      return;
    throw Error(ErrorCode::budget,
                fmt::format("{} {}, the budget leaves {}: --memory-budget must be at least {}",
                            what, rounded_size_text(needed), rounded_size_text(bytes()),
                            exact_size_text((needed * parts / kMebibyte + 1) * kMebibyte)));
  }
};

}  // namespace meshhier::pipeline
