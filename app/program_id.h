// The identity of this program, down to its bytes.
#pragma once

#include "storage/io/file.h"

#include <string>

namespace meshhier::app {

/// Returns "meshhier 0.1.0 0123456789abcdef", the version and the checksum of the program's file.
/// Throws Error(io).
std::string program_id(storage::FileSystem& files);

}  // namespace meshhier::app
