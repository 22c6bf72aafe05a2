// The table of words of a hierarchy's objects, for those who search by what is within names.
#pragma once

#include "pipeline/plan/stage_context.h"
#include "storage/format/object_table.h"
#include "storage/io/spool.h"

#include <filesystem>
#include <optional>

namespace meshhier::pipeline {

/// Writes the table of words of the names of `objects` into the hierarchy in `directory`; of few
/// objects none. Sorts the words of all names, in `scratch`. None, and a warning, if they are more
/// than a table holds. Throws Error(io | budget | interrupted).
std::optional<storage::ObjectTableFacts> make_object_words(const storage::ObjectTable& objects,
                                                           const std::filesystem::path& directory,
                                                           storage::ScratchFile& scratch,
                                                           const StageContext& context);

}  // namespace meshhier::pipeline
