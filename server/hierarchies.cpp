#include "server/hierarchies.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "progressive/stream_index.h"
#include "server/folder_scan.h"
#include "storage/format/archive_files.h"
#include "storage/format/build_name.h"
#include "storage/format/layout.h"
#include "storage/format/manifest.h"
#include "storage/format/sealed_json.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;  // a second has so many

/// Clients may ask for names without end in a directory that cannot be read: each is a message.
constexpr std::size_t kMostTold = 1000;
constexpr std::size_t kMostNamedBytes = 200;  // bytes of a name in a message

std::string name_of(const std::filesystem::path& path) {
  const bool is_usual = path.extension() == ".hier" || is_archive_name(path.native());
  return (is_usual ? path.stem() : path.filename()).string();
}

/// The parts of a URL's path: the hierarchy and the name of a file in it.
struct Split {
  std::string hierarchy;
  std::string name;
};

/// Splits a path whose file's name has so many parts.
std::optional<Split> split_behind(std::string_view path, std::size_t parts) {
  std::size_t begin = path.size();
  for (std::size_t part = 0; part < parts; ++part) {
    if (begin == 0)
      return std::nullopt;
    const std::size_t slash = path.rfind('/', begin - 1);
    begin = slash == std::string_view::npos ? 0 : slash;
  }
  const bool is_whole = begin == 0;
  return Split{std::string(path.substr(0, begin)),
               std::string(path.substr(is_whole ? 0 : begin + 1))};
}

/// Splits a path. Names of files have one part or three.
std::optional<Split> split(std::string_view path) {
  for (const std::size_t parts : {1U, 3U}) {
    std::optional<Split> found = split_behind(path, parts);
    if (found && (storage::is_hierarchy_file(found->name) || storage::is_stream_file(found->name)))
      return found;
  }
  return std::nullopt;
}

}  // namespace

Hierarchies::Hierarchies(std::shared_ptr<const storage::Folder> folder, Tell tell)
    : folder_(std::move(folder)),
      tell_(std::move(tell)),
      pictures_(folder_),
      descriptions_(folder_, [this](const std::string& message) { tell_once(message); }),
      warnings_(folder_) {}

std::vector<Model> Hierarchies::list() {
  const FolderScan scan = scan_folder(*folder_);
  if (!scan.is_complete)
    tell_once(
        fmt::format("{}: too many directories; not all are listed", folder_->path().string()));
  for (const std::string& failure : scan.failures)
    tell_left_out(failure);
  std::vector<Model> models;
  for (const std::string& path : scan.hierarchies) {
    if (std::optional<Model> model = look_if_readable(path)) {
      model->has_story = has_story(path);
      model->warnings = warnings_.of(*model);
      models.push_back(std::move(*model));
    }
  }
  std::sort(models.begin(), models.end(),
            [](const Model& a, const Model& b) { return a.path < b.path; });
  describe(models);
  return models;
}

/// Adds what people say of models, which are sorted by path. What they say of others is told.
void Hierarchies::describe(std::vector<Model>& models) {
  const std::shared_ptr<const DescriptionTable> table = descriptions_.read();
  for (const auto& [path, said] : *table) {
    const auto model = std::ranges::lower_bound(models, path, {}, &Model::path);
    if (model == models.end() || model->path != path) {
      tell_once(fmt::format("{}: {}: there is no such model; not used",
                            (folder_->path() / kDescriptionsName).string(),
                            plain_text(path, kMostNamedBytes)));
      continue;
    }
    model->title = said.title;
    model->folder = said.folder;
    model->tags = said.tags;
    if (said.place)
      model->place = said.place;
  }
}

std::optional<PublishedFile> Hierarchies::open(std::string_view path) {
  if (is_archive_name(path))
    return open_archive(std::string(path));
  if (const auto told = storage::told_of(path)) {
    std::shared_ptr<const storage::File> story = open_story(std::string(*told));
    if (!story || !look_if_readable(std::string(*told)))
      return std::nullopt;
    return PublishedFile{std::move(story)};
  }
  const std::optional<Split> found = split(path);
  if (found && is_published(found->hierarchy, found->name))
    return open_of_build(found->hierarchy, found->name);
  return open_picture(path);
}

std::string Hierarchies::build_of(const std::string& hierarchy) {
  const std::optional<Model> model = look_if_readable(hierarchy);
  return model ? model->build : std::string();
}

// Another build may take the place of one at any moment: a file that is opened between two looks at
// the manifest belongs to the build that both saw.
std::optional<PublishedFile> Hierarchies::open_of_build(const std::string& hierarchy,
                                                        const std::string& name) {
  const std::string before = build_of(hierarchy);
  std::optional<PublishedFile> file = open_in(hierarchy, name);
  if (file && build_of(hierarchy) == before)
    file->build = before;
  return file;
}

std::optional<PublishedFile> Hierarchies::open_picture(std::string_view path) {
  const std::vector<std::string> tellers = pictures_.tellers_of(path);
  const bool is_told = std::ranges::any_of(tellers, [this](const std::string& hierarchy) {
    return look_if_readable(hierarchy).has_value();
  });
  std::shared_ptr<const storage::File> picture = is_told ? folder_->open(path) : nullptr;
  return picture ? std::optional(PublishedFile{std::move(picture)}) : std::nullopt;
}

bool Hierarchies::has_story(const std::string& hierarchy) {
  try {
    return open_story(hierarchy) != nullptr;
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error& error) {
    tell_left_out(error.what());
    return false;
  }
}

std::unique_ptr<storage::File> Hierarchies::open_story(const std::string& hierarchy) const {
  if (hierarchy.empty())
    return nullptr;  // files beside the folder are not served
  auto story = folder_->open(storage::story_path(hierarchy).generic_string());
  return story && story->size() <= storage::kMostStoryBytes ? std::move(story) : nullptr;
}

std::optional<PublishedFile> Hierarchies::open_archive(const std::string& path) {
  if (!look_if_readable(path))
    return std::nullopt;
  std::shared_ptr<const storage::File> file = folder_->open(path);
  if (!file)
    return std::nullopt;
  return PublishedFile{std::move(file)};
}

bool Hierarchies::is_published(const std::string& hierarchy, const std::string& name) {
  if (storage::is_hierarchy_file(name))
    return look_if_readable(hierarchy).has_value();
  try {
    return is_stream(hierarchy);
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error& error) {
    tell_left_out(error.what());
    return false;
  }
}

std::optional<PublishedFile> Hierarchies::open_in(const std::string& hierarchy,
                                                  const std::string& name) {
  const bool is_tile = storage::tile_of(name).has_value();
  if (is_archive_name(hierarchy)) {
    if (std::unique_ptr<storage::File> file = folder_->open(hierarchy)) {
      const auto opened = archives_.get(hierarchy, std::move(file));
      const auto place = opened->find(name);
      if (!place)
        return std::nullopt;
      const std::filesystem::path path = opened->file().path() / name;
      return PublishedFile{storage::open_archived(path, opened->shared_file(), *place),
                           place->offset, is_tile};
    }
  }
  std::shared_ptr<const storage::File> file = folder_->open(joined(hierarchy, name));
  if (!file)
    return std::nullopt;
  return PublishedFile{std::move(file), 0, is_tile};
}

std::optional<Model> Hierarchies::look(const std::string& path) {
  std::optional<Model> model = look_at_directory(path);
  if (!model && is_archive_name(path))
    model = look_at_archive(path);
  return model;
}

std::optional<Model> Hierarchies::look_if_readable(const std::string& path) {
  try {
    return look(path);
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error& error) {
    tell_left_out(error.what());
    return std::nullopt;
  }
}

std::optional<Model> Hierarchies::look_at_directory(const std::string& path) {
  const auto manifest = folder_->open(joined(path, storage::manifest_path({}).string()));
  if (!manifest)
    return std::nullopt;
  return remember(path, manifest->version(), [&] {
    Model model = model_of(path, *manifest);
    require_tiles(path);
    return model;
  });
}

// A copy that is not complete may lack tiles. All of them would be too many to look at.
void Hierarchies::require_tiles(const std::string& path) const {
  for (const auto& file : {storage::index_path({}), storage::tile_path({}, NodeId{Level{0}, 0})}) {
    const std::string name = joined(path, file.generic_string());
    if (!folder_->open(name)) {
      throw Error(ErrorCode::io, fmt::format("{} is not there: the hierarchy is not complete",
                                             (folder_->path() / name).string()));
    }
  }
}

std::optional<Model> Hierarchies::look_at_archive(const std::string& path) {
  auto file = folder_->open(path);
  if (!file)
    return std::nullopt;
  const storage::FileVersion version = file->version();
  return remember(path, version, [&] {
    const auto opened = archives_.get(path, std::move(file));
    const std::string name = storage::manifest_path({}).string();
    const auto place = opened->find(name);
    if (!place) {
      throw Error(ErrorCode::corrupt, fmt::format("{}: it holds no {}: it is no hierarchy",
                                                  opened->file().path().string(), name));
    }
    const auto manifest =
        storage::open_archived(opened->file().path() / name, opened->shared_file(), *place);
    return model_of(path, *manifest);
  });
}

bool Hierarchies::is_stream(const std::string& path) {
  const auto index = folder_->open(joined(path, storage::progressive_index_path({}).string()));
  if (!index)
    return false;
  const auto read = [&] {
    progressive::parse_progressive_index(storage::read_sealed_text(*index), index->path().string());
    return Model{.path = path};
  };
  return remember(joined(path, storage::progressive_index_path({}).string()), index->version(),
                  read)
      .has_value();
}

std::optional<Model> Hierarchies::remember(const std::string& path,
                                           const storage::FileVersion& version, const Read& read) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(path);
    if (found != known_.end() && found->second.version == version)
      return found->second.model;
  }
  Known known{version, std::nullopt};
  try {
    known.model = read();
    known.model->modified = version.modified_ns / kNanoseconds;
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error& error) {
    tell_left_out(error.what());
    if (error.code() == ErrorCode::io)
      return std::nullopt;  // a disk may come back
  }
  const std::lock_guard lock(mutex_);
  known_[path] = known;
  return known.model;
}

Model Hierarchies::model_of(const std::string& path, const storage::File& file) const {
  const std::string text = storage::read_sealed_text(file);
  const storage::Manifest manifest = storage::parse_manifest(text, file.path().string());
  const bool is_alone = manifest.source.files.empty();
  Model model{path,
              name_of(path.empty() ? folder_->path() : std::filesystem::path(path)),
              manifest.source.file_name,
              manifest.source.vertices,
              manifest.source.triangles,
              manifest.total_bytes,
              is_alone ? manifest.source.file_bytes : manifest.source.files[0].bytes,
              is_alone ? manifest.source.checksum : manifest.source.files[0].checksum,
              manifest.source.checksum,
              manifest.preview.has_value()};
  model.build = storage::build_name(text);
  model.place = place_on_globe(manifest);
  return model;
}

void Hierarchies::tell_left_out(const std::string& cause) {
  tell_once("not shown: " + cause);
}

void Hierarchies::tell_once(const std::string& message) {
  {
    const std::lock_guard lock(mutex_);
    if (told_.size() >= kMostTold || !told_.insert(message).second)
      return;
  }
  tell_(message);
}

}  // namespace meshhier::server
