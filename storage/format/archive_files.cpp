#include "storage/format/archive_files.h"

#include "base/error.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// A part of another file.
class ArchivedFile final : public ReadOnlyFile {
 public:
  ArchivedFile(std::filesystem::path path, std::shared_ptr<const File> archive,
               Archive::Place place)
      : ReadOnlyFile(std::move(path)), archive_(std::move(archive)), place_(place) {}

  std::uint64_t size() const override { return place_.bytes; }
  FileVersion version() const override {
    FileVersion version = archive_->version();
    version.bytes = place_.bytes;
    return version;
  }

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= place_.bytes)
      return 0;
    const std::size_t count = std::min<std::uint64_t>(bytes.size(), place_.bytes - offset);
    return archive_->read_at(place_.offset + offset, bytes.first(count));
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
    : ForwardingFiles(others), archive_(others.open(archive)), root_(archive.string() + '/') {}

std::optional<std::string> ArchiveFiles::name_of(const std::filesystem::path& path) const {
  const std::string& text = path.native();
  if (!text.starts_with(root_))
    return std::nullopt;
  return text.substr(root_.size());
}

std::unique_ptr<File> ArchiveFiles::open(const std::filesystem::path& path) {
  const std::optional<std::string> name = name_of(path);
  if (!name)
    return others().open(path);
  const std::optional<Archive::Place> place = archive_.find(*name);
  if (!place) {
    throw Error(ErrorCode::io,
                fmt::format("cannot open {}: the archive has no such file", path.string()));
  }
  return open_archived(path, archive_.shared_file(), *place);
}

FileIdentity ArchiveFiles::identity(const std::filesystem::path& path) {
  if (!name_of(path))
    return others().identity(path);
  return {open(path)->size(), others().identity(archive_.file().path()).modified_ns};
}

bool ArchiveFiles::exists(const std::filesystem::path& path) {
  const std::optional<std::string> name = name_of(path);
  return name ? archive_.find(*name).has_value() : others().exists(path);
}

std::vector<std::filesystem::path> ArchiveFiles::list(const std::filesystem::path& directory) {
  const std::string start = directory.string() + '/';
  if (!start.starts_with(root_))
    return others().list(directory);
  std::vector<std::filesystem::path> found;
  archive_.for_each([&](const ArchiveEntry& entry) {
    if (entry.name != kArchiveIndexName && (root_ + entry.name).starts_with(start))
      found.emplace_back(root_ + entry.name);
  });
  std::sort(found.begin(), found.end());
  return found;
}

bool ArchiveFiles::can_list(const std::filesystem::path& directory) {
  return (directory.string() + '/').starts_with(root_) || others().can_list(directory);
}

void ArchiveFiles::will_read(std::span<const std::filesystem::path> files) {
  std::vector<File::Range> ranges;
  for (const std::filesystem::path& path : files) {
    const std::optional<std::string> name = name_of(path);
    if (const auto place = name ? archive_.find(*name) : std::nullopt)
      ranges.push_back({place->offset, place->bytes});
  }
  archive_.file().will_read(ranges);
}

HierarchyFiles::HierarchyFiles(FileSystem& files, const std::filesystem::path& hierarchy)
    : others_(files) {
  if (files.exists(hierarchy) && !files.is_directory(hierarchy))
    inside_ = std::make_unique<ArchiveFiles>(files, hierarchy);
}

}  // namespace meshhier::storage
