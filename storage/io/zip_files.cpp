#include "storage/io/zip_files.h"

#include "base/error.h"
#include "base/small_letters.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

constexpr std::string_view kEnding = ".3tz";
/// Directories that are kept.
constexpr std::size_t kMostKnown = 16;

}  // namespace

bool is_3tz_name(const std::filesystem::path& path) {
  return small_letters(path.native()).ends_with(kEnding);
}

std::optional<std::filesystem::path> archive_around(FileSystem& files,
                                                    const std::filesystem::path& path) {
  const std::string text = small_letters(path.native());
  for (std::size_t at = text.find(kEnding); at != std::string::npos; at = text.find(kEnding, at)) {
    at += kEnding.size();
    if (at >= text.size() || text[at] != '/')
      continue;
    std::filesystem::path archive(path.native().substr(0, at));
    if (files.kind(archive) == FileKind::regular)
      return archive;
  }
  return std::nullopt;
}

std::optional<ZipFiles::Inner> ZipFiles::inner_of(const std::filesystem::path& path) const {
  auto archive = archive_around(others(), path);
  if (!archive)
    return std::nullopt;
  const std::filesystem::path name(path.native().substr(archive->native().size() + 1));
  return Inner{*std::move(archive), name.lexically_normal().generic_string()};
}

std::shared_ptr<const ZipDirectory> ZipFiles::directory_of(const std::filesystem::path& archive) {
  const FileIdentity now = others().identity(archive);
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(archive);
  if (found != known_.end() && found->second.identity == now)
    return found->second.directory;
  auto directory = std::make_shared<const ZipDirectory>(others().open(archive));
  if (known_.size() >= kMostKnown)
    known_.clear();
  known_[archive] = {now, directory};
  return directory;
}

namespace {

const ZipEntry& entry_of(const ZipDirectory& directory, const std::string& name,
                         const std::filesystem::path& path) {
  const ZipEntry* entry = directory.find(name);
  if (entry == nullptr)
    throw Error(ErrorCode::io,
                fmt::format("cannot open {}: the archive has no such file", path.string()));
  return *entry;
}

}  // namespace

std::unique_ptr<File> ZipFiles::open(const std::filesystem::path& path) {
  const auto inner = inner_of(path);
  if (!inner)
    return others().open(path);
  const auto directory = directory_of(inner->archive);
  return directory->open(entry_of(*directory, inner->name, path), path);
}

FileIdentity ZipFiles::identity(const std::filesystem::path& path) {
  const auto inner = inner_of(path);
  if (!inner)
    return others().identity(path);
  FileIdentity identity = others().identity(inner->archive);
  const auto directory = directory_of(inner->archive);
  identity.bytes = entry_of(*directory, inner->name, path).bytes;
  return identity;
}

FileKind ZipFiles::kind(const std::filesystem::path& path) {
  const auto inner = inner_of(path);
  if (!inner)
    return others().kind(path);
  try {
    const auto directory = directory_of(inner->archive);
    if (directory->find(inner->name) != nullptr)
      return FileKind::regular;
    return directory->starting_with(inner->name + '/').empty() ? FileKind::none
                                                               : FileKind::directory;
  } catch (const Error&) {
    return FileKind::none;
  }
}

std::filesystem::path ZipFiles::canonical(const std::filesystem::path& path) {
  const auto inner = inner_of(path);
  return inner ? others().canonical(inner->archive) / inner->name : others().canonical(path);
}

std::vector<std::filesystem::path> ZipFiles::list(const std::filesystem::path& directory) {
  const auto inner = inner_of(directory / "");
  if (!inner)
    return others().list(directory);
  const auto archive = directory_of(inner->archive);
  std::vector<std::filesystem::path> found;
  for (const ZipEntry& entry : archive->starting_with(inner->name == "." ? "" : inner->name))
    found.push_back(inner->archive / archive->name_of(entry));
  return found;
}

std::vector<std::filesystem::path> ZipFiles::children(const std::filesystem::path& directory) {
  const auto inner = inner_of(directory / "");
  if (!inner)
    return others().children(directory);
  std::vector<std::filesystem::path> found;
  for (const std::filesystem::path& file : list(directory)) {
    const auto below = file.lexically_relative(directory);
    if (found.empty() || found.back().filename() != *below.begin())
      found.push_back(directory / *below.begin());
  }
  return found;
}

}  // namespace meshhier::storage
