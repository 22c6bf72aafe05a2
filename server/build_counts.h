// What a watched folder has built since the server began.
#pragma once

#include <cstddef>
#include <cstdint>

namespace meshhier::server {

struct BuildCounts {
  std::uint64_t done = 0;
  std::uint64_t failed = 0;
  double seconds = 0;  ///< that builds took which have ended
  // Files of the inbox now:
  std::size_t at_work = 0;
  std::size_t waiting = 0;    ///< for a build, or for the end of a copy
  std::size_t not_built = 0;  ///< their builds failed
};

}  // namespace meshhier::server
