// A build that may fail.
#pragma once

#include "base/error.h"
#include "pipeline/build.h"

#include <optional>
#include <string>

namespace meshhier::tests {

/// The code that a build fails with, and its message; none if it succeeds.
inline std::optional<ErrorCode> try_build(const config::Config& config, bool force,
                                          pipeline::BuildEnvironment environment,
                                          std::string& message) {
  try {
    pipeline::build_hierarchy(config, {.force = force}, environment);
  } catch (const Error& error) {
    message = error.what();
    return error.code();
  }
  return std::nullopt;
}

}  // namespace meshhier::tests
