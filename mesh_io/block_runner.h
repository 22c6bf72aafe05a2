// Who has threads runs the blocks of a text on them; a reader has none of its own.
#pragma once

#include <cstddef>
#include <functional>

namespace meshhier::mesh_io {

/// What is done with the blocks 0, 1, 2, ...
struct BlockSteps {
  std::function<bool(std::size_t)> read;  ///< whether there is such a block; in order
  std::function<void(std::size_t)> work;  ///< in parallel; does not throw
  std::function<bool(std::size_t)> take;  ///< whether to go on; in order
};

/// Runs the steps of all blocks, one after the other for each. Those in order run one at a time.
/// All is done with a block before the one `in_flight` behind it is read. The first exception in
/// the order of the blocks ends it.
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
