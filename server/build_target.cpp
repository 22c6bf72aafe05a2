#include "server/build_target.h"

#include "hierarchy/mesh_name.h"

#include <algorithm>
#include <optional>

#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

/// As a manifest has it, in which what is no UTF-8 was replaced.
std::string as_text(const std::string& name) {
  return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool is_first_of_its_stem(const std::string& name, const std::vector<std::string>& inbox) {
  return std::none_of(inbox.begin(), inbox.end(), [&](const std::string& other) {
    return mesh_stem(other) == mesh_stem(name) && other < name;
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
  const std::string by_stem = mesh_stem(name) + target.suffix;
  const std::string by_name = name + target.suffix;
  for (const std::string& output : {by_stem, by_name}) {
    const std::optional<Model> model = target.hierarchies.look(output);
    if (model && as_text(model->source) == as_text(name)) {
      return {is_made_of(*model) ? Kind::done : Kind::replace, output};
    }
    const bool may_use = output == by_name || is_first_of_its_stem(name, inbox);
    if (!model && may_use && !is_taken(target.folder, output))
      return {Kind::build, output};
  }
  return {Kind::nowhere, by_name};
}

}  // namespace meshhier::server
