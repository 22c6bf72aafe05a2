#include "pipeline/object_words.h"

#include "import/word_rows.h"
#include "storage/format/layout.h"
#include "storage/format/object_words.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace meshhier::pipeline {

std::optional<storage::ObjectTableFacts> make_object_words(const storage::ObjectTable& objects,
                                                           const std::filesystem::path& directory,
                                                           storage::ScratchFile& scratch,
                                                           const StageContext& context) {
  constexpr std::uint64_t kMostWordSortBytes = std::uint64_t{64} << 20;
  if (objects.size() < storage::kLeastIndexedObjects)
    return std::nullopt;
  const auto path = storage::object_words_path(directory);
  const auto file = context.files.create(path);
  storage::ObjectTableWriter writer(*file, storage::word_properties());
  const storage::LetterTable table(storage::kLetterTable, path.string());
  writer.add(storage::letters_row());
  std::uint64_t rows = 1;
  const std::uint64_t sort_bytes = std::min(context.memory().work_bytes / 4, kMostWordSortBytes);
  importing::for_each_word_row(objects, table, {scratch, sort_bytes, context.cancel},
                               [&](ObjectRow row) {
                                 if (++rows <= kMostObjects)
                                   writer.add(std::move(row));
                               });
  if (rows <= kMostObjects)
    return writer.finish();
  context.files.remove_all(path);
  context.progress.warn(
      "the names of objects have too many different words: they are found by "
      "their beginnings only");
  return std::nullopt;
}

}  // namespace meshhier::pipeline
