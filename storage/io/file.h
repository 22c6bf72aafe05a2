// The I/O seam: all data of users, hierarchies and scratch files moves through these two classes,
// and through Folder (folder.h). Beside them there are only system calls that move none of it: for
// processes, temporary directories, names of places and limits of the machine.
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

/// A file and its state: two are equal as long as it is the same file and nobody has changed it. A
/// number that the file system does not tell is 0.
struct FileVersion {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< since 1970
  std::int64_t changed_ns = 0;   ///< likewise: when content, name or rights last changed
  friend bool operator==(const FileVersion&, const FileVersion&) = default;
};

/// An open file, read and written at explicit offsets (bytes from its start). It has no position of
/// its own, so any threads may read at once, and write ranges that are disjoint from each other and
/// from what is read. It is closed with its object. Failures throw Error(io) naming the path; after
/// a failed write or sync the content is not known.
class File {
 public:
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  virtual ~File() = default;

  const std::filesystem::path& path() const { return path_; }

  /// Returns the bytes in the file now.
  virtual std::uint64_t size() const = 0;
  /// Returns the state of the open file, whatever its name leads to by now.
  virtual FileVersion version() const { return {.bytes = size()}; }
  /// Forces the content to the disk: when it returns, all that was written before survives a loss
  /// of power. The name may not (FileSystem::sync_directory()).
  virtual void sync() = 0;
  /// Does the same in steps of at most some tenths of a second and calls `check` before each; it
  /// may throw. For large files.
  void sync(const std::function<void()>& check);
  /// Bytes of the file.
  struct Range {
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
    friend bool operator==(const Range&, const Range&) = default;
  };
  /// A hint: these ranges will be read soon, in that order, each by one read_exact() or read_at().
  virtual void will_read(std::span<const Range> /*ranges*/) const {}
  /// Lets the disk begin with what was written, so that a later sync() has less to wait for.
  void start_sync() { write_out(0, 0, Wait::no); }

  /// Reads up to bytes.size() at `offset`; returns how many, fewer only at the end of the file.
  std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Reads exactly bytes.size(); throws Error(io) naming the offset if the file ends before.
  void read_exact(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Writes all of `bytes` at `offset`, whatever number of calls it takes; the file grows if need
  /// be.
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

/// A file that is only read: it lies within another one, or on the web. write_at() throws
/// Error(io).
class ReadOnlyFile : public File {
 public:
  using File::sync;
  void sync() final {}

 protected:
  explicit ReadOnlyFile(std::filesystem::path path) : File(std::move(path)) {}

 private:
  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) final;
};

/// The state of a named file as far as it can be told without reading it.
struct FileIdentity {
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< since 1970
  std::int64_t changed_ns = 0;   ///< as FileVersion's: a new link to the file changes it, too

  /// Compares all but `changed_ns`.
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

/// The kind of what a path leads to, links followed.
enum class FileKind {
  none,
  regular,
  directory,
  stream,           ///< a FIFO or a character device
  standard_output,  ///< this process's, whatever it is
  other
};

/// Bytes moved through a FileSystem since it was made.
struct IoCounters {
  std::atomic<std::uint64_t> bytes_read{0};
  std::atomic<std::uint64_t> bytes_written{0};
};

/// Opens files and changes directories. Thread-safe. Every failure throws Error(io) with path and
/// cause, one of the subclasses Busy and NotThere (system_failure.h) where they fit; where a method
/// says so, it is a value. Links are followed unless a method says otherwise.
class FileSystem {
 public:
  virtual ~FileSystem() = default;

  /// Opens a regular file for reading. Anything else, such as a directory or a FIFO, is refused at
  /// once, without waiting for who writes it.
  virtual std::unique_ptr<File> open(const std::filesystem::path& path) = 0;
  /// Makes or empties the file, for reading and writing. Its directory must be there.
  virtual std::unique_ptr<File> create(const std::filesystem::path& path) = 0;
  /// Opens a file that is there for reading and writing, with all that is in it. Refuses a link.
  virtual std::unique_ptr<File> reopen(const std::filesystem::path& path) = 0;

  /// Opens a stream, or standard output ("/dev/stdout", or a path that leads to it), for writing
  /// from the first byte to the last: reads, and writes elsewhere than at its end, throw. Waits
  /// until a FIFO has a reader; calls `check` at least every 50 ms of waiting, here and in each
  /// write: it may throw. From the first such call on this process ignores SIGPIPE.
  virtual std::unique_ptr<File> open_stream(const std::filesystem::path& path,
                                            const std::function<void()>& check) = 0;

  /// Returns the state of a file, which must be there.
  virtual FileIdentity identity(const std::filesystem::path& path) = 0;
  /// Makes the file if need be and locks it, without waiting; null if it is locked already, by this
  /// process or another one.
  virtual std::unique_ptr<FileLock> try_lock(const std::filesystem::path& path) = 0;
  /// Whether a process has locked a file by try_lock(): of whatever user, if this one may read the
  /// file. Makes no file, follows no link, and is in nobody's way; never throws.
  virtual bool is_locked(const std::filesystem::path& path) = 0;

  /// Whether there is anything of that name; a link counts, wherever it leads.
  virtual bool exists(const std::filesystem::path& path) = 0;
  /// Never throws: what cannot be looked at is FileKind::none.
  virtual FileKind kind(const std::filesystem::path& path) = 0;
  bool is_directory(const std::filesystem::path& path) { return kind(path) == FileKind::directory; }
  /// Whether it is a symbolic link, wherever it leads; systems without links have none. Never
  /// throws.
  virtual bool is_link(const std::filesystem::path& /*path*/) { return false; }
  /// Returns the absolute path without links and dots, as far as it exists; for a link to nothing,
  /// the path that it leads to.
  virtual std::filesystem::path canonical(const std::filesystem::path& path) = 0;
  /// Returns everything below `directory`, at any depth, that is no directory; links as themselves;
  /// ascending. What others make or remove meanwhile may be among it.
  virtual std::vector<std::filesystem::path> list(const std::filesystem::path& directory) = 0;
  /// Whether list() and children() can tell what is in a directory; if not, they throw.
  virtual bool can_list(const std::filesystem::path& /*directory*/) { return true; }
  /// Returns what is directly in `directory`: paths, ascending.
  virtual std::vector<std::filesystem::path> children(const std::filesystem::path& directory) = 0;
  /// Makes a directory and those above it, as far as they are not there.
  virtual void make_directories(const std::filesystem::path& path) = 0;
  /// Removes a file or a whole tree, a link as itself; nothing happens if it is not there.
  virtual void remove_all(const std::filesystem::path& path) = 0;
  /// Removes a directory if it is empty at that moment: nothing that others make in it goes.
  virtual void remove_if_empty(const std::filesystem::path& directory) = 0;
  /// Renames a file or directory at one moment. An existing file of that name is replaced; the new
  /// one gets its access rights where the system allows that.
  virtual void rename(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  /// Does the same, but replaces nothing: returns false if there is something of that name. For
  /// files that holds whoever else makes one at the same moment; a directory on a file system that
  /// cannot (NFS) may replace an empty one that has just appeared.
  virtual bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  /// Gives each of two files or directories the name of the other, at one moment. Returns false,
  /// and changes no name, if the system cannot.
  virtual bool exchange(const std::filesystem::path& a, const std::filesystem::path& b) = 0;
  /// Forces the names in a directory to the disk: needed after create() and rename().
  virtual void sync_directory(const std::filesystem::path& directory) = 0;
  /// Forces everything written to the file system that holds `directory` to the disk.
  virtual void sync_tree(const std::filesystem::path& directory) = 0;
  /// Returns the bytes that are free for this user on the file system that holds `directory`.
  virtual std::uint64_t free_bytes(const std::filesystem::path& directory) = 0;
  /// Returns why no file can be made in that directory, as far as it can be known before:
  /// "Permission denied"; empty if nothing speaks against it.
  virtual std::string why_not_writable(const std::filesystem::path& /*directory*/) { return ""; }

  /// A hint: these whole files will be read soon, in that order.
  virtual void will_read(std::span<const std::filesystem::path> /*files*/) {}

  /// Returns the one to read a mesh with, and what a mesh names. It may refuse links, and what lies
  /// elsewhere. It lives as long as this.
  virtual FileSystem& input() { return *this; }

  const IoCounters& counters() const { return *counters_; }

 protected:
  std::shared_ptr<IoCounters> counters_ = std::make_shared<IoCounters>();
};

/// The files that FileSystem::input() opens and looks at.
struct InputRule {
  bool follows_links = true;  ///< else no part of a path may be a link, at whatever moment
  /// If it is set, nothing that lies elsewhere is opened, and no link below it; the folder itself
  /// may be one. Its path is taken without "..", and so are those of files.
  std::optional<std::filesystem::path> within{};
};

/// Makes the real one. Its input() throws Error(io) for what the rule refuses; exists() and kind()
/// say that it is not there.
std::unique_ptr<FileSystem> make_posix_file_system(const InputRule& input = {});

/// Returns the bytes of a file, or of all below a directory; links, and what is not there or goes
/// meanwhile, have none. Throws Error(io).
std::uint64_t bytes_at(FileSystem& files, const std::filesystem::path& path);

/// Returns a whole file. `limit_bytes` guards what is allocated: a larger file throws
/// Error(corrupt). Throws Error(io) if it cannot be read.
std::vector<std::byte> read_file(const File& file, std::uint64_t limit_bytes);
std::vector<std::byte> read_file(FileSystem& files, const std::filesystem::path& path,
                                 std::uint64_t limit_bytes);
/// Creates `path`, or replaces its content, with exactly `bytes`; nothing is synced. Throws
/// Error(io).
void write_file(FileSystem& files, const std::filesystem::path& path,
                std::span<const std::byte> bytes);

}  // namespace meshhier::storage
