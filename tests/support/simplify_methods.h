// Every way there is to contract tiles.
#pragma once

#include "config/config.h"

#include <string>
#include <utility>
#include <vector>

namespace meshhier::tests {

/// By name, each method with each of its variants; simplify.vertices is not set.
inline std::vector<std::pair<std::string, config::SimplifyConfig>> all_simplify_methods() {
  std::vector<std::pair<std::string, config::SimplifyConfig>> all;
  for (const auto& method : config::kSimplifyMethods) {
    config::SimplifyConfig config;
    config.method = method.value;
    if (method.value == config::SimplifyMethod::cluster) {
      for (const auto& representative : config::kRepresentatives) {
        config.representative = representative.value;
        all.emplace_back(std::string(method.name) + " " + std::string(representative.name), config);
      }
    } else if (method.value == config::SimplifyMethod::half_edge) {
      for (const auto& cost : config::kHalfEdgeCosts) {
        config.cost = cost.value;
        all.emplace_back(std::string(method.name) + " " + std::string(cost.name), config);
      }
    } else {
      all.emplace_back(method.name, config);
    }
  }
  return all;
}

}  // namespace meshhier::tests
