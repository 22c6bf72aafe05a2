// The main function of all test programs: GoogleTest's, with shares (share.h).
//
//   NAME_test [--rotate] [--gtest_...]
//
// --rotate: whole tests are the cases of a share. Those that are chosen do all that they have.
// A pattern of --gtest_filter that no test has is an error: what it was written for would be left
// out in silence.
#include "tests/support/share.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fnmatch.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Four callers of each block of memory are kept: to walk the whole stack at each allocation takes
/// a sixth of the time of tests with sanitizers. ASAN_OPTIONS may ask for more.
extern "C" const char* __asan_default_options() {
  return "malloc_context_size=4";
}

namespace meshhier::tests {
namespace {

constexpr const char* kVariable = "MESHHIER_TEST_SHARE";
constexpr std::string_view kRotate = "--rotate";

Share the_share;

std::optional<std::size_t> parse_number(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    return std::nullopt;
  return number;
}

std::optional<Share> parse_share(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos)
    return std::nullopt;
  const auto index = parse_number(text.substr(0, slash));
  const auto count = parse_number(text.substr(slash + 1));
  if (!index || !count || *index >= *count)
    return std::nullopt;
  return Share{*index, *count};
}

/// Returns the share that the environment asks for; the whole if it asks for none.
Share chosen_share() {
  const char* const text = std::getenv(kVariable);
  if (text == nullptr || *text == '\0')
    return {};
  const std::optional<Share> share = parse_share(text);
  if (!share) {
    fmt::print(stderr, "{}=\"{}\": expected \"k/n\" with 0 <= k < n\n", kVariable, text);
    std::exit(2);
  }
  return *share;
}

bool take_rotate(int& argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (argv[i] != kRotate)
      continue;
    for (int j = i; j < argc; ++j)  // the null pointer at the end too
      argv[j] = argv[j + 1];
    --argc;
    return true;
  }
  return false;
}

/// Lets GoogleTest choose the tests of the share.
void rotate(const Share& share) {
  setenv("GTEST_TOTAL_SHARDS", std::to_string(share.count).c_str(), 1);
  setenv("GTEST_SHARD_INDEX", std::to_string(share.index).c_str(), 1);
}

bool names_a_test(const std::string& pattern) {
  const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  for (int i = 0; i < tests.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *tests.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j) {
      const std::string name = fmt::format("{}.{}", suite.name(), suite.GetTestInfo(j)->name());
      if (fnmatch(pattern.c_str(), name.c_str(), 0) == 0)
        return true;
    }
  }
  return false;
}

/// Ends the program if a part of GoogleTest's filter, "A:B-C:D", names no test.
void require_tests(std::string filter) {
  std::replace(filter.begin(), filter.end(), '-', ':');
  std::istringstream patterns(filter);
  for (std::string pattern; std::getline(patterns, pattern, ':');) {
    if (!pattern.empty() && !names_a_test(pattern)) {
      fmt::print(stderr, "--gtest_filter: no test here is named \"{}\"\n", pattern);
      std::exit(2);
    }
  }
}

/// Tells how to repeat what failed.
class Repeating : public testing::EmptyTestEventListener {
 public:
  explicit Repeating(const char* program) : program_(program) {}

  void OnTestEnd(const testing::TestInfo& test) override {
    if (!test.result()->Failed())
      return;
    const Share& done = share();
    fmt::print("To repeat: {}{} '--gtest_filter={}.{}'\n",
               done.count > 1 ? fmt::format("{}={}/{} ", kVariable, done.index, done.count) : "",
               program_, test.test_suite_name(), test.name());
    std::fflush(stdout);
  }

 private:
  std::string program_;
};

}  // namespace

const Share& share() {
  return the_share;
}

}  // namespace meshhier::tests

int main(int argc, char** argv) {
  using namespace meshhier::tests;
  the_share = chosen_share();
  if (take_rotate(argc, argv)) {
    rotate(the_share);
    the_share = {};
  }
  testing::InitGoogleMock(&argc, argv);
  require_tests(testing::GTEST_FLAG(filter));
  testing::UnitTest::GetInstance()->listeners().Append(new Repeating(argv[0]));
  return RUN_ALL_TESTS();
}
