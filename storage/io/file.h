// The one I/O seam: every system call for files is behind these two classes, and behind Folder
// (folder.h).
//
// Tests derive from them to inject a full disk, a short write or a failed sync.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// What tells a file from any other, and from what it was before. Where a file system does not
/// tell, numbers are 0.
struct FileVersion {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< since 1970
  std::int64_t changed_ns = 0;   ///< likewise: when content, name or rights last changed
  friend bool operator==(const FileVersion&, const FileVersion&) = default;
};

/// An open file, read and written at explicit offsets. Thread-safe for disjoint ranges.
class File {
 public:
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  virtual ~File() = default;

  const std::filesystem::path& path() const { return path_; }

  /// Bytes in the file now. Throws Error(io).
  virtual std::uint64_t size() const = 0;
  /// Throws Error(io).
  virtual FileVersion version() const { return {.bytes = size()}; }
  /// Forces the content to the disk. Throws Error(io).
  virtual void sync() = 0;
  /// The same in steps of at most some tenths of a second, before each of which `check` is called;
  /// it may throw. For large files.
  void sync(const std::function<void()>& check);
  /// What will be read soon, in that order, as it will be asked for: a hint.
  struct Range {
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
    friend bool operator==(const Range&, const Range&) = default;
  };
  virtual void will_read(std::span<const Range> /*ranges*/) const {}
  /// Lets the disk begin with what was written, so that a later sync() has less to wait for.
  void start_sync() { write_out(0, 0, Wait::no); }

  /// Reads up to bytes.size() at `offset`; returns how many, fewer only at the end of the file.
  std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Reads exactly bytes.size(); throws Error(io) naming the offset if the file ends before.
  void read_exact(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Writes all of `bytes` at `offset`, whatever number of calls it takes. Throws Error(io).
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);

 protected:
  explicit File(std::filesystem::path path) : path_(std::move(path)) {}

  /// One system call each: may transfer less than asked, 0 on end of file; throws Error(io).
  virtual std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
  virtual std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) = 0;
  /// Moves a range (0 bytes: up to the end) from the system's cache to the disk. A hint: failures
  /// are sync()'s to tell.
  enum class Wait { no, yes };
  virtual void write_out(std::uint64_t /*offset*/, std::uint64_t /*bytes*/, Wait /*wait*/) {}

 private:
  std::filesystem::path path_;
};

/// What tells a file from another version of it without reading it.
struct FileIdentity {
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< since 1970
  std::int64_t changed_ns = 0;   ///< as FileVersion's: a new link to the file changes it, too

  /// But for `changed_ns`.
  friend bool operator==(const FileIdentity& a, const FileIdentity& b) {
    return a.bytes == b.bytes && a.modified_ns == b.modified_ns;
  }
};

/// A lock is held as long as its object is there, and not beyond the end of the process, whatever
/// ends it: there is no stale one. Its file goes with it unless the process is killed.
class FileLock {
 public:
  FileLock() = default;
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  virtual ~FileLock() = default;
};

/// What a path leads to, links followed.
enum class FileKind {
  none,
  regular,
  directory,
  stream,           ///< a FIFO or a character device
  standard_output,  ///< of this process, whatever it is
  other
};

/// Bytes moved through a FileSystem since it was made.
struct IoCounters {
  std::atomic<std::uint64_t> bytes_read{0};
  std::atomic<std::uint64_t> bytes_written{0};
};

/// Opens files and changes directories. Every failure throws Error(io) with path and cause.
class FileSystem {
 public:
  virtual ~FileSystem() = default;

  virtual std::unique_ptr<File> open(const std::filesystem::path& path) = 0;
  /// Makes or empties the file, for reading and writing.
  virtual std::unique_ptr<File> create(const std::filesystem::path& path) = 0;
  /// Opens a file that is there for reading and writing, with all that is in it.
  virtual std::unique_ptr<File> reopen(const std::filesystem::path& path) = 0;

  /// A stream, or standard output ("/dev/stdout", or a path that leads to it), for writing from the
  /// first byte to the last. Waits until a FIFO has a reader; calls `check` before each wait, here
  /// and in each write: it may throw.
  virtual std::unique_ptr<File> open_stream(const std::filesystem::path& path,
                                            const std::function<void()>& check) = 0;

  virtual FileIdentity identity(const std::filesystem::path& path) = 0;
  /// Makes the file if need be and locks it; null if it is locked already, here or elsewhere.
  virtual std::unique_ptr<FileLock> try_lock(const std::filesystem::path& path) = 0;

  virtual bool exists(const std::filesystem::path& path) = 0;
  virtual FileKind kind(const std::filesystem::path& path) = 0;
  bool is_directory(const std::filesystem::path& path) { return kind(path) == FileKind::directory; }
  /// A symbolic link, wherever it leads; systems without links have none.
  virtual bool is_link(const std::filesystem::path& /*path*/) { return false; }
  /// The absolute path without links and dots, as far as it exists; of a link to nothing, where it
  /// leads to.
  virtual std::filesystem::path canonical(const std::filesystem::path& path) = 0;
  /// Every file below `directory`, links as themselves; ascending.
  virtual std::vector<std::filesystem::path> list(const std::filesystem::path& directory) = 0;
  /// Whether that can be told of a directory.
  virtual bool can_list(const std::filesystem::path& /*directory*/) { return true; }
  /// Files and directories directly in `directory`; ascending.
  virtual std::vector<std::filesystem::path> children(const std::filesystem::path& directory) = 0;
  virtual void make_directories(const std::filesystem::path& path) = 0;
  /// Removes a file or a whole tree; nothing happens if it is not there.
  virtual void remove_all(const std::filesystem::path& path) = 0;
  /// Renames a file or directory; an existing file of that name is replaced.
  virtual void rename(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  /// The same, but nothing is replaced: false if there is something of that name.
  virtual bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  /// Each of two files or directories gets the name of the other, at one moment; false if the
  /// system cannot.
  virtual bool exchange(const std::filesystem::path& a, const std::filesystem::path& b) = 0;
  /// Forces the names in a directory to the disk.
  virtual void sync_directory(const std::filesystem::path& directory) = 0;
  /// Forces everything written to the file system that holds `directory` to the disk.
  virtual void sync_tree(const std::filesystem::path& directory) = 0;
  /// Bytes free for this user on the file system that holds `directory`.
  virtual std::uint64_t free_bytes(const std::filesystem::path& directory) = 0;
  /// Why no file can be made in that directory, as far as it can be known before: "Permission
  /// denied"; empty if nothing speaks against it.
  virtual std::string why_not_writable(const std::filesystem::path& /*directory*/) { return ""; }

  /// Whole files that will be read soon, in that order: a hint.
  virtual void will_read(std::span<const std::filesystem::path> /*files*/) {}

  /// The one to read a mesh with, and what a mesh names. It may refuse links, and what lies
  /// elsewhere.
  virtual FileSystem& input() { return *this; }

  const IoCounters& counters() const { return *counters_; }

 protected:
  std::shared_ptr<IoCounters> counters_ = std::make_shared<IoCounters>();
};

/// What FileSystem::input() opens and looks at.
struct InputRule {
  bool follows_links = true;  ///< else no part of a path may be a link, at whatever moment
  /// Nothing that lies elsewhere, and no link below it; the folder itself may be one, its path is
  /// taken without "..", and so are those of files.
  std::optional<std::filesystem::path> within{};
};

/// The real one. What input() refuses is Error(io) or, where it is looked for, not there.
std::unique_ptr<FileSystem> make_posix_file_system(const InputRule& input = {});

/// Of all files below `directory`. Throws Error(io).
std::uint64_t bytes_below(FileSystem& files, const std::filesystem::path& directory);

/// A whole file in memory. `limit_bytes` guards what is allocated: a larger file throws
/// Error(corrupt).
std::vector<std::byte> read_file(const File& file, std::uint64_t limit_bytes);
std::vector<std::byte> read_file(FileSystem& files, const std::filesystem::path& path,
                                 std::uint64_t limit_bytes);
/// Creates `path` with exactly `bytes`.
void write_file(FileSystem& files, const std::filesystem::path& path,
                std::span<const std::byte> bytes);

}  // namespace meshhier::storage
