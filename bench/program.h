// main() of the programs of this folder.
#pragma once

#include "base/error.h"

#include <cstdio>
#include <exception>
#include <functional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::bench {

/// Parses the arguments and calls `run`. A failure goes to standard error after the program's name.
/// Returns the exit code: 0, or that of the Error.
inline int run_program(const char* name, CLI::App& app, int argc, const char* const* argv,
                       const std::function<void()>& run) {
  try {
    app.parse(argc, argv);
    run();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ErrorCode::usage);
  } catch (const Error& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: internal error: {}\n", name, error.what());
    return static_cast<int>(ErrorCode::internal);
  }
  return 0;
}

}  // namespace meshhier::bench
