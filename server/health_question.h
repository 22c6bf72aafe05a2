// Asks a server that runs whether it is well: for HEALTHCHECK of containers, which have no curl.
#pragma once

#include "base/named_value.h"

#include <array>
#include <cstdint>
#include <string>

namespace meshhier::server {

enum class Health { alive, ready };
inline constexpr std::array kHealths{NamedValue{"alive", Health::alive},
                                     NamedValue{"ready", Health::ready}};

struct HealthAnswer {
  bool is_well = false;
  std::string text{};  ///< the reply, or why there is none, on one line
};

/// Asks the server on that host and port, as ServerOptions has them, within five seconds. Never
/// throws for what is wrong.
HealthAnswer ask_health(const std::string& host, std::uint16_t port, Health health);

}  // namespace meshhier::server
