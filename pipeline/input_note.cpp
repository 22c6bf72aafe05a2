#include "pipeline/input_note.h"

#include "storage/io/json_text.h"
#include "storage/io/zip_files.h"

#include <optional>
#include <set>
#include <string>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Returns a file, or the archive that it lies in, whose checksum nobody knows: if that is touched,
/// it counts as another one.
storage::NotedFile noted(const importing::ReadFile& file, storage::FileSystem& files) {
  if (const auto archive = storage::archive_around(files, file.path))
    return {*archive, files.identity(*archive), 0};
  return {file.path, file.identity, file.checksum};
}

fs::path on_disk(const fs::path& path, storage::FileSystem& files) {
  return storage::archive_around(files, path).value_or(path);
}

}  // namespace

NotePaths::NotePaths(const fs::path& first, storage::FileSystem& files)
    : files_(files), folder_(on_disk(first, files).parent_path()) {}

fs::path NotePaths::operator()(const fs::path& path) const {
  const fs::path file = on_disk(path, files_);
  const fs::path relative = file.lexically_relative(folder_);
  return relative.empty() ? file : relative;
}

Json build_key(const config::Config& config, const NotePaths& paths) {
  Json input = Json::array();
  for (const fs::path& path : config::read_by(config))
    input.push_back(paths(path).string());
  const Json key{{"program", "meshhier " MESHHIER_VERSION},
                 {"input", std::move(input)},
                 {"drapes", !config.texture.drape.empty()},
                 {"has_table", !config.objects.table.empty()},
                 {"config", config::resolved_json(config)}};
  return storage::parse_ordered_json_text(storage::json_text(key));
}

storage::InputNote note_of(const importing::InputRecord& input, std::uint64_t content,
                           const config::Config& config, storage::FileSystem& files) {
  const NotePaths paths(input.files[0].path, files);
  storage::InputNote note{.content = content, .files = {}, .awaited = {}};
  std::set<fs::path> known;
  for (const importing::ReadFile& file : input.files) {
    storage::NotedFile one = noted(file, files);
    one.path = paths(one.path);
    if (known.insert(one.path).second)
      note.files.push_back(std::move(one));
  }
  for (const fs::path& place : input.awaited)
    note.awaited.push_back(paths(place));
  note.build = build_key(config, paths);
  return note;
}

}  // namespace meshhier::pipeline
