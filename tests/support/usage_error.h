// The error by which a call is refused.
#pragma once

#include "base/error.h"

#include <string>

#include <gtest/gtest.h>

namespace meshhier::tests {

/// The message of the Error(usage) that `action` ends with, or "no error".
template <class Action>
std::string usage_error(Action action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    return error.what();
  }
  return "no error";
}

}  // namespace meshhier::tests
