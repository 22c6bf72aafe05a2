// Whether hierarchies are made of the files that lie in an inbox now.
#pragma once

#include "execution/cancel.h"
#include "server/inbox.h"
#include "server/input_notes.h"
#include "server/model.h"
#include "storage/format/input_note.h"
#include "storage/format/noted_files.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::server {

/// Meshes are named as in the inbox. For one thread.
class Sources {
 public:
  using Warn = std::function<void(const std::string& message)>;
  /// Whether a file is read whose times are not those that were noted.
  enum class Unknown { is_read, is_another };

  /// `warn` hears why a note could not be written: without it, files are only read once more. All
  /// that is referred to must outlive this.
  Sources(const Inbox& inbox, const InputNotes& notes, const execution::CancelToken& cancel,
          Warn warn);

  /// Whether the hierarchy was made of this version of the mesh and of all that belongs to it. A
  /// mesh that was built by hand is compared alone. Throws Error(io), Error(input) if the mesh
  /// changes while it is read, Error(interrupted).
  bool is_made_of(const std::string& mesh, const storage::FileVersion& version, const Model& model,
                  Unknown unknown);
  /// Whether the mesh is still of that version; false if nobody can tell.
  bool is_still(const std::string& mesh, const storage::FileVersion& version) const;

  /// Returns storage::NotedFiles::mark() of what belongs to a mesh, as it is now; 0 until
  /// is_made_of() was asked. Throws Error(io).
  std::uint64_t mark(const std::string& mesh) const;
  /// Returns the same as it was when is_made_of() was last asked.
  std::uint64_t mark_when_asked(const std::string& mesh) const;

  /// Keeps warnings of the build in the note of the hierarchy, which was asked for last of this
  /// mesh.
  void keep_warnings(const std::string& mesh, const Model& model,
                     std::vector<std::string> warnings);

  /// Forgets meshes of which the inbox has no file any more.
  void forget_all_but(const std::vector<InboxFile>& files);

 private:
  /// The note of the hierarchy that was looked at last, and the mark of its files then.
  struct Known {
    storage::InputNote note;
    std::uint64_t mark = 0;
  };
  storage::InputNote note_of(const Model& model) const;
  storage::NotedFiles companions_of(const std::string& mesh) const;
  bool is_noted(const std::string& mesh, const storage::FileVersion& version,
                storage::NotedFile& noted, Unknown unknown) const;
  std::uint64_t read_checksum(const std::string& mesh, const storage::FileVersion& version) const;
  void keep_note(const Model& model, const storage::InputNote& note) const;

  const Inbox& inbox_;
  const InputNotes& notes_;
  const execution::CancelToken& cancel_;
  Warn warn_;
  std::unique_ptr<storage::FileSystem> files_;  ///< its input() leads nowhere else
  std::map<std::string, Known> known_;          ///< by mesh
};

}  // namespace meshhier::server
