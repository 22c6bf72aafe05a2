// The format of numpy's arrays (NEP 1), as far as rows of numbers need it.
#pragma once

#include "mesh_io/input_stream.h"
#include "query/row_source.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace meshhier::querying {

/// Returns whether bytes begin as a .npy does.
bool is_npy(std::string_view start);

/// Reads all rows of an array, as read_rows() does. `name` begins messages. Throws Error(input) if
/// the array has another type, order or shape, or another size than it says.
std::uint64_t read_npy_rows(mesh_io::InputStream& stream, const std::string& name, RowKind kind,
                            const RowVisitor& visit);

/// Returns the head of an array of `count` records in one dimension; `type`: as Python would print
/// a numpy.dtype's descr. A multiple of 64 bytes.
std::string npy_head(std::string_view type, std::uint64_t count);

}  // namespace meshhier::querying
