#include "tests/support/memory_files.h"

#include "storage/io/system_failure.h"

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>

namespace meshhier::tests {
namespace {

namespace fs = std::filesystem;

/// Returns whether `path` is below `directory`.
bool is_below(const fs::path& path, const fs::path& directory) {
  return std::mismatch(directory.begin(), directory.end(), path.begin(), path.end()).first ==
             directory.end() &&
         path != directory;
}

/// `path`, which is `from` or below it, moved to `to`.
fs::path moved(const fs::path& path, const fs::path& from, const fs::path& to) {
  return path == from ? to : to / path.lexically_relative(from);
}

class MemoryFile final : public storage::File {
 public:
  MemoryFile(fs::path path, std::shared_ptr<MemoryFiles::Content> content)
      : File(std::move(path)), content_(std::move(content)) {}

  std::uint64_t size() const override {
    const std::lock_guard lock(content_->mutex);
    return content_->bytes.size();
  }
  using File::sync;
  void sync() override {}

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    const std::lock_guard lock(content_->mutex);
    const MemoryFiles::Bytes& all = content_->bytes;
    if (offset >= all.size())
      return 0;
    const std::size_t count = std::min<std::uint64_t>(bytes.size(), all.size() - offset);
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(offset), count, bytes.begin());
    return count;
  }
  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
    const std::lock_guard lock(content_->mutex);
    MemoryFiles::Bytes& all = content_->bytes;
    all.resize(std::max<std::uint64_t>(all.size(), offset + bytes.size()));
    std::copy(bytes.begin(), bytes.end(), all.begin() + static_cast<std::ptrdiff_t>(offset));
    return bytes.size();
  }

 private:
  std::shared_ptr<MemoryFiles::Content> content_;
};

}  // namespace

std::unique_ptr<storage::File> MemoryFiles::open(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  const auto found = files_.find(path.lexically_normal());
  if (found == files_.end())
    storage::fail_system("open", path, has_directory(path) ? EISDIR : ENOENT);
  return std::make_unique<MemoryFile>(path, found->second);
}

std::unique_ptr<storage::File> MemoryFiles::create(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  if (has_directory(path))
    storage::fail_system("create", path, EISDIR);
  const auto content = std::make_shared<Content>();
  files_[path.lexically_normal()] = content;
  return std::make_unique<MemoryFile>(path, content);
}

std::unique_ptr<storage::File> MemoryFiles::reopen(const fs::path& path) {
  return open(path);
}

storage::FileIdentity MemoryFiles::identity(const fs::path& path) {
  return {open(path)->size(), 0};
}

/// Nobody else is here.
std::unique_ptr<storage::FileLock> MemoryFiles::try_lock(const fs::path& path) {
  class Lock final : public storage::FileLock {
   public:
    Lock(MemoryFiles& files, fs::path path) : files_(files), path_(std::move(path)) {}
    ~Lock() override { files_.remove_all(path_); }

   private:
    MemoryFiles& files_;
    fs::path path_;
  };
  create(path);
  return std::make_unique<Lock>(*this, path);
}

bool MemoryFiles::exists(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  return files_.contains(path.lexically_normal()) || has_directory(path);
}

storage::FileKind MemoryFiles::kind(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  if (files_.contains(path.lexically_normal()))
    return storage::FileKind::regular;
  return has_directory(path) ? storage::FileKind::directory : storage::FileKind::none;
}

fs::path MemoryFiles::canonical(const fs::path& path) {
  return path.lexically_normal();
}

std::vector<fs::path> MemoryFiles::list(const fs::path& directory) {
  const std::lock_guard lock(mutex_);
  std::vector<fs::path> found;
  for (const auto& [path, content] : files_) {
    if (is_below(path, directory.lexically_normal()))
      found.push_back(path);
  }
  return found;
}

std::vector<fs::path> MemoryFiles::children(const fs::path& directory) {
  const fs::path normal = directory.lexically_normal();
  std::set<fs::path> found;
  for (const fs::path& path : list(directory))
    found.insert(normal / *path.lexically_relative(normal).begin());
  return {found.begin(), found.end()};
}

void MemoryFiles::make_directories(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  directories_.insert(path.lexically_normal());
}

void MemoryFiles::remove_all(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  const fs::path normal = path.lexically_normal();
  std::erase_if(files_, [&](const auto& file) {
    return file.first == normal || is_below(file.first, normal);
  });
  std::erase_if(directories_, [&](const fs::path& directory) {
    return directory == normal || is_below(directory, normal);
  });
}

void MemoryFiles::rename(const fs::path& from, const fs::path& to) {
  const std::lock_guard lock(mutex_);
  const fs::path old_name = from.lexically_normal(), new_name = to.lexically_normal();
  if (!files_.contains(old_name) && !has_directory(old_name))
    storage::fail_system("rename to", to, ENOENT);
  const auto is_moved = [&](const fs::path& path) {
    return path == old_name || is_below(path, old_name);
  };
  files_.erase(new_name);  // a file is replaced
  decltype(files_) files;
  for (const auto& [path, content] : files_)
    files[is_moved(path) ? moved(path, old_name, new_name) : path] = content;
  decltype(directories_) directories;
  for (const fs::path& path : directories_)
    directories.insert(is_moved(path) ? moved(path, old_name, new_name) : path);
  files_ = std::move(files);
  directories_ = std::move(directories);
}

bool MemoryFiles::rename_new(const fs::path& from, const fs::path& to) {
  if (exists(to))
    return false;
  rename(from, to);
  return true;
}

MemoryFiles::Bytes& MemoryFiles::bytes(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  return files_.at(path.lexically_normal())->bytes;
}

void MemoryFiles::put(const fs::path& path, std::string_view content) {
  const auto bytes = std::as_bytes(std::span(content));
  create(path)->write_at(0, bytes);
}

std::string MemoryFiles::content(const fs::path& path) {
  const Bytes& all = bytes(path);
  return {reinterpret_cast<const char*>(all.data()), all.size()};
}

bool MemoryFiles::has_directory(const fs::path& path) const {
  const fs::path normal = path.lexically_normal();
  return directories_.contains(normal) ||
         std::any_of(files_.begin(), files_.end(),
                     [&](const auto& file) { return is_below(file.first, normal); });
}

}  // namespace meshhier::tests
