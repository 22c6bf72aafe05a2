#include "server/inbox.h"

#include "hierarchy/error.h"
#include "hierarchy/mesh_name.h"

#include <algorithm>
#include <utility>

namespace meshhier::server {

Inbox::Inbox(std::filesystem::path directory, std::chrono::milliseconds settle, Folders folders,
             Clock clock)
    : directory_(std::move(directory)),
      settle_(settle),
      folders_(folders),
      clock_(std::move(clock)) {}

std::vector<InboxFile> Inbox::look() {
  const Time now = clock_();
  SeenFiles seen;
  std::vector<InboxFile> files;
  const auto inbox = storage::open_folder(directory_);
  for (const storage::FolderEntry& entry : inbox->entries("")) {
    if (entry.is_directory) {
      if (auto file = look_into(*inbox, entry.name, now, seen))
        files.push_back(std::move(*file));
    } else if (is_mesh_name(entry.name)) {
      const Time since = note(entry.name, entry.version, now, seen);
      files.push_back({entry.name, entry.version, now - since >= settle_});
    }
  }
  seen_ = std::move(seen);
  return files;
}

/// Since when it is as it is.
Inbox::Time Inbox::note(const std::string& name, const storage::FileVersion& version, Time now,
                        SeenFiles& seen) const {
  const auto before = seen_.find(name);
  const bool is_same = before != seen_.end() && before->second.version == version;
  const Time since = is_same ? before->second.since : now;
  seen[name] = {version, since};
  return since;
}

/// Nothing if it is no mesh's. What may not be read (lost+found) must not hide the rest.
std::optional<InboxFile> Inbox::look_into(const storage::Folder& inbox, const std::string& folder,
                                          Time now, SeenFiles& seen) const {
  if (folders_ == Folders::ignored || folder.starts_with('.'))
    return std::nullopt;
  std::vector<InboxFile> meshes;
  Time since = Time::min();
  try {
    for (const storage::FolderEntry& entry : inbox.entries(folder)) {
      if (entry.is_directory)
        continue;
      const std::string name = folder + '/' + entry.name;
      since = std::max(since, note(name, entry.version, now, seen));
      if (is_mesh_name(entry.name))
        meshes.push_back({name, entry.version, false});
    }
  } catch (const Error&) {
    return std::nullopt;
  }
  if (meshes.size() != 1)
    return std::nullopt;
  meshes.front().is_whole = now - since >= settle_;
  return meshes.front();
}

std::unique_ptr<storage::File> Inbox::open(const std::string& name,
                                           const storage::FileVersion& version) const {
  auto file = storage::open_folder(directory_)->open(name);
  return file && file->version() == version ? std::move(file) : nullptr;
}

}  // namespace meshhier::server
