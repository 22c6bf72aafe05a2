#include "storage/io/link_free_paths.h"

#include "base/error.h"
#include "storage/io/paths.h"
#include "storage/io/system_failure.h"

#include <cerrno>
#include <memory>
#include <string>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

bool is_link_at(int directory, const fs::path& name) {
  struct stat status {};
  return ::fstatat(directory, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 &&
         S_ISLNK(status.st_mode);
}

bool is_link(const Descriptor& file) {
  struct stat status {};
  return ::fstat(file.number(), &status) == 0 && S_ISLNK(status.st_mode);
}

/// Returns the absolute path without dots and without a slash at its end, which would be a part of
/// its own.
fs::path tidy(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return without_last_slash(normal);
}

/// Returns the path up to its first part that is a link now; empty if none is any more.
fs::path first_link(const fs::path& path) {
  fs::path start;
  for (const fs::path& part : path.lexically_normal()) {
    start /= part;
    if (is_link_at(AT_FDCWD, start))
      return start;
  }
  return {};
}

}  // namespace

Descriptor open_parts(int start, const fs::path& name, int flags) {
  Descriptor here(-1);
  for (auto part = name.begin(); part != name.end();) {
    const fs::path now = *part++;
    if (now.empty())
      continue;
    const int from = here.is_open() ? here.number() : start;
    const bool is_last = part == name.end();
    Descriptor next(::openat(from, now.c_str(),
                             (is_last ? flags : O_PATH | O_DIRECTORY) | O_NOFOLLOW | O_CLOEXEC));
    if (!next.is_open() && errno == ENOTDIR)  // which a link is to O_DIRECTORY
      errno = is_link_at(from, now) ? ELOOP : ENOTDIR;
    if (is_last || !next.is_open())
      return next;
    here = std::move(next);
  }
  errno = ENOENT;
  return here;
}

std::vector<std::string> names_in(Descriptor directory, const fs::path& path) {
  const std::unique_ptr<DIR, int (*)(DIR*)> listing(::fdopendir(directory.number()), ::closedir);
  if (!listing)
    fail_system("list", path, errno);
  directory.release();  // closed with the listing
  std::vector<std::string> names;
  errno = 0;
  while (const dirent* entry = ::readdir(listing.get())) {
    const std::string name = entry->d_name;
    if (name != "." && name != "..")
      names.push_back(name);
    errno = 0;
  }
  if (errno != 0)
    fail_system("list", path, errno);
  return names;
}

LinkFreePaths::LinkFreePaths(const std::optional<fs::path>& within)
    : within_(within ? tidy(*within) : fs::path()) {}

Descriptor LinkFreePaths::open(const fs::path& path, int flags) const {
  Descriptor file(-1);
  if (within_.empty()) {
    file = open_parts(AT_FDCWD, path.lexically_normal(), flags);
  } else {
    const fs::path name = tidy(path).lexically_relative(within_);
    if (name.empty() || *name.begin() == "..") {
      errno = EXDEV;
      return file;
    }
    // The folder is opened each time, as a network's folder may go and come back.
    const Descriptor folder(::open(within_.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (folder.is_open())
      file = open_parts(folder.number(), name, flags);
  }
  if (!file.is_open() || (flags & O_PATH) == 0 || !is_link(file))
    return file;
  errno = ELOOP;
  return Descriptor(-1);
}

void LinkFreePaths::fail(const char* action, const fs::path& path, int error) const {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::io, fmt::format("cannot {} {}: {}", action, path.string(), why));
  };
  if (error == EXDEV)
    refuse("it does not lie in " + within_.string());
  if (error == ELOOP) {
    const fs::path link = first_link(path);
    if (link.empty())
      refuse("a part of its path is a link");
    refuse((link == path.lexically_normal() ? "it" : link.string()) + " is a link");
  }
  fail_system(action, path, error);
}

}  // namespace meshhier::storage
