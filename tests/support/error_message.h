// The message of the error that a call ends with.
#pragma once

#include "base/error.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {

/// Returns the message of the Error that `action` ends with, which has that code and begins with
/// `start`; empty if it ends without one.
template <class Action>
std::string error_message(ErrorCode code, const Action& action, const std::string& start = {}) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_THAT(error.what(), testing::StartsWith(start));
    return error.what();
  }
  return {};
}

/// The same for Error(usage).
template <class Action>
std::string usage_error(const Action& action) {
  return error_message(ErrorCode::usage, action);
}

}  // namespace meshhier::tests
