// Rows of numbers in a text.
#pragma once

#include "mesh_io/input_stream.h"
#include "query/row_source.h"

#include <cstdint>
#include <string>

namespace meshhier::querying {

/// Reads all rows of a text, as read_rows() does. `name` begins messages. Throws Error(input)
/// naming the line.
std::uint64_t read_text_rows(mesh_io::InputStream& stream, const std::string& name, RowKind kind,
                             const RowVisitor& visit);

}  // namespace meshhier::querying
