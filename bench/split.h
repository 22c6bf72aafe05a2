// Splits vertices as files of textured, shaded and coloured meshes do.
#pragma once

#include "bench/generator.h"

#include <span>
#include <string_view>

namespace meshhier::bench {

struct SplitCase {
  std::string_view name;
  std::string_view what;  ///< for people
};

/// Returns the cases in the order of the help.
std::span<const SplitCase> split_cases();

/// Returns the same surface with its vertices split where their attributes differ, corner by
/// corner; its own attributes go. `degrees`: the angle of "hard_edges" and "mixed". Pure; O(t log
/// t) in the triangles but for the triangles around a vertex, whose number counts squared. Throws
/// Error(usage) if there is no such case.
LoadedMesh split(const LoadedMesh& mesh, std::string_view name, double degrees);

}  // namespace meshhier::bench
