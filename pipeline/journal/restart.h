// What becomes of the work that an earlier build of an output has left.
#pragma once

namespace meshhier::pipeline {

/// When it is thrown away.
enum class Restart {
  never,       ///< work towards another result is refused
  other_work,  ///< if it is work towards another result
  always
};

}  // namespace meshhier::pipeline
