#include "server/inbox.h"

#include "hierarchy/mesh_name.h"

#include <utility>

namespace meshhier::server {

Inbox::Inbox(std::filesystem::path directory, std::chrono::milliseconds settle, Mark mark,
             Clock clock)
    : directory_(std::move(directory)),
      settle_(settle),
      mark_(std::move(mark)),
      clock_(std::move(clock)) {}

std::vector<InboxFile> Inbox::look() {
  const auto now = clock_();
  std::map<std::string, Seen> seen;
  std::vector<InboxFile> files;
  for (const storage::FolderEntry& entry : storage::open_folder(directory_)->entries("")) {
    if (entry.is_directory || !is_mesh_name(entry.name))
      continue;
    const InputVersion version{entry.version, mark_(entry.name)};
    const auto before = seen_.find(entry.name);
    const bool is_same = before != seen_.end() && before->second.version == version;
    const auto since = is_same ? before->second.since : now;
    seen[entry.name] = {version, since};
    files.push_back({entry.name, version, now - since >= settle_});
  }
  seen_ = std::move(seen);
  return files;
}

std::unique_ptr<storage::File> Inbox::open(const std::string& name,
                                           const storage::FileVersion& version) const {
  auto file = storage::open_folder(directory_)->open(name);
  return file && file->version() == version ? std::move(file) : nullptr;
}

}  // namespace meshhier::server
