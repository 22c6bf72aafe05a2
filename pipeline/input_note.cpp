#include "pipeline/input_note.h"

#include "base/error.h"
#include "storage/format/noted_files.h"
#include "storage/io/file_checksum.h"
#include "storage/io/json_text.h"
#include "storage/io/zip_files.h"

#include <optional>
#include <set>
#include <string>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Returns the checksum of an archive; 0, which nothing has, if it is not what it was when it was
/// read.
std::uint64_t read_checksum(const fs::path& archive, const storage::FileIdentity& was,
                            storage::FileSystem& files, const std::function<void()>& check) {
  try {
    const auto file = files.open(archive);
    return storage::is_untouched(files.identity(archive), was)
               ? storage::FileChecksum(was.bytes).complete(*file, check)
               : 0;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::io)
      throw;
    return 0;  // the hierarchy is made by now
  }
}

/// Returns a file, or the archive that it lies in, as it was when it was read.
storage::NotedFile noted(const importing::ReadFile& file, storage::FileSystem& files,
                         const std::function<void()>& check) {
  const auto archive = storage::archive_around(files, file.path);
  if (!archive)
    return {file.path, file.identity, file.checksum};
  storage::FileIdentity identity = file.identity;  // its times are the archive's
  identity.bytes = files.identity(*archive).bytes;
  return {*archive, identity, read_checksum(*archive, identity, files, check)};
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
                           const config::Config& config, storage::FileSystem& files,
                           const std::function<void()>& check) {
  const NotePaths paths(input.files[0].path, files);
  storage::InputNote note{.content = content, .files = {}, .awaited = {}};
  std::set<fs::path> known;
  for (const importing::ReadFile& file : input.files) {
    const fs::path path = paths(file.path);
    if (!known.insert(path).second)
      continue;
    note.files.push_back(noted(file, files, check));
    note.files.back().path = path;
  }
  for (const fs::path& place : input.awaited)
    note.awaited.push_back(paths(place));
  note.build = build_key(config, paths);
  return note;
}

}  // namespace meshhier::pipeline
