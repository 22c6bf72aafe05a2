#include "tests/support/random_config.h"

#include "config/config_schema.h"
#include "images/ktx2_coder.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

TEST(RandomConfigTest, EveryKeyIsDrawnAndEveryChoice) {
  std::mt19937_64 engine(1);
  std::map<std::string, std::set<std::string>> drawn;
  for (int i = 0; i < 2000; ++i) {
    const config::Config config =
        random_config([&](std::uint64_t most) { return engine() % (most + 1); });
    for (const config::ConfigKey& key : config::config_keys())
      drawn[key.path].insert(key.show(config).dump());
  }
  for (const config::ConfigKey& key : config::config_keys()) {
    if (std::ranges::find(kNotDrawn, key.path) != kNotDrawn.end())
      continue;
    EXPECT_GE(drawn[key.path].size(), 2U) << key.path;
    if (key.kind != config::KeyKind::choice)
      continue;
    for (const std::string& choice : key.choices) {
      if (choice != "ktx2" || images::missing_for_ktx2().empty()) {
        EXPECT_THAT(drawn[key.path], testing::Contains('"' + choice + '"')) << key.path;
      }
    }
  }
}

TEST(RandomConfigTest, OfZerosItIsTheDefault) {
  EXPECT_EQ(random_config([](std::uint64_t) { return 0; }), config::Config());
}

}  // namespace
}  // namespace meshhier::tests
