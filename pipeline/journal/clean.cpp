#include "pipeline/journal/clean.h"

#include "execution/size_text.h"

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
      return "room of a verify";
    case Leftover::input_note:
      return "a note about a hierarchy that is gone";
    case Leftover::unfinished:
      break;
  }
  return "a file that was not finished";
}

/// Whether it is a leftover: a note about a hierarchy that is there, or can have its name back, is
/// none.
bool is_leftover(storage::FileSystem& files, Leftover kind, const fs::path& output) {
  return kind != Leftover::input_note ||
         (!files.exists(output) && !files.exists(storage::replaced_path(output)));
}

bool is_in_use(storage::FileSystem& files, const FoundLeftover& leftover) {
  return leftover.kind == Leftover::build && files.is_locked(storage::lock_path(leftover.path));
}

std::uint64_t bytes_of(storage::FileSystem& files, const FoundLeftover& leftover) {
  if (!files.is_directory(leftover.path))
    return files.identity(leftover.path).bytes;
  return storage::bytes_below(files, leftover.path);
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
    leftover.in_use = is_in_use(files, leftover);
    leftover.only_copy = name->kind == Leftover::replaced && !files.exists(leftover.output);
    leftover.bytes = leftover.in_use ? 0 : bytes_of(files, leftover);
    found.push_back(std::move(leftover));
  }
  return found;
}

void remove_leftovers(storage::FileSystem& files, const std::vector<FoundLeftover>& found) {
  for (const FoundLeftover& leftover : found) {
    if (leftover.only_copy)
      files.rename(leftover.path, leftover.output);
    else if (!leftover.in_use)
      files.remove_all(leftover.path);
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
      done = leftover.only_copy ? ": has its name back" : leftover.in_use ? ": stays" : ": removed";
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
