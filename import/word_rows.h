// The rows of a table of words, made from names.
//
// Problem. Words come by object, and are wanted by word; neither names nor words fit into memory.
//
// Idea. Each word of each name is a row of a sort that keeps the order of equal words; objects that
// come one after the other are one row of the table, up to its length.
//
// Cost. O(n log n) comparisons of words, in the memory of the sort; about 20 bytes of scratch for a
// word of a name.
#pragma once

#include "hierarchy/object_row.h"
#include "import/import_room.h"
#include "storage/format/folded_words.h"
#include "storage/format/object_table.h"

#include <cstdint>
#include <functional>

namespace meshhier::importing {

/// Hands the rows of the words of all objects to `visit`, in the order that the table of words has
/// behind its first row (storage/format/object_words.h). They follow from the names and `letters`
/// alone. Sorts in `room.sort_bytes`. Throws what `visit` throws, Error(corrupt | io |
/// interrupted).
void for_each_word_row(const storage::ObjectTable& objects, const storage::LetterTable& letters,
                       const ImportRoom& room, const std::function<void(ObjectRow row)>& visit);

}  // namespace meshhier::importing
