// Meshes of any size that are legal and unreasonable: flat, knotted, scattered, beyond scale.
#pragma once

#include "bench/generator.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace meshhier::bench {

struct StressCase {
  std::string_view name;
  std::string_view what;  ///< for people
};

/// Returns all cases.
std::span<const StressCase> stress_cases();

/// Returns the case of that name with about `size` triangles, or vertices where it has no
/// triangles; at least the few that the case needs. A pure function of its arguments. Throws
/// Error(usage) if there is no such case, or `size` is 2^30 or more.
LoadedMesh make_stress(std::string_view name, std::uint64_t size, std::uint64_t seed = 1);

/// Hands out `mesh` as it is, for write_ply().
std::unique_ptr<GeneratedMesh> as_generated(LoadedMesh mesh);

}  // namespace meshhier::bench
