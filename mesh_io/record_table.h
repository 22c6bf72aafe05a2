// Tables beside a mesh, as streams of records: CSV and JSON lines.
#pragma once

#include "hierarchy/object_row.h"
#include "mesh_io/input_stream.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace meshhier::mesh_io {

/// A value of a record, under its column's name.
struct RecordField {
  std::string column;
  ObjectValue value;
};

struct RecordCounts {
  std::uint64_t records = 0;
  std::uint64_t foreign = 0;  ///< of CSV: fields that are no UTF-8
  std::uint64_t ragged = 0;   ///< of CSV: records with more or fewer fields than the first line
  std::uint64_t first_ragged = 0;  ///< its line
};

/// How to take the texts of a record: as such, or, of CSV, as anything that they may mean, with
/// decimal points or, unless commas stand between fields, perhaps with decimal commas.
enum class RecordTexts : std::uint8_t { texts, any, any_with_commas };

/// Takes the fields of a record; columns of CSV are always the same, in the same order. Texts are
/// UTF-8.
using RecordVisitor = std::function<void(std::span<const RecordField> fields, RecordTexts texts)>;

/// Reads
///
///   CSV (RFC 4180)   a line of columns' names, then a line a record; between fields stands a
///                    comma, semicolon or tab, whichever the first line has most of, or what a
///                    line "sep=;" ahead of it says; fields in quotes may have these, line ends,
///                    and two quotes for one; an empty field is no value
///   JSON lines       an object a line: numbers, booleans, texts; others as text of JSON; null is
///                    no value. Of a feature of GeoJSON its id and its properties, without its
///                    geometry
///
/// A text that begins with "{" is JSON. Empty lines are passed over. UTF-16 with a byte order mark
/// is read, too; bytes that are no UTF-8 are those of Windows-1252. Memory: a record, up to 4 MiB.
/// Throws Error(input) naming the line, Error(io).
RecordCounts read_records(InputStream& stream, const std::filesystem::path& path,
                          const RecordVisitor& visit);

}  // namespace meshhier::mesh_io
