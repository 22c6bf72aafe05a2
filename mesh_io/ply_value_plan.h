// The properties of a PLY file that are values: quality, label, temperature.
#pragma once

#include "mesh_io/ply_plan.h"

#include <filesystem>
#include <optional>

namespace meshhier::mesh_io {

/// Returns the value that a scalar property is, which comes behind those of `known`. None if it is
/// not chosen (by all "flags" is not: MeshLab's own), has no sound name or a name of `known`, or if
/// its channels would be too many.
std::optional<ScalarAttribute> value_of(const PlyProperty& property, const AttributeChoice& choice,
                                        PlyWrittenBy writer, const AttributeLayout& known);

/// Takes the scalars of polygons that are not used yet as values. Requires all else of the plan.
void plan_face_values(PlyPlan& plan, const AttributeChoice& choice,
                      const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
