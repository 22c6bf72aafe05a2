// A check that an archive is whole, to the last bit.
#pragma once

#include "storage/format/archive.h"

#include <functional>
#include <string>

namespace meshhier::storage {

/// Compares every byte besides the contents with what it has to be, and the contents with their
/// CRC-32; tells each difference in one line that starts with the archive's path. Holds one block
/// of the archive at a time. `check` is called before each read and may throw. Throws Error(io).
void check_archive(const Archive& archive, const std::function<void()>& check,
                   const std::function<void(const std::string&)>& tell);

}  // namespace meshhier::storage
