#include "server/inbox.h"

#include "server/text.h"

#include <utility>

namespace meshhier::server {
namespace {

/// 0 if it is no mesh's name.
std::size_t stem_length(std::string_view name) {
  std::string text = lower_case(name);
  if (text.ends_with(".gz"))
    text.resize(text.size() - 3);
  for (const std::string_view ending : {".ply", ".obj", ".stl", ".off"}) {
    if (text.ends_with(ending))
      return text.size() - ending.size();
  }
  return 0;
}

}  // namespace

bool is_mesh_name(std::string_view name) {
  return !name.starts_with('.') && stem_length(name) > 0;
}

std::string mesh_stem(std::string_view name) {
  return std::string(name.substr(0, stem_length(name)));
}

Inbox::Inbox(std::filesystem::path directory, std::chrono::milliseconds settle, Clock clock)
    : directory_(std::move(directory)), settle_(settle), clock_(std::move(clock)) {}

std::vector<InboxFile> Inbox::look() {
  const auto now = clock_();
  std::map<std::string, Seen> seen;
  std::vector<InboxFile> files;
  for (const storage::FolderEntry& entry : storage::open_folder(directory_)->entries("")) {
    if (entry.is_directory || !is_mesh_name(entry.name))
      continue;
    const auto before = seen_.find(entry.name);
    const bool is_same = before != seen_.end() && before->second.version == entry.version;
    const auto since = is_same ? before->second.since : now;
    seen[entry.name] = {entry.version, since};
    files.push_back({entry.name, entry.version, now - since >= settle_});
  }
  seen_ = std::move(seen);
  return files;
}

}  // namespace meshhier::server
