#include "server/inbox.h"

#include "base/error.h"
#include "mesh_io/formats.h"
#include "mesh_io/other_formats.h"
#include "server/folder_scan.h"

#include <algorithm>
#include <utility>

namespace meshhier::server {

Inbox::Inbox(std::filesystem::path directory, Options options)
    : directory_(std::move(directory)), options_(std::move(options)) {}

std::vector<InboxFile> Inbox::look() {
  const Time now = options_.clock();
  SeenFiles seen;
  std::vector<InboxFile> files;
  const auto inbox = storage::open_folder(directory_);
  for (const storage::FolderEntry& entry : inbox->entries("")) {
    if (entry.is_directory) {
      if (auto file = look_into(*inbox, entry.name, now, seen))
        files.push_back(std::move(*file));
    } else if (mesh_io::is_mesh_name(entry.name)) {
      const InputVersion version{entry.version, options_.mark(entry.name)};
      const Time since = note(entry.name, version, now, seen);
      const bool is_whole = now - since >= options_.settle;
      if (!is_whole || !is_archived_hierarchy(*inbox, entry.name, seen))
        files.push_back({entry.name, version, is_whole});
    }
  }
  seen_ = std::move(seen);
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

/// Returns the mesh in a folder; nothing if it is no mesh's folder. One that may not be read
/// (lost+found) must not hide the rest.
std::optional<InboxFile> Inbox::look_into(const storage::Folder& inbox, const std::string& folder,
                                          Time now, SeenFiles& seen) const {
  if (options_.folders == Folders::ignored || folder.starts_with('.'))
    return std::nullopt;
  std::vector<InboxFile> meshes;
  Time since = Time::min();
  try {
    for (const storage::FolderEntry& entry : inbox.entries(folder)) {
      if (entry.is_directory)
        continue;
      const std::string name = folder + '/' + entry.name;
      InputVersion version{entry.version};
      if (mesh_io::is_mesh_name(entry.name)) {
        version.companions = options_.mark(name);
        meshes.push_back({name, version, false});
      }
      since = std::max(since, note(name, version, now, seen));
    }
  } catch (const Error&) {
    return std::nullopt;
  }
  if (meshes.size() > 1)  // what may be a picture of another one is none of its own
    std::erase_if(meshes, [](const InboxFile& file) { return mesh_io::may_be_picture(file.name); });
  if (meshes.size() != 1)
    return std::nullopt;
  meshes.front().is_whole = now - since >= options_.settle;
  return meshes.front();
}

std::unique_ptr<storage::File> Inbox::open(const std::string& name,
                                           const storage::FileVersion& version) const {
  auto file = storage::open_folder(directory_)->open(name);
  return file && file->version() == version ? std::move(file) : nullptr;
}

}  // namespace meshhier::server
