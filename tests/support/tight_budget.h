// The least memory budget of a build.
#pragma once

#include "base/error.h"
#include "config/config.h"
#include "storage/io/file.h"
#include "tests/support/interrupter.h"
#include "tests/support/try_build.h"

#include <cstdint>
#include <string>

namespace meshhier::tests {

/// To the byte: nothing is left for scratch data, all of it goes to the disk. Builds until the
/// first stage that a plan is needed for. Throws what no budget is the reason of.
inline std::uint64_t tight_budget(config::Config config, storage::FileSystem& files) {
  const auto is_enough = [&](std::uint64_t budget) {
    config.memory_budget = budget;
    execution::CancelToken cancel;
    StageInterrupter progress(cancel, "ingest");
    std::string message;
    const auto code = try_build(config, true, {files, progress, cancel}, message);
    if (code && code != ErrorCode::interrupted && code != ErrorCode::budget)
      throw Error(*code, message);
    return code != ErrorCode::budget;
  };
  std::uint64_t refused = 0;
  std::uint64_t accepted = std::uint64_t{1} << 30;
  while (accepted - refused > 1) {
    const std::uint64_t middle = (refused + accepted) / 2;
    (is_enough(middle) ? accepted : refused) = middle;
  }
  return accepted;
}

}  // namespace meshhier::tests
