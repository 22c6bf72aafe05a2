// The plan for the faces of a PLY file.
#pragma once

#include "mesh_io/ply_plan.h"

#include <filesystem>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// Plans all elements but the vertices, which are planned. `texture_files`: as the header names
/// them. Throws Error(input) if faces cannot be read.
void plan_faces(PlyPlan& plan, const std::vector<std::string>& texture_files,
                const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
