// The directory a hierarchy is built in: beside the output, complete before it takes the output's
// name. It outlives a build that is stopped, so that the next one can go on.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace meshhier::storage {

/// The form of an output.
enum class Container {
  files,    ///< a directory
  archive,  ///< one file (storage/format/archive_format.h)
};

/// The kind of an output: only its own kind is replaced.
enum class OutputContent { hierarchy, progressive_stream };

/// The place and kind of an output.
struct Output {
  // NOLINTNEXTLINE(google-explicit-constructor): a path is a directory unless more is said
  Output(std::filesystem::path where, Container in = Container::files,
         OutputContent what = OutputContent::hierarchy)
      : path(std::move(where)), container(in), content(what) {}

  std::filesystem::path path;
  Container container;
  OutputContent content;
};

/// Returns the path that a link of that name leads to; the name itself if it is no link.
std::filesystem::path followed(FileSystem& files, const std::filesystem::path& output);

/// Returns the directory nearest above `output` that is there.
std::filesystem::path existing_directory(FileSystem& files, const std::filesystem::path& output);

/// Throws Error(io) if it is clear already that nothing can be made where `output` is to be.
void check_place(FileSystem& files, const std::filesystem::path& output);

/// Throws Error(usage) if the output lies in a hierarchy: it would be damage to that, and go when
/// it is replaced. `output` must not be standard output.
void require_outside(FileSystem& files, const std::filesystem::path& output);

/// Whether there is an output. Throws as require_outside(); Error(exists) if there is one and
/// `replace` is false, or if it is not of the same content and container; `state` says how it comes
/// to be there.
bool check_output(FileSystem& files, const Output& output, bool replace,
                  const char* state = "is already there");

/// Makes a work directory if need be and locks it; returns nothing if it is locked, or if somebody
/// removes it at that moment. Throws Error(io).
std::unique_ptr<FileLock> take_work(FileSystem& files, const std::filesystem::path& work);

/// Removes a work directory that the caller has locked, and lets go of the lock. A build that takes
/// the directory at that moment keeps it. Throws Error(io).
void remove_work(FileSystem& files, const std::filesystem::path& work,
                 std::unique_ptr<FileLock> lock);

/// A locked work directory: no other process builds the output meanwhile. One thread at a time may
/// use it; `files` must outlive it.
class WorkDirectory {
 public:
  /// Takes the directory as an earlier build left it, or makes it; waits up to 3 s for a process
  /// that is just ending, and calls `check` meanwhile, which may throw. Throws as check_output();
  /// Error(locked) if another build is at work here; Error(io) if its parent cannot be written, or
  /// the directory is a link.
  WorkDirectory(
      FileSystem& files, Output output, bool replace, const std::function<void()>& check = [] {});
  /// Takes the directory `shared`, on the output's file system, in which several processes have
  /// built: it stays when it is published, but for the hierarchy. Throws Error(locked) if another
  /// process has it.
  WorkDirectory(FileSystem& files, Output output, bool replace, std::filesystem::path shared);
  WorkDirectory(const WorkDirectory&) = delete;
  WorkDirectory& operator=(const WorkDirectory&) = delete;
  /// Removes the directory and all in it, and an output that was replaced; directories made above
  /// it, too, if nothing was published. A kept one stays, and of a shared one all but the hierarchy
  /// that was published.
  ~WorkDirectory();

  const std::filesystem::path& path() const {
    return path_;
  }                                      ///< for the journal and scratch files
  std::filesystem::path built() const;   ///< the hierarchy to be, in path()
  std::filesystem::path packed() const;  ///< its archive to be, in path()

  /// Removes all that is in it, but for an imported mesh with its objects, and the lock: nothing is
  /// left to be kept.
  void clear();
  /// Says whether its content stays when the object goes without having been published. What a
  /// stopped build left stays until more is said: it is known by its journal.
  void keep(bool kept) { kept_ = kept; }
  bool is_kept() const { return kept_; }

  /// Syncs, and gives the hierarchy, or its archive, the output's name; no other process may build
  /// the output until the object goes. A replaced output has that name until then, without a gap
  /// where the system can exchange two names. Throws Error(io), and Error(exists) if an output
  /// appeared that is not to be replaced; all names are then as they were before.
  void publish();

 private:
  void sync_result();
  void remove_rest();
  // Three ways to give the result its name; each is undone if it fails.
  void give_name(const std::filesystem::path& from);
  bool exchange(const std::filesystem::path& from);  ///< false if the system cannot
  void replace(const std::filesystem::path& from);
  std::filesystem::path set_aside();  ///< renames the journal while names are exchanged
  void restore_journal();             ///< if a build was killed then, and the journal is still true
  void sync_names();

  FileSystem& files_;
  Output output_;
  std::filesystem::path path_;
  /// The directories above the output that were not there before, the lowest first.
  std::vector<std::filesystem::path> made_parents_;
  std::unique_ptr<FileLock> lock_;
  bool replace_;
  bool is_shared_ = false;
  bool kept_ = false;
  bool published_ = false;
};

}  // namespace meshhier::storage
