#include "server/build_target.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/formats.h"
#include "server/url_path.h"
#include "storage/format/layout.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

/// Returns a name as a manifest has it, in which bytes that are no UTF-8 were replaced.
std::string as_text(const std::string& name) {
  return storage::json_text(nlohmann::json(name));
}

/// Returns the name of its hierarchy, without the ending: a file in a folder has the folder's name.
std::string stem_of(const std::string& name) {
  const std::size_t slash = name.find('/');
  return slash == std::string::npos ? mesh_io::mesh_stem(name) : name.substr(0, slash);
}

/// Returns another name, which no other file of an inbox has as its stem.
std::string full_name_of(std::string name) {
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

bool is_first_of_its_stem(const std::string& name, const std::vector<std::string>& inbox) {
  return std::none_of(inbox.begin(), inbox.end(), [&](const std::string& other) {
    return stem_of(other) == stem_of(name) && other < name;
  });
}

/// NAME_MAX of Linux, in bytes.
constexpr std::size_t kLongestName = 255;

/// Returns the length of the longest name that is beside a hierarchy while it is built, shown and
/// checked.
std::size_t longest_beside(const std::string& output) {
  const std::filesystem::path path = output;
  std::size_t longest = 0;
  for (const auto& beside :
       {storage::work_path(path), storage::replaced_path(path), storage::input_note_path(path),
        storage::unfinished_path(storage::input_note_path(path)),
        storage::output_lock_path(storage::input_note_path(path)),
        storage::verify_scratch_path(path, 0), storage::story_path(path)})
    longest = std::max(longest, beside.native().size());
  return longest;
}

/// Returns by how many bytes the name of a hierarchy is too long for all that lies beside it; 0 if
/// it is not.
std::size_t excess_of_output(const std::string& output) {
  const std::size_t longest = longest_beside(output);
  return longest - std::min(longest, kLongestName);
}

bool is_taken(const storage::Folder& folder, const std::string& name) {
  const std::vector<storage::FolderEntry> entries = folder.entries("");
  return std::any_of(entries.begin(), entries.end(),
                     [&](const storage::FolderEntry& entry) { return entry.name == name; });
}

}  // namespace

std::size_t excess_of_name(const std::string& name, const std::string& suffix) {
  return std::max(excess_of_output(stem_of(name) + suffix),
                  excess_of_output(full_name_of(name) + suffix));
}

BuildTarget find_target(TargetFolder target, const std::string& name,
                        const std::vector<std::string>& inbox,
                        const std::function<bool(const Model&)>& is_made_of) {
  using Kind = BuildTarget::Kind;
  const std::string by_stem = stem_of(name) + target.suffix;
  const std::string by_name = full_name_of(name) + target.suffix;
  const std::string source = name.substr(name.rfind('/') + 1);
  for (const std::string& output : {by_stem, by_name}) {
    const std::optional<Model> model = target.hierarchies.look(output);
    if (model && as_text(model->source) == as_text(source)) {
      return {is_made_of(*model) ? Kind::done : Kind::replace, output};
    }
    const bool may_use = output == by_name || is_first_of_its_stem(name, inbox);
    if (!model && may_use && !is_taken(target.folder, output))
      return {Kind::build, output};
  }
  return {Kind::nowhere, by_name};
}

void check_target(const BuildTarget& target, const std::string& name,
                  const std::filesystem::path& folder) {
  if (decode_path('/' + encode_path(name)) != name) {
    throw Error(ErrorCode::usage,
                "the name of this file cannot be part of a URL: rename it, without control "
                "characters and backslashes");
  }
  if (const std::size_t excess = excess_of_output(target.name); excess > 0) {
    throw Error(ErrorCode::usage, fmt::format("the name of this file is too long by {} for the "
                                              "files that are made of it: rename it",
                                              counted(excess, "bytes")));
  }
  if (target.kind == BuildTarget::Kind::nowhere) {
    throw Error(ErrorCode::exists,
                fmt::format("{} holds something else of that name: rename this file, or that",
                            (folder / target.name).string()));
  }
}

}  // namespace meshhier::server
