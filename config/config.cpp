#include "config/config.h"

#include "base/error.h"
#include "base/flat_axes.h"
#include "config/config_draft.h"
#include "config/config_schema.h"
#include "config/input_frame.h"
#include "config/suggest.h"
#include "config/view_config.h"
#include "mesh_io/formats.h"
#include "mesh_io/output_name.h"
#include "storage/io/json_text.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::config {

namespace {

using Json = nlohmann::ordered_json;

/// Configs have a few hundred bytes, or a hundred thousand paths; more is some other file given by
/// mistake.
constexpr std::uint64_t kLargestConfigBytes = std::uint64_t{1} << 24;

/// Refuses a wrong list for KeyKind::levels: for an entry, which is told by its level, or for its
/// length.
[[noreturn]] void refuse_levels(const std::string& where, const ConfigKey& key, const Json& list) {
  const ConfigKey entry = level_entry(key);
  for (std::size_t level = 0; level < list.size(); ++level) {
    if (!accepts(entry, list[level])) {
      refuse(fmt::format("{}[{}]", where, level),
             fmt::format("expected {}, found {}", expectation(entry), described(list[level])));
    }
  }
  refuse(where,
         fmt::format("expected {}, found {}", expectation(key),
                     list.empty() ? "an empty list" : fmt::format("a list of {}", list.size())));
}

void assign_value(Config& config, const Draft& draft, const ConfigKey& key, const Json& value) {
  if (!accepts(key, value)) {
    if (key.kind == KeyKind::levels && value.is_array())
      refuse_levels(draft.origin_of(key.path), key, value);
    const std::optional<std::string> near =
        value.is_string() ? nearest_word(value.get_ref<const std::string&>(), key.choices)
                          : std::nullopt;
    refuse(draft.origin_of(key.path), fmt::format("expected {}, found {}{}", expectation(key),
                                                  described(value), did_you_mean(near)));
  }
  key.assign(config, value);
}

void assign_all(Config& config, const Draft& draft, const Json& object,
                const std::string& section) {
  for (const auto& [name, value] : object.items()) {
    const std::string path = with_key(section, name);
    const bool dotted = name.find('.') != std::string::npos;
    const ConfigKey* key = dotted ? nullptr : find_config_key(path);
    if (key != nullptr) {
      assign_value(config, draft, *key, value);
    } else if (dotted && find_config_key(path) != nullptr) {
      refuse(draft.source_of(path),
             fmt::format("\"{}\" is a path of keys: write \"{}\": {{ \"{}\": ... }}", path,
                         path.substr(0, path.rfind('.')), leaf_of(path)));
    } else if (dotted || !is_config_section(path)) {
      Draft::refuse_unknown(draft.source_of(path), path);
    } else if (!value.is_object()) {
      refuse(draft.origin_of(path), "expected an object, found " + described(value));
    } else {
      assign_all(config, draft, value, path);
    }
  }
}

void require_keys(const Config& config, const std::string& name) {
  for (const ConfigKey& key : config_keys()) {
    if (key.required && key.show(config).is_null()) {
      refuse(name, fmt::format("{} is missing: expected {}", key.path, expectation(key)));
    }
  }
}

std::filesystem::path resolved_path(const Draft& draft, const std::string& key,
                                    const std::filesystem::path& path,
                                    const std::filesystem::path& directory) {
  const std::filesystem::path whole = draft.is_overridden(key) ? path : directory / path;
  const std::filesystem::path normal = whole.lexically_normal();
  return storage::without_last_slash(normal);
}

/// Refuses an output whose replacing would destroy an input that is, or lies in, that directory.
void check_output(const Config& config, const Draft& draft) {
  const std::filesystem::path name = config.output.filename();
  if (name.empty() || name == "." || name == "..") {
    refuse(draft.origin_of("output"),
           "expected the path of a directory to make, found " + in_quotes(config.output.string()));
  }
  for (const std::filesystem::path& input : read_by(config)) {
    if (storage::is_within(input, config.output)) {
      refuse(draft.origin_of("output"),
             fmt::format("{} is or holds the input {}; choose another directory",
                         in_quotes(config.output.string()), in_quotes(input.string())));
    }
  }
  mesh_io::require_true_ending(
      config.output.string(),
      config.storage.container == Container::archive
          ? std::initializer_list<std::string_view>{".3tz", ".hier", ".zip"}
          : std::initializer_list<std::string_view>{".3tz", ".hier"},
      "a build makes a hierarchy, a directory or one file that ends in .3tz; of "
      "that `meshhier export` makes meshes, `meshhier page` an HTML file");
}

/// Whether a transform leaves no volume, but for rounding.
bool is_flat(const Transform& m) {
  return are_flat({m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]});
}

/// Refuses keys of more than one of the three ways to place a model.
void check_placement(const Config& config, const Draft& draft) {
  const PlacementConfig& place = config.placement;
  const bool by_degrees = place.longitude || place.latitude || place.height;
  const bool by_map = place.crs || !place.metadata.empty();
  const int ways = int{by_degrees} + int{by_map} + int{place.transform.has_value()};
  const std::string where = draft.origin_of("placement");
  if (ways > 1) {
    refuse(where,
           "expected one of \"longitude\" and \"latitude\", \"crs\" or \"metadata\", or "
           "\"transform\", found more than one; remove the others");
  }
  if (by_degrees && !(place.longitude && place.latitude))
    refuse(where, "expected both \"longitude\" and \"latitude\"");
  if (place.offset && !by_map)
    refuse(where, "\"offset\" needs \"crs\" or \"metadata\", found neither");
  if (place.anchor && !by_degrees && !by_map) {
    refuse(where, "\"anchor\" needs \"longitude\" and \"latitude\", \"crs\" or \"metadata\"");
  }
  if (place.transform && is_flat(*place.transform))
    refuse(where, "\"transform\" makes all flat: its first three columns lie in a plane");
}

void check_crop(const Config& config, const Draft& draft) {
  const auto box = config.crop_box();
  if (box && (box->min.x > box->max.x || box->min.y > box->max.y || box->min.z > box->max.z)) {
    refuse(draft.origin_of("crop"),
           "expected two corners, the first three numbers at most the last three");
  }
}

/// Refuses one angle alone.
void check_first_view(const Config& config, const Draft& draft) {
  if (config.first_view.azimuth.has_value() != config.first_view.elevation.has_value())
    refuse(draft.origin_of("first_view"), "expected both \"azimuth\" and \"elevation\"");
}

/// Refuses keys that do not go together. Who names an attribute and no colours wants those.
void check_view(Config& config, const Draft& draft) {
  if (draft.has("view.attribute") && !draft.has("view.colours"))
    config.view.colours = "attribute";
  if (const auto problem = storage::problem_between_keys(config.view))
    refuse(draft.origin_of("view"), fmt::format("expected {}", problem->expected));
}

/// Refuses a table that no object could have a row of, and a label that is not read.
void check_objects(const Config& config, const Draft& draft) {
  using mesh_io::ObjectSource;
  const mesh_io::ObjectChoice& from = config.objects.from;
  const std::filesystem::path& table = config.objects.table;
  if (from.from == ObjectSource::none && !table.empty())
    refuse(draft.origin_of("objects.table"), "expected objects for its rows, found \"none\"");
  if (from.from == ObjectSource::label && !config.attributes.takes(from.label)) {
    refuse(draft.origin_of("objects.from"),
           fmt::format("the label {} is not read: \"attributes\" must have it",
                       in_quotes(from.label)));
  }
}

constexpr const char* kMeshWords = "the mesh on the command line";
constexpr const char* kOutputWord = "-o";
constexpr const char* kContainerKey = "storage.container";

void put_meshes(Draft& draft, const CommandLine& words) {
  if (words.meshes.empty())
    return;
  Json paths = Json::array();
  for (const std::filesystem::path& mesh : words.meshes)
    paths.push_back(mesh.string());
  draft.put("input", std::move(paths), kMeshWords);
}

/// Returns "models/scan.hier" for "models/scan.ply.gz", "models/scan.3tz" and "models/scan/".
std::filesystem::path beside(const std::filesystem::path& input, const std::string& ending) {
  const std::filesystem::path mesh = storage::without_last_slash(input.lexically_normal());
  const std::string name = mesh.filename().string();
  if (name.empty() || name == "." || name == "..")
    refuse("output is missing", "the folder has no name here; name the output by -o");
  const std::string stem = mesh_io::mesh_stem(name);
  return mesh.parent_path() / ((stem.empty() ? name : stem) + ending);
}

/// Fills in the output where it is not given: the name from the mesh, the container from the name.
void put_output(Draft& draft, const CommandLine& words) {
  if (!words.output.empty()) {
    draft.put("output", words.output.string(), kOutputWord);
    if (storage::lower_extension(words.output) == ".3tz" && !draft.has(kContainerKey))
      draft.put(kContainerKey, "3tz", kOutputWord);
  }
  if (words.meshes.empty() || draft.has("output"))
    return;
  if (words.meshes.size() > 1)
    refuse("output is missing", "several meshes become one hierarchy; name it by -o");
  const Json::json_pointer place = json_pointer_to(kContainerKey);
  const bool packed = draft.has(kContainerKey) && draft.document()[place] == "3tz";
  draft.put("output", beside(words.meshes[0], packed ? ".3tz" : ".hier").string(), kMeshWords);
}

std::string read_text(storage::FileSystem& files, const std::filesystem::path& path) {
  const std::unique_ptr<storage::File> file = files.open(path);
  const std::uint64_t size = file->size();
  if (size > kLargestConfigBytes) {
    refuse(
        path.string(),
        fmt::format("expected a config of at most {} bytes, found {}: is it another kind of file?",
                    kLargestConfigBytes, size));
  }
  std::string text(size, '\0');
  file->read_exact(0, std::as_writable_bytes(std::span(text)));
  return text;
}

/// Whether the key has paths: the files that lie there decide the result, not the paths.
bool is_of_paths(const ConfigKey& key) {
  return key.kind == KeyKind::path || key.kind == KeyKind::paths;
}

}  // namespace

Config parse_config(std::string_view text, const ConfigOrigin& origin, const CommandLine& words) {
  Draft draft(text, origin.name);
  for (const std::string& setting : words.settings)
    draft.apply(setting);
  draft.settle("partition", "vertices", "count");
  put_meshes(draft, words);
  put_output(draft, words);

  Config config;
  assign_all(config, draft, draft.document(), "");
  require_keys(config, origin.name);
  for (std::filesystem::path& input : config.input)
    input = resolved_path(draft, "input", input, origin.directory);
  config.output = resolved_path(draft, "output", config.output, origin.directory);
  if (std::filesystem::path& file = config.placement.metadata; !file.empty())
    file = resolved_path(draft, "placement.metadata", file, origin.directory);
  if (std::filesystem::path& file = config.texture.drape; !file.empty())
    file = resolved_path(draft, "texture.drape", file, origin.directory);
  if (std::filesystem::path& file = config.objects.table; !file.empty())
    file = resolved_path(draft, "objects.table", file, origin.directory);
  check_output(config, draft);
  check_placement(config, draft);
  check_crop(config, draft);
  check_first_view(config, draft);
  check_view(config, draft);
  check_objects(config, draft);
  return config;
}

ModelView with_settings(const ModelView& view, std::span<const std::string> settings) {
  constexpr std::string_view kSection = "view";
  Draft draft(storage::json_text(Json{{kSection, storage::view_json(view)}}), "the view");
  for (const std::string& setting : settings) {
    const std::string path = setting.substr(0, setting.find_first_of("=."));
    if (path != kSection)
      refuse("--set", fmt::format("expected view.KEY=VALUE, found {}", in_quotes(setting)));
    draft.apply(setting);
  }
  Config config;
  assign_all(config, draft, draft.document(), "");
  check_view(config, draft);
  return config.view;
}

Config read_config(storage::FileSystem& files, const std::filesystem::path& file,
                   const CommandLine& words) {
  const ConfigOrigin origin{file.string(), file.parent_path()};
  return parse_config(read_text(files, file), origin, words);
}

Config load_config(storage::FileSystem& files, const std::filesystem::path& file,
                   const CommandLine& words) {
  return with_files(files, read_config(files, file, words));
}

std::vector<std::filesystem::path> read_by(const Config& config) {
  std::vector<std::filesystem::path> files = config.input;
  if (!config.placement.metadata.empty())
    files.push_back(config.placement.metadata);
  if (!config.texture.drape.empty())
    files.push_back(config.texture.drape);
  if (!config.objects.table.empty())
    files.push_back(config.objects.table);
  return files;
}

Json resolved_json(const Config& config) {
  Config resolved = config;
  resolved.up = config.up_axis();
  if (!resolved.simplify.vertices && !resolved.partition.count) {
    resolved.simplify.vertices = resolved.partition.vertices;
  }
  Json result = Json::object();
  for (const ConfigKey& key : config_keys()) {
    const bool is_told = key.decides_result && !is_of_paths(key);
    Json value = is_told ? key.show(resolved) : Json();
    if (!value.is_null())
      result[json_pointer_to(key.path)] = std::move(value);
  }
  // "vertices" has a value even if "count" overrules it.
  if (resolved.partition.count)
    result["partition"].erase("vertices");
  return result;
}

namespace {

Json absolute(const Json& path, const std::filesystem::path& directory) {
  return Json((directory / path.get<std::string>()).string());
}

Json with_absolute_paths(const ConfigKey& key, Json value, const std::filesystem::path& directory) {
  if (key.kind == KeyKind::path || (key.kind == KeyKind::paths && value.is_string()))
    return absolute(value, directory);
  if (key.kind == KeyKind::paths) {
    for (Json& one : value)
      one = absolute(one, directory);
  }
  return value;
}

}  // namespace

std::string complete_text(const Config& config, const std::filesystem::path& directory) {
  Json result = Json::object();
  for (const ConfigKey& key : config_keys()) {
    Json value = key.show(config);
    if (!value.is_null())
      result[json_pointer_to(key.path)] = with_absolute_paths(key, std::move(value), directory);
  }
  if (config.partition.count)
    result["partition"].erase("vertices");
  try {
    return storage::json_text(result, {.throws = true});
  } catch (const Json::exception&) {
    throw Error(ErrorCode::usage,
                "a path or text of the config is not UTF-8: it cannot be written "
                "down for other machines");
  }
}

}  // namespace meshhier::config
