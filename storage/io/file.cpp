#include "storage/io/file.h"

#include "hierarchy/error.h"
#include "storage/io/stream.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace meshhier::storage {

void fail_system(const char* action, const std::filesystem::path& path, int error) {
  const char* hint = error == ENOSPC || error == EDQUOT ? " (free some space and run again)" : "";
  throw Error(ErrorCode::io,
              fmt::format("cannot {} {}: {}{}", action, path.string(), std::strerror(error), hint));
}

namespace {

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

FileVersion version_of(const struct stat& status) {
  return {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
          nanoseconds(status.st_mtim), nanoseconds(status.st_ctim)};
}

class PosixFile final : public File {
 public:
  PosixFile(std::filesystem::path path, int descriptor, std::shared_ptr<IoCounters> counters)
      : File(std::move(path)), descriptor_(descriptor), counters_(std::move(counters)) {}
  ~PosixFile() override { ::close(descriptor_); }

  std::uint64_t size() const override {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0)
      fail_system("inspect", path(), errno);
    return static_cast<std::uint64_t>(status.st_size);
  }

  FileVersion version() const override {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0)
      fail_system("inspect", path(), errno);
    return version_of(status);
  }

  void sync() override {
    if (::fsync(descriptor_) != 0)
      fail_system("sync", path(), errno);
  }
  using File::sync;

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    ssize_t count = 0;
    do {
      count = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    } while (count < 0 && errno == EINTR);
    if (count < 0)
      fail_system("read", path(), errno);
    counters_->bytes_read += static_cast<std::uint64_t>(count);
    return static_cast<std::size_t>(count);
  }

  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
    ssize_t count = 0;
    do {
      count = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    } while (count < 0 && errno == EINTR);
    if (count < 0)
      fail_system("write", path(), errno);
    counters_->bytes_written += static_cast<std::uint64_t>(count);
    return static_cast<std::size_t>(count);
  }

  void write_out(std::uint64_t offset, std::uint64_t bytes, Wait wait) override {
    unsigned flags = SYNC_FILE_RANGE_WRITE;
    if (wait == Wait::yes)
      flags |= SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WAIT_AFTER;
    ::sync_file_range(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(bytes), flags);
  }

 private:
  int descriptor_;
  std::shared_ptr<IoCounters> counters_;
};

bool is_same_file(int descriptor, const std::filesystem::path& path) {
  struct stat held {};
  struct stat named {};
  return ::fstat(descriptor, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
         held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

class PosixLock final : public FileLock {
 public:
  PosixLock(std::filesystem::path path, int descriptor)
      : path_(std::move(path)), descriptor_(descriptor) {}
  ~PosixLock() override {
    if (is_same_file(descriptor_, path_))
      ::unlink(path_.c_str());  // while it is locked: whoever waits finds another file, or none
    ::close(descriptor_);
  }

 private:
  std::filesystem::path path_;
  int descriptor_;
};

/// Whether a file system or kernel lacks what was asked for.
/// What replaces a regular file gets its mode; where that fails, it has its own.
void keep_mode(const std::filesystem::path& by, const std::filesystem::path& replaced) {
  struct stat before {};
  struct stat after {};
  if (::lstat(replaced.c_str(), &before) == 0 && S_ISREG(before.st_mode) &&
      ::lstat(by.c_str(), &after) == 0 && S_ISREG(after.st_mode) &&
      ((before.st_mode ^ after.st_mode) & 0777) != 0) {
    static_cast<void>(::chmod(by.c_str(), before.st_mode & 0777));
  }
}

bool is_inability(int error) {
  return error == EINVAL || error == ENOSYS || error == EOPNOTSUPP;
}

class PosixFileSystem final : public FileSystem {
 public:
  explicit PosixFileSystem(Links links) : links_(links) {}

  std::unique_ptr<File> open(const std::filesystem::path& path) override {
    // Without O_NONBLOCK a pipe that nobody writes to would hang here.
    const int no_link = links_ == Links::refused ? O_NOFOLLOW : 0;
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | no_link);
    if (descriptor < 0 && errno == ELOOP && no_link != 0) {
      throw Error(ErrorCode::io, fmt::format("cannot open {}: it is a link", path.string()));
    }
    if (descriptor < 0)
      fail_system("open", path, errno);
    struct stat status {};
    if (::fstat(descriptor, &status) == 0 && !S_ISREG(status.st_mode)) {
      ::close(descriptor);
      if (S_ISDIR(status.st_mode))
        fail_system("open", path, EISDIR);
      throw Error(ErrorCode::io,
                  fmt::format("cannot open {}: it is not a regular file", path.string()));
    }
    return std::make_unique<PosixFile>(path, descriptor, counters_);
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
    return {static_cast<std::uint64_t>(status.st_size), nanoseconds(status.st_mtim),
            nanoseconds(status.st_ctim)};
  }

  std::unique_ptr<FileLock> try_lock(const std::filesystem::path& path) override {
    for (;;) {
      const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (descriptor < 0)
        fail_system("create", path, errno);
      if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        const int error = errno;
        ::close(descriptor);
        if (error == EWOULDBLOCK)
          return nullptr;
        fail_system("lock", path, error);
      }
      if (is_same_file(descriptor, path))
        return std::make_unique<PosixLock>(path, descriptor);
      ::close(descriptor);  // the one who held it has just removed it
    }
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
    if (S_ISDIR(status.st_mode))
      return FileKind::directory;
    if (is_own_output(path))
      return FileKind::standard_output;
    if (S_ISREG(status.st_mode))
      return FileKind::regular;
    return S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode) ? FileKind::stream : FileKind::other;
  }

  bool is_link(const std::filesystem::path& path) override {
    std::error_code error;
    return std::filesystem::is_symlink(path, error);
  }

  std::filesystem::path canonical(const std::filesystem::path& path) override {
    constexpr int kMostLinks = 40;  // as many as the system follows
    std::error_code error;
    std::filesystem::path result = std::filesystem::absolute(path, error);
    for (int i = 0; i < kMostLinks && !error; ++i) {
      result = std::filesystem::weakly_canonical(result, error);
      if (error || !std::filesystem::is_symlink(std::filesystem::symlink_status(result)))
        break;  // what is still a link leads to nothing
      result = result.parent_path() / std::filesystem::read_symlink(result, error);
    }
    if (error)
      fail_system("resolve", path, error.value());
    return result;
  }

  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override {
    std::vector<std::filesystem::path> found;
    std::error_code error;
    std::filesystem::recursive_directory_iterator entry(directory, error);
    for (; !error && entry != std::filesystem::recursive_directory_iterator();
         entry.increment(error)) {
      const bool directory_itself =
          entry->symlink_status(error).type() == std::filesystem::file_type::directory;
      if (error)
        break;
      if (!directory_itself)
        found.push_back(entry->path());
    }
    if (error)
      fail_system("list", directory, error.value());
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
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error)
      fail_system("make the directory", path, error.value());
  }

  void remove_all(const std::filesystem::path& path) override {
    std::error_code error;
    std::filesystem::remove_all(path, error);
    if (error)
      fail_system("remove", path, error.value());
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

 private:
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

  Links links_;
};

/// A descriptor that is closed with its object; below 0: none.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0)
      ::close(number_);
  }
  int number() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

/// What opening a name fails with if there is simply nothing of that name and kind.
bool is_absence(int error) {
  return error == ENOENT || error == ENOTDIR || error == ELOOP || error == ENAMETOOLONG ||
         error == ENXIO;
}

bool is_folder_part(std::string_view part) {
  return !part.empty() && part != "." && part != ".." && part.find('\0') == std::string_view::npos;
}

class PosixFolder final : public Folder {
 public:
  PosixFolder(std::filesystem::path path, Descriptor descriptor)
      : Folder(std::move(path)), descriptor_(std::move(descriptor)) {}

  std::unique_ptr<File> open(std::string_view name) const override {
    Descriptor file = walk(name, O_RDONLY | O_NONBLOCK);
    if (file.number() < 0)
      return nullptr;
    struct stat status {};
    if (::fstat(file.number(), &status) != 0)
      fail_system("inspect", path() / name, errno);
    if (!S_ISREG(status.st_mode))
      return nullptr;
    return std::make_unique<PosixFile>(path() / name, file.release(), counters_);
  }

  std::vector<FolderEntry> entries(std::string_view name) const override {
    Descriptor directory =
        name.empty() ? again(O_RDONLY | O_DIRECTORY) : walk(name, O_RDONLY | O_DIRECTORY);
    if (directory.number() < 0)
      return {};
    const std::unique_ptr<DIR, int (*)(DIR*)> listing(::fdopendir(directory.number()), ::closedir);
    if (!listing)
      fail_system("list", path() / name, errno);
    directory.release();  // closed with the listing
    return read_entries(*listing, path() / name);
  }

 private:
  Descriptor again(int flags) const {
    Descriptor opened(::openat(descriptor_.number(), ".", flags | O_CLOEXEC));
    if (opened.number() < 0)
      fail_system("open", path(), errno);
    return opened;
  }

  /// Part by part, no link followed; none if there is nothing.
  Descriptor walk(std::string_view name, int flags) const {
    Descriptor here(-1);
    for (std::string_view rest = name;;) {
      const std::size_t slash = rest.find('/');
      const std::string part(rest.substr(0, slash));
      if (!is_folder_part(part))
        return Descriptor(-1);
      const bool is_last = slash == std::string_view::npos;
      const int start = here.number() < 0 ? descriptor_.number() : here.number();
      Descriptor next(::openat(start, part.c_str(),
                               (is_last ? flags : O_PATH | O_DIRECTORY) | O_NOFOLLOW | O_CLOEXEC));
      if (next.number() < 0 && !is_absence(errno))
        fail_system("open", path() / name, errno);
      if (is_last || next.number() < 0)
        return next;
      here = std::move(next);
      rest.remove_prefix(slash + 1);
    }
  }

  static std::vector<FolderEntry> read_entries(DIR& listing, const std::filesystem::path& path) {
    std::vector<FolderEntry> found;
    for (;;) {
      errno = 0;
      const dirent* entry = ::readdir(&listing);
      if (entry == nullptr && errno != 0)
        fail_system("list", path, errno);
      if (entry == nullptr)
        break;
      struct stat status {};
      const bool is_there =
          ::fstatat(::dirfd(&listing), entry->d_name, &status, AT_SYMLINK_NOFOLLOW) == 0;
      const bool is_directory = is_there && S_ISDIR(status.st_mode);
      if (is_folder_part(entry->d_name) && is_there && (is_directory || S_ISREG(status.st_mode)))
        found.push_back({entry->d_name, is_directory, version_of(status)});
    }
    std::sort(found.begin(), found.end(),
              [](const FolderEntry& a, const FolderEntry& b) { return a.name < b.name; });
    return found;
  }

  Descriptor descriptor_;
  std::shared_ptr<IoCounters> counters_ = std::make_shared<IoCounters>();
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

std::unique_ptr<FileSystem> make_posix_file_system(Links links) {
  return std::make_unique<PosixFileSystem>(links);
}

std::unique_ptr<Folder> open_folder(const std::filesystem::path& path) {
  Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.number() < 0)
    fail_system("open the directory", path, errno);
  return std::make_unique<PosixFolder>(path, std::move(descriptor));
}

std::uint64_t bytes_below(FileSystem& files, const std::filesystem::path& directory) {
  std::uint64_t bytes = 0;
  for (const std::filesystem::path& file : files.list(directory))
    bytes += files.identity(file).bytes;
  return bytes;
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
