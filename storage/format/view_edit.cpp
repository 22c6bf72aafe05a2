#include "storage/format/view_edit.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "hierarchy/scalar_value.h"
#include "storage/format/build_name.h"
#include "storage/format/layout.h"
#include "storage/format/load_manifest.h"
#include "storage/format/sealed_json.h"
#include "storage/format/view_keys.h"
#include "storage/io/json_text.h"
#include "storage/io/output_file.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

void require_attribute(const Manifest& manifest, const ModelView& view, const std::string& name) {
  const auto& values = manifest.source.attributes.values;
  if (view.attribute.empty() ||
      std::ranges::find(values, view.attribute, &ScalarAttribute::name) != values.end())
    return;
  std::vector<std::string> there;
  for (const ScalarAttribute& value : values)
    there.push_back(value.name);
  throw Error(ErrorCode::usage,
              fmt::format("{}: view.attribute: there is no \"{}\"; {}", name,
                          plain_text(view.attribute, kMostNameBytes),
                          there.empty() ? "the hierarchy has no attributes besides colours"
                                        : fmt::format("there is {}", fmt::join(there, ", "))));
}

/// Returns the document with the view where to_json_text() puts it.
Json with_view_key(const Json& document, const ModelView& view) {
  const char* const before = document.contains("first_view") ? "first_view" : "up";
  Json changed = Json::object();
  for (const auto& [key, value] : document.items()) {
    if (key != "view")
      changed[key] = value;
    if (key == before && !view.empty())
      changed["view"] = storage::view_json(view);
  }
  return changed;
}

}  // namespace

std::string with_view(const std::string& manifest_text, const ModelView& view,
                      const std::string& name) {
  require_attribute(parse_manifest(manifest_text, name), view, name);
  const Json document = parse_ordered_json_text(manifest_text);
  // It tells its own format and version.
  std::string changed = sealed_text({}, with_view_key(document, view));
  if (changed.size() > kMostSealedBytes)
    throw Error(ErrorCode::usage,
                fmt::format("{}: with this view it would have {} bytes, and at most {} are read: "
                            "name fewer objects in it",
                            name, changed.size(), kMostSealedBytes));
  return changed;
}

std::string replace_view(FileSystem& files, const std::filesystem::path& hierarchy,
                         const ModelView& view, const std::optional<std::string>& build) {
  if (files.kind(hierarchy) == FileKind::regular) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: an archive is never changed; build it with the view in its config "
                            "(\"view\": {{...}}), or unpack it and change the directory",
                            hierarchy.string()));
  }
  require_manifest(files, hierarchy);
  const std::filesystem::path path = manifest_path(hierarchy);
  OutputFile output(files, {path, true});
  const std::string text = read_sealed_text(*files.open(path));
  const std::string changed = with_view(text, view, path.string());
  const auto refuse = [&] {
    throw Error(ErrorCode::exists,
                fmt::format("{}: another build is there by now", hierarchy.string()));
  };
  if (build && *build != build_name(text))
    refuse();
  try {
    if (changed != text)
      output.publish(std::as_bytes(std::span(changed)));
  } catch (const NotThere&) {  // it took the file that was being written along
    refuse();
  }
  return build_name(changed);
}

}  // namespace meshhier::storage
