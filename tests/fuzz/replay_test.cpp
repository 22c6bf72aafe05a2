// Every input that a fuzz run kept, and every one that once was a finding, through the same
// functions, without libFuzzer.
#include "fuzz/targets.h"

#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::tests::fuzz {
namespace {

class FuzzReplay : public testing::TestWithParam<Target> {};

std::string bytes_of_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_P(FuzzReplay, NothingEscapes) {
  const auto folder =
      std::filesystem::path(MESHHIER_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam().name;
  std::size_t inputs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string input = bytes_of_file(entry.path());
    try {
      GetParam().run(std::as_bytes(std::span(input)));
    } catch (const std::exception& failure) {
      ADD_FAILURE() << entry.path() << ": " << failure.what();
    }
    ++inputs;
  }
  EXPECT_GE(inputs, 10U) << "in " << folder;
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzReplay, testing::ValuesIn(kTargets),
                         [](const auto& test) { return std::string(test.param.name); });

/// Inputs that the corpora do not have: nothing, and nothing but zeros.
TEST(FuzzReplayTest, EveryTargetTakesEmptyInputs) {
  for (const Target& target : kTargets) {
    for (const std::size_t size : {0, 1, 12, 100}) {
      const std::vector<std::byte> zeros(size);
      EXPECT_NO_THROW(target.run(zeros)) << target.name << ", " << size << " bytes";
    }
  }
}

}  // namespace
}  // namespace meshhier::tests::fuzz
