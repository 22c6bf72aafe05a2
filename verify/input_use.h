// How the input of a hierarchy was read, so that it can be read in the same way again.
#pragma once

#include "import/input_files.h"
#include "mesh_io/input_paths.h"
#include "verify/verify_parts.h"

namespace meshhier::verifying {

/// Returns the use of the input as in the build. An orthophoto that heights were draped with, and a
/// table of objects, are taken out of `inputs`, or found beside the first of them. Throws
/// Error(usage) where they are not there.
importing::InputUse take_input_use(const VerifyJob& job, mesh_io::InputPaths& inputs);

}  // namespace meshhier::verifying
