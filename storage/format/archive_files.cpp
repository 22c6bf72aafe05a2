#include "storage/format/archive_files.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// A part of another file.
class ArchivedFile final : public File {
 public:
  ArchivedFile(std::filesystem::path path, std::shared_ptr<const File> archive,
               Archive::Place place)
      : File(std::move(path)), archive_(std::move(archive)), place_(place) {}

  std::uint64_t size() const override { return place_.bytes; }
  FileVersion version() const override {
    FileVersion version = archive_->version();
    version.bytes = place_.bytes;
    return version;
  }
  void sync() override {}
  using File::sync;

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= place_.bytes)
      return 0;
    const std::size_t count = std::min<std::uint64_t>(bytes.size(), place_.bytes - offset);
    return archive_->read_at(place_.offset + offset, bytes.first(count));
  }
  std::size_t write_some(std::uint64_t, std::span<const std::byte>) override {
    throw Error(ErrorCode::io,
                fmt::format("cannot write {}: it lies in an archive", path().string()));
  }

 private:
  std::shared_ptr<const File> archive_;
  Archive::Place place_;
};

}  // namespace

std::unique_ptr<File> open_archived(std::filesystem::path path, std::shared_ptr<const File> archive,
                                    Archive::Place place) {
  return std::make_unique<ArchivedFile>(std::move(path), std::move(archive), place);
}

ArchiveFiles::ArchiveFiles(FileSystem& others, const std::filesystem::path& archive)
    : others_(others), archive_(others.open(archive)), root_(archive.string() + '/') {}

std::optional<std::string> ArchiveFiles::name_of(const std::filesystem::path& path) const {
  const std::string& text = path.native();
  if (!text.starts_with(root_))
    return std::nullopt;
  return text.substr(root_.size());
}

std::unique_ptr<File> ArchiveFiles::open(const std::filesystem::path& path) {
  const std::optional<std::string> name = name_of(path);
  if (!name)
    return others_.open(path);
  const std::optional<Archive::Place> place = archive_.find(*name);
  if (!place) {
    throw Error(ErrorCode::io,
                fmt::format("cannot open {}: the archive has no such file", path.string()));
  }
  return open_archived(path, archive_.shared_file(), *place);
}

FileIdentity ArchiveFiles::identity(const std::filesystem::path& path) {
  if (!name_of(path))
    return others_.identity(path);
  return {open(path)->size(), others_.identity(archive_.file().path()).modified_ns};
}

bool ArchiveFiles::exists(const std::filesystem::path& path) {
  const std::optional<std::string> name = name_of(path);
  return name ? archive_.find(*name).has_value() : others_.exists(path);
}

std::vector<std::filesystem::path> ArchiveFiles::list(const std::filesystem::path& directory) {
  const std::string start = directory.string() + '/';
  if (!start.starts_with(root_))
    return others_.list(directory);
  std::vector<std::filesystem::path> found;
  archive_.for_each([&](const ArchiveEntry& entry) {
    if (entry.name != kArchiveIndexName && (root_ + entry.name).starts_with(start))
      found.emplace_back(root_ + entry.name);
  });
  std::sort(found.begin(), found.end());
  return found;
}

std::unique_ptr<File> ArchiveFiles::create(const std::filesystem::path& path) {
  return others_.create(path);
}
std::unique_ptr<File> ArchiveFiles::reopen(const std::filesystem::path& path) {
  return others_.reopen(path);
}
std::unique_ptr<FileLock> ArchiveFiles::try_lock(const std::filesystem::path& path) {
  return others_.try_lock(path);
}
std::unique_ptr<File> ArchiveFiles::open_stream(const std::filesystem::path& path,
                                                const std::function<void()>& check) {
  return others_.open_stream(path, check);
}
FileKind ArchiveFiles::kind(const std::filesystem::path& path) {
  return others_.kind(path);
}
std::filesystem::path ArchiveFiles::canonical(const std::filesystem::path& path) {
  return others_.canonical(path);
}
std::vector<std::filesystem::path> ArchiveFiles::children(const std::filesystem::path& directory) {
  return others_.children(directory);
}
void ArchiveFiles::make_directories(const std::filesystem::path& path) {
  others_.make_directories(path);
}
void ArchiveFiles::remove_all(const std::filesystem::path& path) {
  others_.remove_all(path);
}
void ArchiveFiles::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  others_.rename(from, to);
}
bool ArchiveFiles::rename_new(const std::filesystem::path& from, const std::filesystem::path& to) {
  return others_.rename_new(from, to);
}
bool ArchiveFiles::exchange(const std::filesystem::path& a, const std::filesystem::path& b) {
  return others_.exchange(a, b);
}
void ArchiveFiles::sync_directory(const std::filesystem::path& directory) {
  others_.sync_directory(directory);
}
void ArchiveFiles::sync_tree(const std::filesystem::path& directory) {
  others_.sync_tree(directory);
}
std::uint64_t ArchiveFiles::free_bytes(const std::filesystem::path& directory) {
  return others_.free_bytes(directory);
}

HierarchyFiles::HierarchyFiles(FileSystem& files, const std::filesystem::path& hierarchy)
    : others_(files) {
  if (files.exists(hierarchy) && !files.is_directory(hierarchy))
    inside_ = std::make_unique<ArchiveFiles>(files, hierarchy);
}

}  // namespace meshhier::storage
