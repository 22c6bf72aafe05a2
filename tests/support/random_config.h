// Configs by chance: whatever a build can be asked for is asked for at some time. What there is
// comes from the table of keys, so a new key is drawn from its first day, or a test fails.
#pragma once

#include "base/bounds.h"
#include "config/config.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

namespace meshhier::tests {

/// One of 0 ... most; 0 leaves things as they usually are.
using Draw = std::function<std::uint64_t(std::uint64_t most)>;

/// The use that configs are drawn for.
struct DrawnFor {
  BoundsD box{{-1, -1, -1}, {1, 1, 1}};  ///< the mesh's, for pieces of it
  bool with_ktx2 = true;                 ///< pictures that other processes make, where they are
};

/// Keys that are not drawn: paths, what tests draw by themselves (threads, budget), and what needs
/// the files or the data of a map, or rasters.
inline constexpr std::array<std::string_view, 12> kNotDrawn{
    "$schema",       "input",         "output",           "memory_budget",
    "threads",       "placement.crs", "placement.offset", "placement.metadata",
    "texture.drape", "objects.from",  "objects.table",    "view.attribute"};

/// A config of small tiles, without input and output. A pure function of what is drawn: of zeros
/// alone the defaults.
config::Config random_config(const Draw& draw, const DrawnFor& what = {});

}  // namespace meshhier::tests
