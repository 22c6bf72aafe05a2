// A file in gzip, read anywhere in what it holds.
//
// Problem. Deflate is read from its beginning on.
// Idea. The state of the decoder is kept after each MiB, 40 KiB for each: reading goes on where the
// last read ended, or begins at the state before it.
//
//      0 . . . . 1 . . . . 2 . . . . 3 . .      a number: a state that is kept, once it was passed
//                |--------->[ read ]            at most a MiB is unpacked for nothing
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <memory>

namespace meshhier::mesh_io {

/// Returns what the first member of a file in gzip holds, as a file under its path, of `bytes`
/// bytes. Reads of several threads wait for each other; one throws Error(input) naming the file if
/// it is damaged or ends before.
std::unique_ptr<storage::File> inflated(std::unique_ptr<storage::File> packed, std::uint64_t bytes);

/// Returns the bytes that the end of a file in gzip tells it to hold, up to 2^32. Throws Error(io).
std::uint64_t told_bytes(const storage::File& packed);

}  // namespace meshhier::mesh_io
