// Readers of texts have no threads of their own: a caller that has some runs their blocks on them.
#pragma once

#include <cstddef>
#include <functional>

namespace meshhier::mesh_io {

/// Steps that each of the blocks 0, 1, 2, ... goes through.
struct BlockSteps {
  std::function<bool(std::size_t)> read;  ///< reads it; false: there is no such block; in order
  std::function<void(std::size_t)> work;  ///< in parallel with others; does not throw
  std::function<bool(std::size_t)> take;  ///< hands it on; false: the rest is not wanted; in order
};

/// Runs the steps of all blocks, one after the other for each. Those in order run one at a time. A
/// block has been taken before the one `in_flight` behind it is read, so that many are in memory at
/// most. The first exception in the order of the blocks ends it.
struct BlockRunner {
  std::size_t in_flight = 1;
  std::function<void(const BlockSteps&)> run = run_serially;

  static void run_serially(const BlockSteps& steps) {
    for (std::size_t i = 0; steps.read(i); ++i) {
      steps.work(i);
      if (!steps.take(i))
        return;
    }
  }
};

}  // namespace meshhier::mesh_io
