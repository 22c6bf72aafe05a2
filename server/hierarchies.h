// The hierarchies below a folder: which there are, and their files.
#pragma once

#include "server/build_warnings.h"
#include "server/descriptions.h"
#include "server/kept_archives.h"
#include "server/model.h"
#include "server/story_pictures.h"
#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::server {

/// A file of a hierarchy or a stream.
struct PublishedFile {
  std::shared_ptr<const storage::File> file;
  std::uint64_t archive_offset = 0;  ///< where its content begins; 0 if it lies in a directory
  bool is_tile = false;
  std::string build{};  ///< the name of the build that it belongs to; empty: not known
};

/// Looks at the folder whenever it is asked, and remembers manifests as long as their files stay
/// the same. Nothing outside the folder can be reached. If no file can be opened at this moment,
/// nothing is known, and storage::Busy is thrown. Thread-safe.
class Hierarchies {
 public:
  /// Hears of hierarchies and directories that cannot be read, each once, the first thousand; may
  /// be called by several threads.
  using Tell = std::function<void(const std::string& message)>;

  Hierarchies(std::shared_ptr<const storage::Folder> folder, Tell tell);

  /// Returns all that can be read, by path, with what gallery.json says of them: directories, and
  /// archives whose names end in ".3tz". Directories whose names begin with a dot are work in
  /// progress and left out. Throws Error(io) if the folder itself cannot be listed.
  std::vector<Model> list();

  /// Returns the hierarchy of that path; nothing if there is none, or it is damaged. Throws
  /// Error(io) if its file cannot be opened: there may be one.
  std::optional<Model> look(const std::string& path);

  /// Opens the file of that path, as a URL has it: "sub/david.hier/tiles/00/000000.glb", or a whole
  /// archive, "sub/david.3tz", or a story, "sub/david.3tz.story.json", or a picture beside a story
  /// that names it, "sub/pictures/1.jpg". Returns nothing if it is no file of a hierarchy or stream
  /// that can be read, whatever else lies in the folder. Throws Error(io) if that file, of a
  /// hierarchy that can be read, cannot be opened.
  std::optional<PublishedFile> open(std::string_view path);
  /// Returns the name of the build that is there now; empty if there is none that can be read.
  std::string build_of(const std::string& hierarchy);

 private:
  /// The content of a manifest, an archive or a stream's index, as long as its file is this one.
  struct Known {
    storage::FileVersion version;
    std::optional<Model> model;  ///< none: it cannot be read
  };
  using Read = std::function<Model()>;

  std::optional<Model> look_if_readable(const std::string& path);
  bool is_published(const std::string& hierarchy, const std::string& name);
  std::optional<Model> look_at_directory(const std::string& path);
  std::optional<Model> look_at_archive(const std::string& path);
  /// Throws Error(io) if there is no index, or no tile of the root.
  void require_tiles(const std::string& path) const;
  bool is_stream(const std::string& path);
  std::optional<Model> remember(const std::string& path, const storage::FileVersion& version,
                                const Read& read);
  bool has_story(const std::string& hierarchy);
  /// Returns null if it has none. Throws Error(io).
  std::unique_ptr<storage::File> open_story(const std::string& hierarchy) const;
  std::optional<PublishedFile> open_picture(std::string_view path);
  std::optional<PublishedFile> open_archive(const std::string& path);
  /// Opens a file of a hierarchy, and tells the build that it belongs to.
  std::optional<PublishedFile> open_of_build(const std::string& hierarchy, const std::string& name);
  std::optional<PublishedFile> open_in(const std::string& hierarchy, const std::string& name);
  void tell_left_out(const std::string& cause);
  void tell_once(const std::string& message);
  Model model_of(const std::string& path, const storage::File& manifest) const;

  void describe(std::vector<Model>& models);

  std::shared_ptr<const storage::Folder> folder_;
  Tell tell_;
  StoryPictures pictures_;
  Descriptions descriptions_;
  BuildWarnings warnings_;
  KeptArchives archives_;
  std::mutex mutex_;  ///< guards all below
  std::map<std::string, Known> known_;
  std::set<std::string> told_;
};

}  // namespace meshhier::server
