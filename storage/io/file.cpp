#include "storage/io/file.h"

#include "base/error.h"
#include "storage/io/descriptor.h"
#include "storage/io/link_free_paths.h"
#include "storage/io/neighbours.h"
#include "storage/io/posix_file.h"
#include "storage/io/stream.h"
#include "storage/io/system_failure.h"
#include "storage/io/zip_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace meshhier::storage {

namespace {

const char* hint_at(const std::filesystem::path& path, int error) {
  if (error == ENOSPC || error == EDQUOT)
    return " (free some space and run again)";
  if (error == ENOENT && !path.empty() && *path.begin() == "-")
    return " (standard input is not read here: save what it has, and name that file)";
  return "";
}

}  // namespace

void fail_system(const char* action, const std::filesystem::path& path, int error) {
  const std::string message = fmt::format("cannot {} {}: {}{}", action, path.string(),
                                          std::strerror(error), hint_at(path, error));
  if (error == EMFILE || error == ENFILE || error == ENOMEM)
    throw Busy(message);
  if (error == ENOENT)
    throw NotThere(message);
  throw Error(ErrorCode::io, message);
}

namespace {

bool is_same_file(int descriptor, const std::filesystem::path& path) {
  struct stat held {};
  struct stat named {};
  return ::fstat(descriptor, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
         held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

class PosixLock final : public FileLock {
 public:
  PosixLock(std::filesystem::path path, Descriptor file)
      : path_(std::move(path)), file_(std::move(file)) {}
  ~PosixLock() override {
    if (is_same_file(file_.number(), path_))
      ::unlink(path_.c_str());  // while it is locked: whoever waits finds another file, or none
  }

 private:
  std::filesystem::path path_;
  Descriptor file_;
};

/// Whether another descriptor holds the file's lock. Takes a shared one for a moment, which others
/// who ask do not count.
bool is_held(int descriptor) {
  if (::flock(descriptor, LOCK_SH | LOCK_NB) != 0)
    return errno == EWOULDBLOCK;
  ::flock(descriptor, LOCK_UN);
  return false;
}

/// Does again what fails because a part of a path goes meanwhile. Returns the last failure.
template <class Step>
std::error_code do_though_parts_go(const Step& step) {
  constexpr int kTries = 1000;
  std::error_code error;
  for (int i = 0; i < kTries; ++i) {
    error.clear();
    step(error);
    if (error != std::errc::no_such_file_or_directory)
      break;
  }
  return error;
}

/// As FileSystem::canonical().
std::filesystem::path place_of(const std::filesystem::path& path, std::error_code& error) {
  constexpr int kMostLinks = 40;  // as many as the system follows
  std::filesystem::path result = std::filesystem::absolute(path, error);
  for (int i = 0; i < kMostLinks && !error; ++i) {
    result = std::filesystem::weakly_canonical(result, error);
    std::error_code ignored;
    if (error || !std::filesystem::is_symlink(result, ignored))
      break;  // a path that is still a link leads to nothing
    result = result.parent_path() / std::filesystem::read_symlink(result, error);
  }
  return result;
}

/// Whether it is a directory itself, and no link to one.
bool is_own_directory(const std::filesystem::directory_entry& entry) {
  std::error_code ignored;
  return entry.symlink_status(ignored).type() == std::filesystem::file_type::directory;
}

/// Gives `by` the mode of the regular file that it will replace; where that fails, it keeps its
/// own.
void keep_mode(const std::filesystem::path& by, const std::filesystem::path& replaced) {
  struct stat before {};
  struct stat after {};
  if (::lstat(replaced.c_str(), &before) == 0 && S_ISREG(before.st_mode) &&
      ::lstat(by.c_str(), &after) == 0 && S_ISREG(after.st_mode) &&
      ((before.st_mode ^ after.st_mode) & 0777) != 0) {
    static_cast<void>(::chmod(by.c_str(), before.st_mode & 0777));
  }
}

/// Whether a file system or kernel lacks what was asked for.
bool is_inability(int error) {
  return error == EINVAL || error == ENOSYS || error == EOPNOTSUPP;
}

// Without O_NONBLOCK a pipe that nobody writes to would hang.
constexpr int kReading = O_RDONLY | O_CLOEXEC | O_NONBLOCK;

FileKind kind_of(const struct stat& status) {
  if (S_ISDIR(status.st_mode))
    return FileKind::directory;
  if (S_ISREG(status.st_mode))
    return FileKind::regular;
  return S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode) ? FileKind::stream : FileKind::other;
}

FileIdentity identity_of(const struct stat& status) {
  return {static_cast<std::uint64_t>(status.st_size), nanoseconds(status.st_mtim),
          nanoseconds(status.st_ctim)};
}

class PosixFileSystem : public FileSystem, public SharedFileSystem {
 public:
  std::vector<std::filesystem::path> locked_files(const std::filesystem::path& directory,
                                                  std::string_view ending) const override {
    return storage::locked_files(directory, ending);
  }

  FileSystem& input() override { return with_archives_; }

  std::unique_ptr<File> open(const std::filesystem::path& path) override {
    Descriptor file(::open(path.c_str(), kReading));
    if (!file.is_open())
      fail_system("open", path, errno);
    return take(std::move(file), path);
  }

  std::unique_ptr<File> create(const std::filesystem::path& path) override {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0)
      fail_system("create", path, errno);
    return std::make_unique<PosixFile>(path, descriptor, counters_);
  }

  std::unique_ptr<File> reopen(const std::filesystem::path& path) override {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0)
      fail_system("open", path, errno);
    return std::make_unique<PosixFile>(path, descriptor, counters_);
  }

  FileIdentity identity(const std::filesystem::path& path) override {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
      fail_system("look at", path, errno);
    return identity_of(status);
  }

  std::unique_ptr<FileLock> try_lock(const std::filesystem::path& path) override {
    constexpr int kTries = 100;  // others may have a shared lock for as long as they like
    for (int i = 0; i < kTries; ++i) {
      Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
      if (!file.is_open())
        fail_system("create", path, errno);
      if (::flock(file.number(), LOCK_EX | LOCK_NB) != 0) {
        if (errno != EWOULDBLOCK)
          fail_system("lock", path, errno);
        if (is_held(file.number()))
          return nullptr;
        std::this_thread::yield();  // to one that asks whether it is locked
      } else if (is_same_file(file.number(), path)) {
        return std::make_unique<PosixLock>(path, std::move(file));
      }  // else the one who held it has just removed it
    }
    return nullptr;
  }

  bool is_locked(const std::filesystem::path& path) override {
    // Unlike the lock that is asked about, a shared one needs no right to write.
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    return file.is_open() && is_held(file.number());
  }

  bool exists(const std::filesystem::path& path) override {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::symlink_status(path, error);
    if (status.type() == std::filesystem::file_type::not_found)
      return false;
    if (error)
      fail_system("look at", path, error.value());
    return true;
  }

  std::unique_ptr<File> open_stream(const std::filesystem::path& path,
                                    const std::function<void()>& check) override {
    return open_posix_stream(path, counters_, check);
  }

  FileKind kind(const std::filesystem::path& path) override {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
      return FileKind::none;
    const FileKind kind = kind_of(status);
    return kind != FileKind::directory && is_own_output(path) ? FileKind::standard_output : kind;
  }

  bool is_link(const std::filesystem::path& path) override {
    std::error_code error;
    return std::filesystem::is_symlink(path, error);
  }

  std::filesystem::path canonical(const std::filesystem::path& path) override {
    std::filesystem::path result;
    const std::error_code error =
        do_though_parts_go([&](std::error_code& failure) { result = place_of(path, failure); });
    const FileKind found = error ? kind(path) : FileKind::none;
    if (found != FileKind::none && found != FileKind::directory)
      return std::filesystem::absolute(path);  // a pipe, to which /dev/stdin leads by no path
    if (error)
      fail_system("resolve", path, error.value());
    return result;
  }

  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override {
    std::vector<std::filesystem::path> found, left{directory};
    while (!left.empty()) {
      const std::filesystem::path at = std::move(left.back());
      left.pop_back();
      std::error_code error;
      std::filesystem::directory_iterator entry(at, error);
      for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
        (is_own_directory(*entry) ? left : found).push_back(entry->path());
      const bool has_gone = error == std::errc::no_such_file_or_directory && at != directory;
      if (error && !has_gone)
        fail_system("list", directory, error.value());
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  std::vector<std::filesystem::path> children(const std::filesystem::path& directory) override {
    std::vector<std::filesystem::path> found;
    std::error_code error;
    std::filesystem::directory_iterator entry(directory, error);
    for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
      found.push_back(entry->path());
    if (error)
      fail_system("list", directory, error.value());
    std::sort(found.begin(), found.end());
    return found;
  }

  void make_directories(const std::filesystem::path& path) override {
    const std::error_code error = do_though_parts_go(
        [&](std::error_code& failure) { std::filesystem::create_directories(path, failure); });
    if (error)
      fail_system("make the directory", path, error.value());
  }

  void remove_all(const std::filesystem::path& path) override {
    std::error_code error;
    std::filesystem::remove_all(path, error);
    if (error)
      fail_system("remove", path, error.value());
  }

  void remove_if_empty(const std::filesystem::path& directory) override {
    if (::rmdir(directory.c_str()) != 0 && errno != ENOTEMPTY && errno != EEXIST && errno != ENOENT)
      fail_system("remove", directory, errno);
  }

  void rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    keep_mode(from, to);
    std::error_code error;
    std::filesystem::rename(from, to, error);
    if (error)
      fail_system("rename to", to, error.value());
  }

  bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) override {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0)
      return true;
    if (errno == EEXIST)
      return false;
    if (!is_inability(errno))
      fail_system("rename to", to, errno);
    if (!is_directory(from)) {  // a second name is as good: NFS has no RENAME_NOREPLACE
      if (::link(from.c_str(), to.c_str()) == 0) {
        ::unlink(from.c_str());
        return true;
      }
      if (errno == EEXIST)
        return false;
    }
    if (exists(to))
      return false;
    rename(from, to);
    return true;
  }

  bool exchange(const std::filesystem::path& a, const std::filesystem::path& b) override {
    keep_mode(a, b);
    if (::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0)
      return true;
    if (!is_inability(errno))
      fail_system("rename to", b, errno);
    return false;
  }

  void sync_directory(const std::filesystem::path& directory) override {
    sync_by(::fsync, directory);
  }
  void sync_tree(const std::filesystem::path& directory) override { sync_by(::syncfs, directory); }

  std::uint64_t free_bytes(const std::filesystem::path& directory) override {
    struct statvfs status {};
    if (::statvfs(directory.c_str(), &status) != 0)
      fail_system("inspect", directory, errno);
    return std::uint64_t{status.f_bavail} * status.f_frsize;
  }

  std::string why_not_writable(const std::filesystem::path& directory) override {
    if (::faccessat(AT_FDCWD, directory.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
      return std::strerror(errno);
    struct statvfs status {};
    const bool holds_files = ::statvfs(directory.c_str(), &status) != 0 || status.f_blocks > 0;
    return holds_files ? "" : "the system keeps no files there";
  }

 protected:
  /// Wraps a file that was opened for reading; refuses what is not regular.
  std::unique_ptr<File> take(Descriptor file, const std::filesystem::path& path) {
    struct stat status {};
    if (::fstat(file.number(), &status) == 0 && !S_ISREG(status.st_mode)) {
      if (S_ISDIR(status.st_mode))
        fail_system("open", path, EISDIR);
      throw Error(ErrorCode::io,
                  fmt::format("cannot open {}: it is not a regular file, which can be read again; "
                              "save what it has, and name that file",
                              path.string()));
    }
    return std::make_unique<PosixFile>(path, file.release(), counters_);
  }

 private:
  ZipFiles with_archives_{*this};

  static void sync_by(int (*call)(int), const std::filesystem::path& directory) {
    const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0)
      fail_system("open", directory, errno);
    const int result = call(descriptor);
    const int error = errno;
    ::close(descriptor);
    if (result != 0)
      fail_system("sync", directory, error);
  }
};

/// Opens and looks at files by paths without links; their bytes count elsewhere.
class LinkFreeFileSystem final : public PosixFileSystem {
 public:
  LinkFreeFileSystem(const std::optional<std::filesystem::path>& within,
                     std::shared_ptr<IoCounters> counters)
      : paths_(within) {
    counters_ = std::move(counters);
  }

  std::unique_ptr<File> open(const std::filesystem::path& path) override {
    Descriptor file = paths_.open(path, kReading);
    if (!file.is_open())
      paths_.fail("open", path, errno);
    return take(std::move(file), path);
  }

  FileIdentity identity(const std::filesystem::path& path) override {
    const Descriptor file = paths_.open(path, O_PATH);
    struct stat status {};
    if (!file.is_open() || ::fstat(file.number(), &status) != 0)
      paths_.fail("look at", path, errno);
    return identity_of(status);
  }

  bool exists(const std::filesystem::path& path) override { return kind(path) != FileKind::none; }

  FileKind kind(const std::filesystem::path& path) override {
    const Descriptor file = paths_.open(path, O_PATH);
    struct stat status {};
    return file.is_open() && ::fstat(file.number(), &status) == 0 ? kind_of(status)
                                                                  : FileKind::none;
  }

  std::vector<std::filesystem::path> children(const std::filesystem::path& directory) override {
    Descriptor opened = paths_.open(directory, O_RDONLY | O_DIRECTORY);
    if (!opened.is_open())
      paths_.fail("list", directory, errno);
    std::vector<std::filesystem::path> found;
    for (const std::string& name : names_in(std::move(opened), directory))
      found.push_back(directory / name);
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  LinkFreePaths paths_;
};

class GuardedFileSystem final : public PosixFileSystem {
 public:
  explicit GuardedFileSystem(const std::optional<std::filesystem::path>& within)
      : input_(within, counters_) {}
  FileSystem& input() override { return input_.input(); }

 private:
  LinkFreeFileSystem input_;
};

}  // namespace

void File::sync(const std::function<void()>& check) {
  constexpr std::uint64_t kStepBytes = std::uint64_t{1}
                                       << 24;  // a fifth of a second of a hard disk
  const std::uint64_t all = size();
  for (std::uint64_t offset = 0; offset < all; offset += kStepBytes) {
    check();
    write_out(offset, kStepBytes, Wait::yes);
  }
  check();
  sync();
}

std::size_t File::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const std::size_t count = read_some(offset + done, bytes.subspan(done));
    if (count == 0)
      break;
    done += count;
  }
  return done;
}

void File::read_exact(std::uint64_t offset, std::span<std::byte> bytes) const {
  const std::size_t count = read_at(offset, bytes);
  if (count != bytes.size()) {
    throw Error(ErrorCode::io, fmt::format("{} ends at byte {}, expected {} bytes from byte {}",
                                           path_.string(), offset + count, bytes.size(), offset));
  }
}

void File::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::size_t count = write_some(offset, bytes);
    if (count == 0)
      throw Error(ErrorCode::io, fmt::format("cannot write {}: no progress", path_.string()));
    offset += count;
    bytes = bytes.subspan(count);
  }
}

std::size_t ReadOnlyFile::write_some(std::uint64_t /*offset*/,
                                     std::span<const std::byte> /*bytes*/) {
  throw Error(ErrorCode::io, fmt::format("cannot write {}: it can only be read", path().string()));
}

std::unique_ptr<FileSystem> make_posix_file_system(const InputRule& input) {
  if (input.follows_links && !input.within)
    return std::make_unique<PosixFileSystem>();
  return std::make_unique<GuardedFileSystem>(input.within);
}

std::uint64_t bytes_at(FileSystem& files, const std::filesystem::path& path) {
  try {
    if (files.is_link(path))
      return 0;
    if (!files.is_directory(path))
      return files.identity(path).bytes;
    std::uint64_t bytes = 0;
    for (const std::filesystem::path& file : files.list(path))
      bytes += bytes_at(files, file);
    return bytes;
  } catch (const NotThere&) {
    return 0;
  }
}

std::vector<std::byte> read_file(const File& file, std::uint64_t limit_bytes) {
  const std::uint64_t size = file.size();
  if (size > limit_bytes) {
    throw Error(ErrorCode::corrupt, fmt::format("{} has {} bytes, at most {} are expected",
                                                file.path().string(), size, limit_bytes));
  }
  std::vector<std::byte> bytes(size);
  file.read_exact(0, bytes);
  return bytes;
}

std::vector<std::byte> read_file(FileSystem& files, const std::filesystem::path& path,
                                 std::uint64_t limit_bytes) {
  return read_file(*files.open(path), limit_bytes);
}

void write_file(FileSystem& files, const std::filesystem::path& path,
                std::span<const std::byte> bytes) {
  files.create(path)->write_at(0, bytes);
}

}  // namespace meshhier::storage
