#include "server/static_site.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/output_name.h"
#include "server/folder_scan.h"
#include "server/gallery.h"
#include "server/hierarchies.h"
#include "storage/format/build_name.h"
#include "storage/format/layout.h"
#include "storage/format/sealed_json.h"
#include "storage/format/story_pictures.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListing = "models.json";
constexpr const char* kPage = "index.html";
/// If a site has this file, GitHub Pages takes its files as they are, whatever their names.
constexpr const char* kAsItIs = ".nojekyll";
/// The longest name of a picture in a message.
constexpr std::size_t kLongestShown = 200;
/// The file of the viewer's folder that is not for a site: `meshhier page` puts a hierarchy into
/// it.
constexpr std::string_view kSingle = "single.html";

/// Returns the names below a folder for which is_wanted(path from it).
std::vector<std::string> names_below(const storage::Folder& folder, const std::string& start,
                                     const std::function<bool(const std::string&)>& is_wanted) {
  std::vector<std::string> names, left{""};
  while (!left.empty()) {
    const std::string below = std::move(left.back());
    left.pop_back();
    for (const storage::FolderEntry& entry : folder.entries(joined(start, below))) {
      const std::string name = joined(below, entry.name);
      if (entry.is_directory)
        left.push_back(name);
      else if (is_wanted(name))
        names.push_back(name);
    }
  }
  std::ranges::sort(names);
  return names;
}

class SiteMaker {
 public:
  SiteMaker(storage::FileSystem& files, const SiteJob& job, const SiteProgress& progress,
            fs::path place)
      : files_(files),
        job_(job),
        progress_(progress),
        place_(std::move(place)),
        hierarchies_(job.models, progress.tell),
        models_(hierarchies_.list()) {}

  std::string run() {
    if (models_.empty()) {
      throw Error(ErrorCode::usage,
                  fmt::format("{}: there is no hierarchy in it", job_.models->path().string()));
    }
    std::vector<Copy> copies = copies_of_viewer();
    for (const Model& model : models_)
      add_copies(model, copies);
    progress_.begin(copies.size());
    for (const Copy& copy : copies) {
      write(copy);
      progress_.copied();
    }
    for (const Model& model : models_) {
      require_unchanged(model);
      if (is_archive_name(model.path) && model.has_preview)
        write_picture(model);
    }
    for (const ListingFile& part : static_gallery_json(models_)) {
      const fs::path to = place_ / part.path;
      files_.make_directories(to.parent_path());
      storage::write_file(files_, to, std::as_bytes(std::span(part.text)));
    }
    storage::write_file(files_, place_ / kAsItIs, {});
    return fmt::format("{}: {}, {} bytes", job_.output.string(), counted(models_.size(), "models"),
                       bytes_);
  }

 private:
  /// A file of a folder, and the path that it goes to.
  struct Copy {
    const storage::Folder* folder = nullptr;
    std::string name, to;
  };

  std::vector<Copy> copies_of_viewer() const {
    std::vector<Copy> copies;
    for (const std::string& name :
         names_below(job_.viewer, "", [](const std::string& file) { return file != kSingle; }))
      copies.push_back({&job_.viewer, name, name});
    return copies;
  }

  void add_copies(const Model& model, std::vector<Copy>& copies) const {
    const std::string to = joined("models", model.path);
    if (model.has_story)
      add_story(model, copies);
    if (is_archive_name(model.path) && job_.models->open(model.path)) {
      copies.push_back({job_.models.get(), model.path, to});
      return;
    }
    for (const std::string& name :
         names_below(*job_.models, model.path,
                     [](const std::string& file) { return storage::is_hierarchy_file(file); }))
      copies.push_back({job_.models.get(), joined(model.path, name), joined(to, name)});
  }

  /// Adds a story with the pictures beside it that it names.
  void add_story(const Model& model, std::vector<Copy>& copies) const {
    const fs::path story = storage::story_path(model.path);
    copies.push_back({job_.models.get(), story.generic_string(), story_beside(model)});
    const auto file = job_.models->open(story.generic_string());
    if (!file)
      return;
    const auto bytes = storage::read_file(*file, storage::kMostStoryBytes);
    for (const std::string& picture :
         storage::pictures_beside({reinterpret_cast<const char*>(bytes.data()), bytes.size()})) {
      const std::string name = joined(story.parent_path().generic_string(), picture);
      if (job_.models->open(name))
        copies.push_back({job_.models.get(), name, joined("models", name)});
      else
        progress_.tell(fmt::format("{} names the picture {}, which is not there", story.string(),
                                   plain_text(picture, kLongestShown)));
    }
  }

  void write(const Copy& copy) {
    const auto from = copy.folder->open(copy.name);
    if (!from)
      throw Error(ErrorCode::io, fmt::format("{} has gone meanwhile", copy.name));
    write(*from, place_ / copy.to);
  }

  /// Throws if the build that was listed is not the one that was copied, or is not there any more:
  /// else all files, of which the manifest was copied first, are of one build.
  void require_unchanged(const Model& model) {
    if (job_.models->open(model.path))
      return;  // an archive is one file
    const fs::path copied = storage::manifest_path(place_ / joined("models", model.path));
    if (!files_.exists(copied) || hierarchies_.build_of(model.path) != model.build ||
        storage::build_name(storage::read_sealed_text(*files_.open(copied))) != model.build) {
      throw Error(ErrorCode::io,
                  fmt::format("{}: another hierarchy has taken its place while it was copied: make "
                              "the site again",
                              model.path));
    }
  }

  void write_picture(const Model& model) {
    const auto picture = hierarchies_.open(joined(model.path, storage::preview_path({}).string()));
    if (picture)
      write(*picture->file, place_ / picture_beside(model));
  }

  void write(const storage::File& from, const fs::path& path) {
    constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
    files_.make_directories(path.parent_path());
    const auto to = files_.create(path);
    std::vector<std::byte> block(kBlockBytes);
    for (std::uint64_t at = 0;;) {
      progress_.check();
      const std::size_t count = from.read_at(at, block);
      to->write_at(at, std::span(block).first(count));
      at += count;
      bytes_ += count;
      if (count < block.size())
        return;
    }
  }

  storage::FileSystem& files_;
  const SiteJob& job_;
  const SiteProgress& progress_;
  fs::path place_;
  Hierarchies hierarchies_;
  std::vector<Model> models_;
  std::uint64_t bytes_ = 0;
};

void require_place(storage::FileSystem& files, const SiteJob& job) {
  storage::require_apart(files, job.output, std::array{job.models->path(), job.viewer.path()});
  const storage::FileKind kind = files.kind(job.output);
  if (kind == storage::FileKind::none)
    return;
  const auto has = [&](const char* name) { return files.exists(job.output / name); };
  if (kind != storage::FileKind::directory || !has(kListing) || !has(kPage))
    throw Error(ErrorCode::exists,
                job.output.string() + " is there, and is no site: name another place");
  if (!job.replace)
    throw Error(ErrorCode::exists, job.output.string() + " is there already; --force replaces it");
}

}  // namespace

std::string write_site(storage::FileSystem& files, const SiteJob& given,
                       const SiteProgress& progress) {
  const SiteJob job{given.models, given.viewer, storage::without_last_slash(given.output),
                    given.replace};
  mesh_io::require_true_ending(
      job.output.string(), {},
      "of a folder page makes a folder, the site; name it without an ending");
  require_place(files, job);
  if (job.output.has_parent_path())
    files.make_directories(job.output.parent_path());
  const auto lock = storage::lock_output(files, job.output, job.output, progress.check);
  const fs::path part = storage::unfinished_path(job.output);
  files.remove_all(part);
  files.make_directories(part);
  try {
    const std::string line = SiteMaker(files, job, progress, part).run();
    files.sync_tree(part);
    if (files.exists(job.output)) {
      require_place(files, job);  // it may have appeared
      if (!files.exchange(part, job.output)) {
        files.remove_all(job.output);
        files.rename(part, job.output);
      }
    } else if (!files.rename_new(part, job.output)) {
      throw Error(ErrorCode::exists, job.output.string() + " has appeared meanwhile");
    }
    files.remove_all(part);
    return line;
  } catch (...) {
    files.remove_all(part);
    throw;
  }
}

}  // namespace meshhier::server
