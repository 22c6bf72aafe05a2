// The list of a mesh's objects: each name once, ascending, with its properties.
//
// Problem. Readers found names in whatever order, the same one perhaps several times; a table knows
// more about some of them. Millions of names and rows do not fit into memory.
//
// Idea. Sort and merge, as data bases join:
//
//     found, by key            table, by key            joined, by name
//     "12"  number 0           "12"  Town hall, 1911    "Mill"            3 -> 0
//     "7"   number 1     +     "40"  Mill, 1850      =  "Mill (7)"        1 -> 1
//     "12"  number 2           "7"   Mill, 1902         "Town hall"  0, 2 -> 2
//     "40"  number 3
//
// A key is the id by which a table knows an object, or its name. Ids may give several objects the
// same name: all but one of them get their id behind it.
//
// Invariant. Objects are numbered from 0 on, ascending by name. Of values that are said twice the
// first one counts, and the table's before others.
//
// Cost. Two to four sorts of the names with their values; memory as ImportRoom says.
#pragma once

#include "import/object_names.h"
#include "import/property_table.h"
#include "storage/format/object_table.h"
#include "storage/io/file.h"

#include <cstdint>
#include <optional>
#include <string>

namespace meshhier::importing {

struct ObjectList {
  explicit ObjectList(storage::ScratchFile& scratch) : numbers(scratch, kImportSpoolBytes) {}

  storage::ObjectTableFacts facts;
  /// The number in the list of each that a reader gave.
  storage::RecordSpool<std::uint32_t> numbers;
  std::uint64_t without_row = 0;    ///< objects that the table does not know
  std::string first_without_row{};  ///< what it would be called there
};

/// Fills the list, and `file` with it. `types`: of values of `table` that were noted; null: there
/// is no table. Throws Error(input) if there are more objects than a list may have, or an object
/// has too much text, Error(io), Error(interrupted).
void list_objects(const MeshObjects& objects, PropertyTable* table, PropertyTypes& types,
                  storage::File& file, ObjectList& list, const ImportRoom& room);

}  // namespace meshhier::importing
