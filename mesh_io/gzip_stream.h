// Gzip files (RFC 1952) as streams of what they hold.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstddef>
#include <memory>
#include <span>

namespace meshhier::mesh_io {

/// Returns whether `start`, of two bytes or more, is that of a gzip member.
bool is_gzip_start(std::span<const std::byte> start);

/// Unpacks the members of a gzip file, one behind the other; zeros behind the last one are padding.
/// read() throws Error(input) at truncated or damaged data, checksums that do not fit and other
/// bytes behind the last member. Memory: zlib's 40 KiB and a block of the file.
std::unique_ptr<InputStream> make_gzip_stream(const InputFile& input, ReadWatch watch);

}  // namespace meshhier::mesh_io
