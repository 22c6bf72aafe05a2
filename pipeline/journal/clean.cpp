#include "pipeline/journal/clean.h"

#include "execution/size_text.h"
#include "storage/format/work_directory.h"
#include "storage/io/system_failure.h"

#include <memory>
#include <utility>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using storage::Leftover;

const char* description(const FoundLeftover& leftover) {
  switch (leftover.kind) {
    case Leftover::build:
      return leftover.in_use ? "a build at work" : "a build that was stopped";
    case Leftover::replaced:
      return leftover.only_copy ? "the hierarchy a build was about to replace: the only copy"
                                : "a hierarchy that was replaced";
    case Leftover::verify:
      return leftover.in_use ? "room of a command at work" : "room of a command that was stopped";
    case Leftover::input_note:
      return "a note about a hierarchy that is gone";
    case Leftover::unfinished:
      break;
  }
  return leftover.in_use ? "a file that is being written" : "a file that was not finished";
}

/// Whether it is a leftover: a note about a hierarchy that is there, or can have its name back, is
/// none.
bool is_leftover(storage::FileSystem& files, Leftover kind, const fs::path& output) {
  return kind != Leftover::input_note ||
         (!files.exists(output) && !files.exists(storage::replaced_path(output)));
}

bool is_only_copy(storage::FileSystem& files, const FoundLeftover& leftover) {
  return leftover.kind == Leftover::replaced && !files.exists(leftover.output);
}

/// Returns the file that whoever is at work there has locked.
fs::path lock_of(const FoundLeftover& leftover) {
  switch (leftover.kind) {
    case Leftover::replaced:
      return storage::lock_path(storage::work_path(leftover.output));
    case Leftover::unfinished:
      return storage::output_lock_path(leftover.output);
    default:
      return storage::lock_path(leftover.path);
  }
}

/// Whether it is a directory that its lock lies in; others may put a file or a link there. Throws
/// NotThere if nothing is there any more: the next build may make it anew.
bool is_work(storage::FileSystem& files, const FoundLeftover& leftover) {
  if (lock_of(leftover) != storage::lock_path(leftover.path))
    return false;
  const bool is_link = files.is_link(leftover.path);
  const storage::FileKind kind = files.kind(leftover.path);
  if (kind == storage::FileKind::none && !is_link)
    throw storage::NotThere(leftover.path.string() + " has gone");
  return kind == storage::FileKind::directory && !is_link;
}

/// Removes a leftover, unless somebody has begun to use it.
void remove_unused(storage::FileSystem& files, FoundLeftover& leftover) {
  const bool is_work_folder = is_work(files, leftover);
  std::unique_ptr<storage::FileLock> lock;
  if (is_work_folder || leftover.kind == Leftover::unfinished) {
    lock = files.try_lock(lock_of(leftover));
    leftover.in_use = lock == nullptr;
  } else {
    leftover.in_use = files.is_locked(lock_of(leftover)) ||
                      !is_leftover(files, leftover.kind, leftover.output) ||
                      is_only_copy(files, leftover);
  }
  if (leftover.in_use)
    return;
  if (is_work_folder)
    storage::remove_work(files, leftover.path, std::move(lock));
  else
    files.remove_all(leftover.path);
}

}  // namespace

std::vector<FoundLeftover> find_leftovers(storage::FileSystem& files,
                                          const fs::path& directory_or_output) {
  const fs::path path = files.canonical(directory_or_output);
  const bool is_output = !files.is_directory(path) || files.exists(storage::manifest_path(path)) ||
                         files.exists(storage::work_path(path));
  const fs::path directory = is_output ? path.parent_path() : path;
  std::vector<FoundLeftover> found;
  for (const fs::path& child : files.children(directory)) {
    const auto name = storage::leftover_name(child.filename().string());
    if (!name || (is_output && name->output != path.filename().string()))
      continue;
    FoundLeftover leftover{child, name->kind, directory / name->output};
    if (!is_leftover(files, leftover.kind, leftover.output))
      continue;
    leftover.in_use = files.is_locked(lock_of(leftover));
    leftover.only_copy = is_only_copy(files, leftover);
    leftover.bytes = leftover.in_use ? 0 : storage::bytes_at(files, leftover.path);
    found.push_back(std::move(leftover));
  }
  return found;
}

void remove_leftovers(storage::FileSystem& files, std::vector<FoundLeftover>& found) {
  for (FoundLeftover& leftover : found) {
    try {
      if (leftover.in_use)
        continue;
      if (leftover.only_copy)
        leftover.only_copy = files.rename_new(leftover.path, leftover.output);
      if (!leftover.only_copy)
        remove_unused(files, leftover);
    } catch (const storage::NotThere&) {  // who was at work has removed it
    }
  }
}

std::string leftovers_text(const std::vector<FoundLeftover>& found, bool removed) {
  if (found.empty())
    return "nothing was left behind\n";
  std::string text;
  std::uint64_t bytes = 0;
  for (const FoundLeftover& leftover : found) {
    const char* done = "";
    if (removed)
      done = leftover.in_use ? ": stays" : leftover.only_copy ? ": has its name back" : ": removed";
    text += fmt::format("{:>9}  {}  {}{}\n", execution::rounded_size_text(leftover.bytes),
                        leftover.path.string(), description(leftover), done);
    bytes += leftover.bytes;
  }
  if (!removed)
    text += fmt::format("{:>9}  in all; --remove removes what is not at work\n",
                        execution::rounded_size_text(bytes));
  return text;
}

nlohmann::ordered_json leftovers_json(const std::vector<FoundLeftover>& found) {
  auto list = nlohmann::ordered_json::array();
  for (const FoundLeftover& leftover : found) {
    list.push_back({{"path", leftover.path.string()},
                    {"output", leftover.output.string()},
                    {"what", description(leftover)},
                    {"bytes", leftover.bytes},
                    {"in_use", leftover.in_use}});
  }
  return {{"leftovers", list}};
}

}  // namespace meshhier::pipeline
