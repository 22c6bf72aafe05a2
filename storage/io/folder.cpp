#include "storage/io/folder.h"

#include "storage/io/link_free_paths.h"
#include "storage/io/posix_file.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>

namespace meshhier::storage {
namespace {

/// Whether a failure to open a name means that there is nothing of that name and kind.
bool is_absence(int error) {
  return error == ENOENT || error == ENOTDIR || error == ELOOP || error == ENAMETOOLONG ||
         error == ENXIO;
}

bool is_folder_part(std::string_view part) {
  return !part.empty() && part != "." && part != ".." && part.find('\0') == std::string_view::npos;
}

bool is_folder_name(std::string_view name) {
  for (std::size_t slash = name.find('/'); slash != std::string_view::npos;
       slash = name.find('/')) {
    if (!is_folder_part(name.substr(0, slash)))
      return false;
    name.remove_prefix(slash + 1);
  }
  return is_folder_part(name);
}

class PosixFolder final : public Folder {
 public:
  PosixFolder(std::filesystem::path path, Descriptor descriptor)
      : Folder(std::move(path)), descriptor_(std::move(descriptor)) {}

  bool is_in_place() const override {
    struct stat own {
    }, found{};
    return ::fstat(descriptor_.number(), &own) == 0 && ::stat(path().c_str(), &found) == 0 &&
           own.st_dev == found.st_dev && own.st_ino == found.st_ino;
  }

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

  /// Opens a name part by part and follows no link; no descriptor if there is nothing.
  Descriptor walk(std::string_view name, int flags) const {
    if (!is_folder_name(name))
      return Descriptor(-1);
    Descriptor found = open_parts(descriptor_.number(), name, flags);
    if (!found.is_open() && !is_absence(errno))
      fail_system("open", path() / name, errno);
    return found;
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

std::unique_ptr<Folder> open_folder(const std::filesystem::path& path) {
  Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.number() < 0)
    fail_system("open the directory", path, errno);
  return std::make_unique<PosixFolder>(path, std::move(descriptor));
}

}  // namespace meshhier::storage
