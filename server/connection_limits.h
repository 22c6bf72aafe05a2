// Limits to the slowness of a client.
#pragma once

#include <chrono>
#include <cstddef>

namespace meshhier::server {

/// The least rate counts while others wait: the six connections of a phone's browser
/// at 400 kbit/s get 8 kB/s each, and are welcome as long as there is room.
struct ConnectionLimits {
  using Milliseconds = std::chrono::milliseconds;
  Milliseconds idle{15'000};           ///< between two requests
  Milliseconds patience{1'000};        ///< for a whole head, while others wait for a connection
  Milliseconds head{10'000};           ///< from the first byte of a request to the end of its head
  Milliseconds stall{10'000};          ///< without a byte taken
  Milliseconds grace{30'000};          ///< from then on least_rate counts
  std::size_t least_rate = 16 * 1024;  ///< at which a reply is taken: bytes a second, on average
};

}  // namespace meshhier::server
