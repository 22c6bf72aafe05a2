#include "server/inbox.h"

#include "base/error.h"
#include "mesh_io/formats.h"
#include "mesh_io/other_formats.h"
#include "server/folder_scan.h"
#include "storage/format/layout.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

constexpr const char* kUnreadable = "it cannot be read";
constexpr const char* kOnlyFiles =
    "--watch takes no folders; --inbox takes each that holds one mesh";

std::string why_no_model(std::size_t meshes) {
  return meshes == 0 ? "it holds no mesh"
                     : fmt::format("it holds {} meshes: give each a folder of its own", meshes);
}

/// A folder with such a file is a hierarchy.
bool is_manifest(const storage::FolderEntry& entry) {
  return !entry.is_directory && entry.name == storage::manifest_path({});
}

}  // namespace

Inbox::Inbox(std::filesystem::path directory, Options options)
    : directory_(std::move(directory)), options_(std::move(options)) {}

std::vector<InboxFile> Inbox::look() {
  const Time now = options_.clock();
  SeenFiles seen;
  std::vector<InboxFile> files;
  std::map<std::string, std::string> left_out;
  const auto inbox = storage::open_folder(directory_);
  for (const storage::FolderEntry& entry : inbox->entries("")) {
    if (entry.is_directory) {
      FolderLook found = look_into(*inbox, entry, now, seen);
      if (found.file)
        files.push_back(std::move(*found.file));
      else if (!found.why_not.empty() && now - options_.settle >= found.since)
        left_out[entry.name] = std::move(found.why_not);
    } else if (mesh_io::is_mesh_name(entry.name)) {
      const InputVersion version{entry.version, options_.mark(entry.name)};
      const Time since = note(entry.name, version, now, seen);
      const bool is_whole = now - since >= options_.settle;
      if (!is_whole || !is_archived_hierarchy(*inbox, entry.name, seen))
        files.push_back({entry.name, version, is_whole});
    }
  }
  seen_ = std::move(seen);
  left_out_ = std::move(left_out);
  return files;
}

/// Notes a file, and returns since when it has not changed.
Inbox::Time Inbox::note(const std::string& name, const InputVersion& version, Time now,
                        SeenFiles& seen) const {
  const auto before = seen_.find(name);
  const bool is_same = before != seen_.end() && before->second.version == version;
  const Time since = is_same ? before->second.since : now;
  seen[name] = {version, since, is_same ? before->second.is_hierarchy : std::nullopt};
  return since;
}

/// Whether a file needs no build, as it is an archive of what a build makes. Looks into it once.
bool Inbox::is_archived_hierarchy(const storage::Folder& inbox, const std::string& name,
                                  SeenFiles& seen) {
  if (!is_archive_name(name))
    return false;
  std::optional<bool>& known = seen[name].is_hierarchy;
  if (!known) {
    auto file = inbox.open(name);
    known = file != nullptr && is_hierarchy(std::move(file));
  }
  return *known;
}

/// Looks for the mesh in a folder. One that may not be read (lost+found) must not hide the rest.
Inbox::FolderLook Inbox::look_into(const storage::Folder& inbox, const storage::FolderEntry& folder,
                                   Time now, SeenFiles& seen) const {
  if (folder.name.starts_with('.'))
    return {};
  if (options_.folders == Folders::ignored)
    return look_at_ignored(inbox, folder, now, seen);
  std::vector<InboxFile> meshes;
  Time since = note(folder.name, {folder.version}, now, seen);
  try {
    for (const storage::FolderEntry& entry : inbox.entries(folder.name)) {
      if (is_manifest(entry))
        return {};
      if (entry.is_directory)
        continue;
      const std::string name = folder.name + '/' + entry.name;
      InputVersion version{entry.version};
      if (mesh_io::is_mesh_name(entry.name)) {
        version.companions = options_.mark(name);
        meshes.push_back({name, version, false});
      }
      since = std::max(since, note(name, version, now, seen));
    }
  } catch (const Error&) {
    return {.why_not = kUnreadable, .since = since};
  }
  if (meshes.size() > 1)  // what may be a picture of another one is none of its own
    std::erase_if(meshes, [](const InboxFile& file) { return mesh_io::may_be_picture(file.name); });
  if (meshes.size() != 1)
    return {.why_not = why_no_model(meshes.size()), .since = since};
  meshes.front().is_whole = now - since >= options_.settle;
  return {.file = meshes.front()};
}

/// Says of a folder that is left out why it is; looks into it once.
Inbox::FolderLook Inbox::look_at_ignored(const storage::Folder& inbox,
                                         const storage::FolderEntry& folder, Time now,
                                         SeenFiles& seen) const {
  if (const auto known = left_out_.find(folder.name); known != left_out_.end())
    return {.why_not = known->second};
  try {
    if (std::ranges::any_of(inbox.entries(folder.name), is_manifest))
      return {};
  } catch (const Error&) {
    return {.why_not = kUnreadable};
  }
  return {.why_not = kOnlyFiles, .since = note(folder.name, {folder.version}, now, seen)};
}

std::unique_ptr<storage::File> Inbox::open(const std::string& name,
                                           const storage::FileVersion& version) const {
  auto file = storage::open_folder(directory_)->open(name);
  return file && file->version() == version ? std::move(file) : nullptr;
}

}  // namespace meshhier::server
