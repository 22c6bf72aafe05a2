#include "server/build_target.h"

#include "hierarchy/mesh_name.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

/// As a manifest has it, in which what is no UTF-8 was replaced.
std::string as_text(const std::string& name) {
  return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The name of its hierarchy, without the ending: a file in a folder is called as that.
std::string stem_of(const std::string& name) {
  const std::size_t slash = name.find('/');
  return slash == std::string::npos ? mesh_stem(name) : name.substr(0, slash);
}

/// Another one, which no other file of an inbox has as its stem.
std::string full_name_of(std::string name) {
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

bool is_first_of_its_stem(const std::string& name, const std::vector<std::string>& inbox) {
  return std::none_of(inbox.begin(), inbox.end(), [&](const std::string& other) {
    return stem_of(other) == stem_of(name) && other < name;
  });
}

bool is_taken(const storage::Folder& folder, const std::string& name) {
  const std::vector<storage::FolderEntry> entries = folder.entries("");
  return std::any_of(entries.begin(), entries.end(),
                     [&](const storage::FolderEntry& entry) { return entry.name == name; });
}

}  // namespace

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

}  // namespace meshhier::server
