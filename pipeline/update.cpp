#include "pipeline/update.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "pipeline/import_stage.h"
#include "pipeline/input_note.h"
#include "pipeline/journal/build_journal.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/noted_files.h"
#include "storage/format/work_directory.h"
#include "storage/io/json_text.h"
#include "storage/io/system_failure.h"

#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestTold = 4096;

/// Returns the manifest of a hierarchy that has it and its index; nothing if they are damaged, or
/// of a format that is not read.
std::optional<storage::Manifest> read_manifest(storage::FileSystem& files, const fs::path& output) {
  try {
    const storage::HierarchyFiles inside(files, output);
    return storage::HierarchyReader(inside.files(), output).manifest();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt && error.code() != ErrorCode::io)
      throw;
    return std::nullopt;
  }
}

/// Writes a note. Without it, files are only read once more.
void keep_note(const fs::path& path, const storage::InputNote& note,
               const BuildEnvironment& environment) {
  try {
    storage::write_input_note(environment.files, path, note);
  } catch (const Error& error) {
    environment.progress.warn(error.what());
  }
}

/// Returns the name of a file as manifests have it: bytes that are no UTF-8 become U+FFFD.
std::string name_in_manifest(const std::string& name) {
  return storage::parse_ordered_json_text(storage::json_text(Json(name))).get<std::string>();
}

/// Returns how the manifest's program and config differ from those of a build; empty if they do
/// not. A manifest has no keys that decided nothing.
std::string other_build(const storage::Manifest& manifest, const Json& key) {
  if (manifest.generator != key.at("program"))
    return fmt::format("{} made it", plain_text(manifest.generator, kLongestTold));
  Json config = key.at("config");
  for (const char* section : {"texture", "missing_images", "normal_map"}) {
    if (!manifest.config.contains(section))
      config.erase(section);
  }
  return differences(manifest.config, config);
}

/// The question whether the files of an input are those that a hierarchy was made of.
class InputQuestion {
 public:
  InputQuestion(const config::Config& config, const BuildEnvironment& environment)
      : environment_(environment),
        config_(config),
        input_(open_input(config, environment.files)),
        paths_(input_.files().all()[0].path, input_.files().system()),
        key_(build_key(config, paths_)) {}

  /// As build_key().
  const Json& key() const { return key_; }

  /// Returns what differs from a note; empty if nothing does.
  std::string difference(storage::InputNote& note, const fs::path& path) const {
    if (note.build != key_)
      return differences(note.build, key_);
    if (const auto unknown = not_in(note))
      return plain_text(unknown->string(), kLongestTold) + " is new";
    const storage::NotedFiles noted(input_.files().system(), paths_.folder());
    const auto result = noted.compare(note, {}, [&] { environment_.cancel.check(); });
    if (result.other)
      return plain_text(result.other->string(), kLongestTold) + " is not what it was";
    if (result.was_read)
      keep_note(path, note, environment_);
    return "";
  }

  /// Does the same without a note, and writes one if nothing differs.
  std::string difference(const SourceSummary& source, const fs::path& path) {
    const importing::InputFiles& files = input_.files();
    if (!source.files.empty() || input_.needs_import())
      return "nothing is noted of its input";
    if (source.file_name != name_in_manifest(files.name()) || source.file_bytes != files.bytes())
      return plain_text(files.name(), kLongestTold) + " is not what it was";
    const std::uint64_t checksum = input_.checksum(environment_.cancel);
    if (checksum != source.checksum)
      return plain_text(files.name(), kLongestTold) + " is not what it was";
    keep_note(path,
              note_of(input_.record(checksum), checksum, config_, files.system(),
                      [&] { environment_.cancel.check(); }),
              environment_);
    return "";
  }

 private:
  /// Returns a file of the input that is not in the note. Files beside a tile that look like finer
  /// ones may be none of its own; those that are missing are awaited.
  std::optional<fs::path> not_in(const storage::InputNote& note) const {
    std::set<fs::path> known;
    for (const storage::NotedFile& file : note.files)
      known.insert(file.path);
    for (const importing::InputFileFacts& mesh : input_.files().all()) {
      if (!known.contains(paths_(mesh.path)))
        return mesh.path;
    }
    for (const importing::CompanionFile& file : input_.files().companions().files()) {
      if (file.part != importing::InputPart::tile && !known.contains(paths_(file.path)))
        return file.path;
    }
    return std::nullopt;
  }

  const BuildEnvironment& environment_;
  const config::Config& config_;
  importing::MeshInput input_;
  NotePaths paths_;
  Json key_;
};

}  // namespace

fs::path input_note_path(const config::Config& config, storage::FileSystem& files) {
  return storage::input_note_path(storage::followed(files, config.output));
}

fs::path followed_note(const config::Config& config, const fs::path& named,
                       storage::FileSystem& files) {
  return named == input_note_path(config, files) ? named : files.canonical(named);
}

std::optional<storage::FileIdentity> state_of_output(const config::Config& config,
                                                     storage::FileSystem& files) {
  const fs::path file =
      files.is_directory(config.output) ? storage::manifest_path(config.output) : config.output;
  try {
    if (files.kind(file) == storage::FileKind::regular)
      return files.identity(file);
  } catch (const storage::NotThere&) {  // it is being replaced
  }
  return std::nullopt;
}

std::string reason_to_build(const config::Config& config, const fs::path& named,
                            const BuildEnvironment& environment) {
  storage::FileSystem& files = environment.files;
  const fs::path note = followed_note(config, named, files);
  const fs::path output = storage::followed(files, config.output);
  if (!storage::check_output(files, {output, config.storage.container}, true))
    return "it is not there";
  const std::optional<storage::Manifest> manifest = read_manifest(files, output);
  if (!manifest)
    return "what is there cannot be read";
  InputQuestion question(config, environment);
  if (std::string difference = other_build(*manifest, question.key()); !difference.empty())
    return difference;
  std::optional<storage::InputNote> noted = storage::find_input_note(files, note);
  if (noted && noted->content == manifest->source.checksum && !noted->build.is_null())
    return question.difference(*noted, note);
  return question.difference(manifest->source, note);
}

}  // namespace meshhier::pipeline
