// PLY files as mesh sources.
#pragma once

#include "mesh_io/mesh_source.h"
#include "storage/io/file.h"

#include <cstdint>
#include <memory>

namespace meshhier::mesh_io {

/// Reads the header of `file` and checks it. What is accepted: ply_header.h, ply_plan.h,
/// ply_body.h.
std::unique_ptr<MeshSource> make_ply_source(std::unique_ptr<storage::File> file);

}  // namespace meshhier::mesh_io
