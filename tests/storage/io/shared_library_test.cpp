#include "storage/io/shared_library.h"

#include "base/error.h"
#include "tests/support/error_message.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kMathematics = "libm.so.6";
constexpr const char* kRemedy = "install the package libc6";

/// The message of the I/O error that `use` must end with.
template <class Use>
std::string failure(const Use& use) {
  const std::string message = tests::error_message(ErrorCode::io, use);
  EXPECT_NE(message, "") << "nothing was thrown";
  return message;
}

TEST(SharedLibraryTest, FunctionsAreThoseOfTheLibrary) {
  const SharedLibrary library(kMathematics, kRemedy);
  EXPECT_EQ(library.function<double (*)(double)>("floor")(2.5), 2);
}

TEST(SharedLibraryTest, OneThatIsNotThereIsNamedWithWhatToDo) {
  EXPECT_THAT(
      failure([] { SharedLibrary("libnone.so.1", "install the package libnone1"); }),
      AllOf(HasSubstr("cannot load libnone.so.1: "), HasSubstr("; install the package libnone1")));
}

TEST(SharedLibraryTest, AFunctionThatIsNotThereIsNamedWithWhatToDo) {
  const SharedLibrary library(kMathematics, kRemedy);
  EXPECT_EQ(failure([&] { library.function<void (*)()>("none"); }),
            "libm.so.6 has no function none; install the package libc6");
}

}  // namespace
}  // namespace meshhier::storage
