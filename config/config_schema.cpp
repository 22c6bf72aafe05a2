#include "config/config_schema.h"

#include "config/view_config.h"
#include "execution/size_text.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_folder.h"
#include "storage/format/manifest.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::config {

namespace {

using Json = nlohmann::ordered_json;

/// Fewer than 4 vertices hold no solid; tile indices are 16 bits wide and half of them are kept for
/// ghosts.
constexpr double kFewestTileVertices = 4;
constexpr double kMostTileVertices = 32768;
/// A mesh of 2^32 vertices has so many partitions at the fewest vertices.
constexpr double kMostPartitions = 1073741824;
/// A sector needs its own lines within the outline's 32 kB: beyond this no line would be left to
/// draw.
constexpr double kMostSectors = 65536;
/// No machine has more threads: this catches a size that was meant for the budget.
constexpr double kMostThreads = 4096;
/// Each is a line of the manifest and of the journal, which have a MiB.
constexpr double kMostInputs = 100000;
/// A mesh has no more.
constexpr double kMostAttributes = kMaxValueChannels;
/// The most bytes of a text that the manifest repeats, which has 1 MiB.
constexpr double kMostTextBytes = 32768;
/// JSON numbers are exact up to here.
constexpr double kMostBytes = 9007199254740991.0;  // 2^53 - 1

/// A half turn in degrees.
constexpr double kHalfTurn = 180;
/// Beyond any orbit: such a number is in other units.
constexpr double kMostMetres = 1e9;

struct Limits {
  double minimum;
  double maximum;
};

/// The picture of a simplified tile: smaller ones show nothing, larger ones are no tile's.
constexpr Limits kTexels{64, 4096};

constexpr Limits kTileVertices{kFewestTileVertices, kMostTileVertices};

template <class Field>
struct Unwrapped {
  using Type = Field;
};
template <class Field>
struct Unwrapped<std::optional<Field>> {
  using Type = Field;
};

template <class Value>
Json shown(const Value& value) {
  return value;
}
template <class Value>
Json shown(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

// Each of these completes the row of one kind of key. `field` turns a Config& or a const Config&
// into a reference to the member that holds the value.

ConfigKey ignored_text(ConfigKey key) {
  key.kind = KeyKind::text;
  key.maximum = kMostTextBytes;
  key.assign = [](Config&, const Json&) {};
  key.show = [](const Config&) { return Json(); };
  return key;
}

template <class Field>
ConfigKey path(ConfigKey key, Field field) {
  key.kind = KeyKind::path;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) {
    return field(config).empty() ? Json() : Json(field(config).string());
  };
  return key;
}

template <class Field>
ConfigKey required_paths(ConfigKey key, double most, Field field) {
  key.kind = KeyKind::paths;
  key.required = true;
  key.maximum = most;
  key.assign = [field](Config& config, const Json& value) {
    field(config).clear();
    for (const Json& one : value.is_array() ? value : Json::array({value}))
      field(config).emplace_back(one.get<std::string>());
  };
  key.show = [field](const Config& config) {
    Json all = Json::array();
    for (const std::filesystem::path& one : field(config))
      all.push_back(one.string());
    return all.empty() ? Json() : all.size() == 1 ? all[0] : all;
  };
  return key;
}

template <class Field>
ConfigKey boolean(ConfigKey key, Field field) {
  key.kind = KeyKind::boolean;
  key.assign = [field](Config& config, const Json& value) { field(config) = value.get<bool>(); };
  key.show = [field](const Config& config) { return Json(field(config)); };
  return key;
}

template <class Field>
ConfigKey bytes(ConfigKey key, Field field) {
  key.kind = KeyKind::size;
  key.minimum = 1;
  key.maximum = kMostBytes;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.is_string() ? *execution::parse_size(value.get_ref<const std::string&>())
                                      : static_cast<std::uint64_t>(value.get<double>());
  };
  key.show = [field](const Config& config) {
    const std::optional<std::uint64_t>& bytes = field(config);
    return bytes ? Json(execution::exact_size_text(*bytes)) : Json();
  };
  return key;
}

/// A key for an integer or, for a field of floating point, a number.
template <class Field>
ConfigKey number(ConfigKey key, Limits limits, Field field) {
  using Member = std::remove_reference_t<decltype(field(std::declval<Config&>()))>;
  using Number = typename Unwrapped<Member>::Type;
  key.kind = std::is_integral_v<Number> ? KeyKind::integer : KeyKind::number;
  key.minimum = limits.minimum;
  key.maximum = limits.maximum;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = static_cast<Number>(value.get<double>());
  };
  key.show = [field](const Config& config) { return shown(field(config)); };
  return key;
}

template <class Field>
ConfigKey text(ConfigKey key, Field field) {
  key.kind = KeyKind::text;
  key.maximum = kMostTextBytes;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) {
    return field(config).empty() ? Json() : Json(field(config));
  };
  return key;
}

/// A key for an optional string, of which an empty one is a value.
template <class Field>
ConfigKey optional_text(ConfigKey key, Field field) {
  key.kind = KeyKind::text;
  key.maximum = kMostTextBytes;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) { return shown(field(config)); };
  return key;
}

/// A key for an optional array.
template <class Field>
ConfigKey numbers(ConfigKey key, Field field) {
  using Array =
      typename Unwrapped<std::remove_reference_t<decltype(field(std::declval<Config&>()))>>::Type;
  key.kind = KeyKind::numbers;
  key.maximum = static_cast<double>(std::tuple_size_v<Array>);
  key.assign = [field](Config& config, const Json& value) { field(config) = value.get<Array>(); };
  key.show = [field](const Config& config) { return shown(field(config)); };
  return key;
}

/// A key for optional TargetVertexCounts. A list of one is the number: it means the same.
template <class Field>
ConfigKey levels(ConfigKey key, Limits limits, Field field) {
  key.kind = KeyKind::levels;
  key.minimum = limits.minimum;
  key.maximum = limits.maximum;
  key.most_levels = TargetVertexCounts::kMostLevels;
  key.assign = [field](Config& config, const Json& value) {
    std::vector<std::uint32_t> by_level;
    for (const Json& one : value.is_array() ? value : Json::array({value}))
      by_level.push_back(static_cast<std::uint32_t>(one.get<double>()));
    field(config) = TargetVertexCounts(std::move(by_level));
  };
  key.show = [field](const Config& config) {
    if (!field(config))
      return Json();
    const std::span<const std::uint32_t> by_level = field(config)->by_level();
    return by_level.size() == 1 ? Json(by_level[0]) : Json(by_level);
  };
  return key;
}

template <class Names, class Field>
ConfigKey choice(ConfigKey key, const Names& names, Field field) {
  key.kind = KeyKind::choice;
  for (const auto& named : names)
    key.choices.emplace_back(named.name);
  key.assign = [field, names](Config& config, const Json& value) {
    for (const auto& named : names) {
      if (named.name == value.get_ref<const std::string&>())
        field(config) = named.value;
    }
  };
  key.show = [field, names](const Config& config) {
    for (const auto& named : names) {
      if (named.value == field(config))
        return Json(named.name);
    }
    return Json();
  };
  return key;
}

ConfigKey attributes(ConfigKey key) {
  using Which = mesh_io::AttributeChoice::Which;
  key.kind = KeyKind::names;
  key.maximum = kMostAttributes;
  key.choices = {"all", "none"};
  key.assign = [](Config& config, const Json& value) {
    config.attributes.which = value == "all"    ? Which::all
                              : value == "none" ? Which::none
                                                : Which::named;
    config.attributes.names.clear();
    if (value.is_array())
      value.get_to(config.attributes.names);
  };
  key.show = [](const Config& config) {
    switch (config.attributes.which) {
      case Which::all:
        return Json("all");
      case Which::none:
        return Json("none");
      case Which::named:
        break;
    }
    return Json(config.attributes.names);
  };
  return key;
}

ConfigKey labels(ConfigKey key) {
  key.kind = KeyKind::names;
  key.maximum = kMostAttributes;
  key.choices = {"integers"};
  key.assign = [](Config& config, const Json& value) {
    config.attributes.labels.reset();
    if (value.is_array())
      config.attributes.labels = value.get<std::vector<std::string>>();
  };
  key.show = [](const Config& config) {
    return config.attributes.labels ? Json(*config.attributes.labels) : Json("integers");
  };
  return key;
}

ConfigKey object_source(ConfigKey key) {
  key.kind = KeyKind::choice;
  key.prefix = mesh_io::kObjectLabel;
  for (const auto& row : mesh_io::kObjectSources)
    key.choices.emplace_back(row.name);
  key.assign = [](Config& config, const Json& value) {
    config.objects.from = mesh_io::object_choice_of(value.get_ref<const std::string&>()).value();
  };
  key.show = [](const Config& config) { return Json(text_of(config.objects.from)); };
  return key;
}

/// A key that is told only where it is not what it is by default: builds without it tell what they
/// did before there was such a key.
ConfigKey untold_by_default(ConfigKey key) {
  key.show = [show = key.show, usual = key.show(Config())](const Config& config) {
    Json value = show(config);
    return value == usual ? Json() : value;
  };
  return key;
}

ConfigKey deciding(ConfigKey key) {
  key.decides_result = true;
  return key;
}

/// A change here changes the documents too: scripts/references writes them anew.
std::vector<ConfigKey> make_config_keys() {
  return {
      ignored_text(
          {.path = "$schema", .meaning = "where the JSON schema is, for editors; no other effect"}),
      required_paths(
          {.path = "input",
           .meaning =
               fmt::format("the mesh: a {} file, perhaps in gzip, a tileset of 3D Tiles, or a "
                           "folder with {}; the files of a list are joined in its order",
                           mesh_io::format_names(), mesh_io::folder_names()),
           .decides_result = true},
          kMostInputs, [](auto& c) -> auto& { return c.input; }),
      path(
          {.path = "output",
           .meaning = "the hierarchy to make: a directory, or a file if `storage.container` is "
                      "`3tz`; missing parent directories are made",
           .required = true},
          [](auto& c) -> auto& { return c.output; }),
      bytes(
          {.path = "memory_budget",
           .meaning = "peak resident memory of the build",
           .unset = "a quarter of the memory that the process may use, from 512 MiB to 16 GiB"},
          [](auto& c) -> auto& { return c.memory_budget; }),
      number(
          {.path = "threads", .meaning = "threads at work; 0: as many as the machine has"},
          {0, kMostThreads}, [](auto& c) -> auto& { return c.threads; }),
      deciding(numbers(
          {.path = "crop",
           .meaning = "two corners of a box, in the input's coordinates: only triangles that touch "
                      "it are built, whole",
           .unset = "all"},
          [](auto& c) -> auto& { return c.crop; })),
      deciding(boolean(
          {.path = "weld",
           .meaning = "vertices of equal position and equal attributes become one; those of an STL "
                      "file, which have no numbers of their own, always do"},
          [](auto& c) -> auto& { return c.weld; })),
      deciding(choice(
          {.path = "topology",
           .meaning = "which vertices are one point of the surface: all at one place, whatever "
                      "their attributes (`place`), or each by itself (`index`)"},
          kTopologies, [](auto& c) -> auto& { return c.topology; })),
      deciding(attributes(
          {.path = "attributes",
           .meaning = "which numbers of vertices are kept besides normals, colours and texture "
                      "coordinates: `all`, `none`, or a list of their names"})),
      deciding(labels({.path = "labels",
                       .meaning =
                           "which of them are labels, of which no means are made: those of integer "
                           "types (`integers`), or a list of names"})),
      deciding(untold_by_default(object_source(
          {.path = "objects.from",
           .meaning = "what the objects are made from: nodes of a glTF (`node`), statements `g` "
                      "(`group`), `o` (`object`) or `usemtl` (`material`) of an OBJ file, "
                      "materials of a glTF, the files of a list (`file`), solids of an ASCII STL "
                      "file (`solid`), features of a glTF or b3dm (`feature`), a label "
                      "(`label:NAME`), or nothing (`none`)",
           .unset = "`auto`: features that have properties, else `object` or `group`, named "
                    "nodes, `solid`, if there are two names or more"}))),
      deciding(path(
          {.path = "objects.table",
           .meaning = "a table of the objects' properties, CSV or lines of JSON, whose column "
                      "`id` (the value of a label or of a feature) or `name` says whose a row is; "
                      "`--object-table` of `build` sets it"},
          [](auto& c) -> auto& { return c.objects.table; })),
      deciding(untold_by_default(boolean(
          {.path = "objects.in_tiles",
           .meaning = "tiles have tables of their objects, which other viewers show: names and "
                      "properties once more in each tile",
           .unset = "`true`"},
          [](auto& c) -> auto& { return c.objects.in_tiles; }))),
      deciding(number(
          {.path = "partition.vertices", .meaning = "most vertices of a partition"}, kTileVertices,
          [](auto& c) -> auto& { return c.partition.vertices; })),
      deciding(number(
          {.path = "partition.count",
           .meaning = "number of partitions, any",
           .excludes = {"vertices"}},
          {1, kMostPartitions}, [](auto& c) -> auto& { return c.partition.count; })),
      deciding(choice(
          {.path = "partition.axis",
           .meaning = "how a split direction is chosen: the shortest boundary "
                      "(`compactness`), or the longest axis of the bounding box"},
          kAxisRules, [](auto& c) -> auto& { return c.partition.axis; })),
      deciding(choice(
          {.path = "simplify.method",
           .meaning = "how coarser tiles are made: `edge_collapse` moves an edge to the point of "
                      "least quadric error; `half_edge` moves a vertex onto another, so coarse "
                      "vertices are a subset of the finer ones; `cluster` makes one vertex of each "
                      "cell of equal vertex count"},
          kSimplifyMethods, [](auto& c) -> auto& { return c.simplify.method; })),
      deciding(levels(
          {.path = "simplify.vertices",
           .meaning = "target vertex count of simplified tiles; a list is by level, from the root "
                      "down, and its last entry holds for all deeper levels",
           .unset = "as a partition has"},
          kTileVertices, [](auto& c) -> auto& { return c.simplify.vertices; })),
      deciding(choice(
          {.path = "simplify.representative",
           .meaning = "of `cluster`: which point stands for a cell, the `mean` of its "
                      "vertices, the point of least `quadric` error, or the best "
                      "original `vertex`"},
          kRepresentatives, [](auto& c) -> auto& { return c.simplify.representative; })),
      deciding(choice(
          {.path = "simplify.cost",
           .meaning = "of `half_edge`: what a collapse costs, by `quadric` error, or by "
                      "length and curvature (`melax`)"},
          kHalfEdgeCosts, [](auto& c) -> auto& { return c.simplify.cost; })),
      deciding(number(
          {.path = "outline.sectors",
           .meaning = "about how many sectors the outline draws the boundaries of: tiles of one "
                      "level, or parts of these"},
          {1, kMostSectors}, [](auto& c) -> auto& { return c.outline.sectors; })),
      deciding(number(
          {.path = "outline.tolerance",
           .meaning = "how far a line may move to have fewer points, as a part of the "
                      "bounding-box diagonal"},
          {0, 1}, [](auto& c) -> auto& { return c.outline.tolerance; })),
      deciding(boolean(
          {.path = "preview",
           .meaning =
               "`preview.webp`, a picture of the whole model for galleries and file managers"},
          [](auto& c) -> auto& { return c.preview; })),
      deciding(number(
          {.path = "first_view.azimuth",
           .meaning = "where `preview.webp`, the outline, viewers and `meshhier preview` look "
                      "from first: degrees from the model's front to its right",
           .unset = "chosen by the build",
           .needs = {"elevation"}},
          {-2 * kHalfTurn, 2 * kHalfTurn}, [](auto& c) -> auto& { return c.first_view.azimuth; })),
      deciding(number(
          {.path = "first_view.elevation",
           .meaning = "degrees above its equator; 90 is from above, -90 from below",
           .unset = "chosen by the build",
           .needs = {"azimuth"},
           .takes_minimum = true},
          {-kHalfTurn / 2, kHalfTurn / 2},
          [](auto& c) -> auto& { return c.first_view.elevation; })),
      choice(
          {.path = "storage.container",
           .meaning = "a directory (`files`), or one file, a 3D Tiles archive with the same "
                      "files in it (`3tz`)"},
          kContainers, [](auto& c) -> auto& { return c.storage.container; }),
      deciding(choice(
          {.path = "storage.compression",
           .meaning = "how tiles are packed: plain glTF (`none`), a gzip stream each (`zlib`), "
                      "`EXT_meshopt_compression` (`meshopt`), or both, the smallest; none of them "
                      "loses anything"},
          kCompressions, [](auto& c) -> auto& { return c.storage.compression; })),
      deciding(number(
          {.path = "storage.positions.bits",
           .meaning = "rounds all positions to one lattice of so many bits an axis; up "
                      "to 16 bits, tiles hold 16-bit numbers (`KHR_mesh_quantization`)",
           .unset = "none: exact"},
          {Lattice::kFewestBits, Lattice::kMostBits},
          [](auto& c) -> auto& { return c.storage.position_bits; })),
      deciding(choice(
          {.path = "storage.normals",
           .meaning = "of a mesh without normals: tiles get computed ones, `smooth` but for "
                      "creases, in 4 bytes a vertex, or `none`; normals that a mesh has stay as "
                      "they are. `auto`: `smooth`, and coarse tiles, all but three levels above "
                      "the partitions, get a normal map of the original surface where its bytes "
                      "are worth more than triangles; none where there are pictures. `map`: all "
                      "simplified tiles get one, and pictures are lit"},
          kNormals, [](auto& c) -> auto& { return c.storage.normals; })),
      deciding(number(
          {.path = "normal_map.texels",
           .meaning = "side of a normal map, at most; there are fewer texels where the "
                      "original has no more to show, and beside a picture as many as it has"},
          kTexels, [](auto& c) -> auto& { return c.normal_map.texels; })),
      deciding(choice(
          {.path = "normal_map.format",
           .meaning =
               "how normal maps are stored; `png` and `webp` lose nothing, `ktx2` (UASTC) stays "
               "compressed in the memory of graphics devices"},
          kImageFormats, [](auto& c) -> auto& { return c.normal_map.format.format; })),
      deciding(number(
          {.path = "normal_map.quality", .meaning = "of `jpeg`"}, {1, kBestQuality},
          [](auto& c) -> auto& { return c.normal_map.format.quality; })),
      deciding(boolean(
          {.path = "texture.use",
           .meaning =
               "tiles show the pictures or colours of the mesh's materials; `false` leaves both "
               "out and keeps texture coordinates as they are"},
          [](auto& c) -> auto& { return c.texture.use; })),
      deciding(path(
          {.path = "texture.drape",
           .meaning =
               "an orthophoto (GeoTIFF) that heights of a raster show, by its own place, CRS "
               "and resolution; `--drape` of `build` sets it"},
          [](auto& c) -> auto& { return c.texture.drape; })),
      deciding(number(
          {.path = "texture.texels",
           .meaning = "side of the picture of a simplified tile, at most; partitions have the "
                      "input's texels"},
          kTexels, [](auto& c) -> auto& { return c.texture.texels; })),
      deciding(choice(
          {.path = "texture.format",
           .meaning =
               "how pictures of tiles are stored; with `jpeg`, those with transparent texels "
               "are PNG; `ktx2` stays compressed in the memory of graphics devices, where others "
               "take four to eight times as much; below a quality of 100 it wants Node.js where "
               "it is built"},
          kImageFormats, [](auto& c) -> auto& { return c.texture.format.format; })),
      deciding(number(
          {.path = "texture.quality",
           .meaning = "of `jpeg`, `webp` and `ktx2`; with 100 WebP loses nothing and KTX2 is UASTC "
                      "instead of ETC1S; PNG never loses anything"},
          {1, kBestQuality}, [](auto& c) -> auto& { return c.texture.format.quality; })),
      deciding(boolean(
          {.path = "texture.unlit",
           .meaning = "viewers show the pictures as they are (`KHR_materials_unlit`): those of "
                      "photogrammetry have their light already; with normal maps they are lit in "
                      "any case"},
          [](auto& c) -> auto& { return c.texture.format.unlit; })),
      deciding(choice(
          {.path = "missing_images",
           .meaning =
               "a picture that is not there is a warning, and its material's colour is shown; "
               "a broken one is an error (`warn`) or likewise a warning (`ignore`)"},
          kMissingImages, [](auto& c) -> auto& { return c.missing_images; })),
      deciding(choice(
          {.path = "up",
           .meaning = "which axis of the input points up: `y` as in glTF, `z` as in maps and "
                      "medical images",
           .unset = "`z` of a tileset of 3D Tiles, else `y`"},
          kUpAxes, [](auto& c) -> auto& { return c.up; })),
      deciding(choice(
          {.path = "units",
           .meaning = "what lengths of the input are in: the tileset and its place are in metres, "
                      "and viewers show it (`us_ft`: the foot of US surveys)",
           .unset = "metres of glTF, else not known: placed as metres, or as the map's unit"},
          kUnits, [](auto& c) -> auto& { return c.units; })),
      deciding(number(
          {.path = "placement.longitude", .meaning = "degrees east", .needs = {"latitude"}},
          {-kHalfTurn, kHalfTurn}, [](auto& c) -> auto& { return c.placement.longitude; })),
      deciding(number(
          {.path = "placement.latitude", .meaning = "degrees north", .needs = {"longitude"}},
          {-kHalfTurn / 2, kHalfTurn / 2}, [](auto& c) -> auto& { return c.placement.latitude; })),
      deciding(number(
          {.path = "placement.height",
           .meaning = "metres above the ellipsoid",
           .unset = "0",
           .needs = {"longitude"}},
          {-kMostMetres, kMostMetres}, [](auto& c) -> auto& { return c.placement.height; })),
      deciding(optional_text(
          {.path = "placement.crs",
           .meaning = "instead of a place: the reference system (CRS) of a model in map "
                      "coordinates, as PROJ takes it: `EPSG:25832`, `EPSG:32633+5773`, WKT, a "
                      "PROJ string; heights in degrees are brought there",
           .excludes = {"longitude", "transform"}},
          [](auto& c) -> auto& { return c.placement.crs; })),
      deciding(numbers(
          {.path = "placement.offset",
           .meaning = "what makes map coordinates when it is added to the model's z-up coordinates",
           .unset = "[0, 0, 0]",
           .needs = {"crs", "metadata"}},
          [](auto& c) -> auto& { return c.placement.offset; })),
      deciding(path(
          {.path = "placement.metadata",
           .meaning = "a file that crs and offset are read from, unless they are given: "
                      "`metadata.xml`, `coords.txt`, `offset.xyz`, a `.prj`",
           .excludes = {"longitude", "transform"}},
          [](auto& c) -> auto& { return c.placement.metadata; })),
      deciding(numbers(
          {.path = "placement.anchor",
           .meaning = "the point of the model, in input coordinates, that stands at that place; "
                      "with a map, the point where the transform is exact",
           .unset = "[0, 0, 0]; with a map, the middle of the bounding box",
           .needs = {"longitude", "crs", "metadata"}},
          [](auto& c) -> auto& { return c.placement.anchor; })),
      deciding(numbers(
          {.path = "placement.transform",
           .meaning = "instead of a place: the matrix of the tileset's root, column "
                      "by column, from z-up coordinates (in metres, if `units` are given)",
           .excludes = {"longitude"}},
          [](auto& c) -> auto& { return c.placement.transform; })),
      deciding(number(
          {.path = "tileset.pixels",
           .meaning = "the tileset's `geometricError` is a tile's error times this: pixels that a "
                      "viewer of 3D Tiles allows for by default, where the error shall be one "
                      "pixel; 1: the error itself",
           .takes_minimum = true},
          {storage::kFewestTilesetPixels, storage::kMostTilesetPixels},
          [](auto& c) -> auto& { return c.tileset.pixels; })),
      deciding(text(
          {.path = "licence", .meaning = "the licence of the model, a text in the tileset"},
          [](auto& c) -> auto& { return c.licence; })),
  };
}

bool is_number_within(const ConfigKey& key, const Json& value) {
  if (!value.is_number() || !(value.get<double>() <= key.maximum))
    return false;
  return key.takes_minimum ? value.get<double>() >= key.minimum : value.get<double>() > key.minimum;
}

bool is_integer_within(const ConfigKey& key, const Json& value) {
  if (!value.is_number())
    return false;
  const auto number = value.get<double>();
  return std::trunc(number) == number && number >= key.minimum && number <= key.maximum;
}

bool is_size_within(const ConfigKey& key, const Json& value) {
  if (!value.is_string())
    return is_integer_within(key, value);
  const std::optional<std::uint64_t> parsed =
      execution::parse_size(value.get_ref<const std::string&>());
  return parsed && static_cast<double>(*parsed) >= key.minimum;
}

bool is_list_of_numbers(const ConfigKey& key, const Json& value) {
  return value.is_array() && static_cast<double>(value.size()) == key.maximum &&
         std::all_of(value.begin(), value.end(), [](const Json& number) {
           return number.is_number() && std::isfinite(number.get<double>());
         });
}

bool is_list_of_levels(const ConfigKey& key, const Json& value) {
  const ConfigKey entry = level_entry(key);
  return value.is_array() && !value.empty() && value.size() <= key.most_levels &&
         std::all_of(value.begin(), value.end(),
                     [&](const Json& one) { return accepts(entry, one); });
}

bool is_choice(const ConfigKey& key, const Json& value) {
  if (!value.is_string())
    return false;
  const std::string_view text = value.get_ref<const std::string&>();
  if (!key.prefix.empty() && text.starts_with(key.prefix))
    return is_attribute_name(text.substr(key.prefix.size()));
  return std::ranges::find(key.choices, text) != key.choices.end();
}

bool is_list_of_names(const ConfigKey& key, const Json& value) {
  return value.is_array() && static_cast<double>(value.size()) <= key.maximum &&
         std::all_of(value.begin(), value.end(), [](const Json& name) {
           return name.is_string() && is_attribute_name(name.get_ref<const std::string&>());
         });
}

bool is_usable_path(const Json& value) {
  if (!value.is_string())
    return false;
  const auto& text = value.get_ref<const std::string&>();
  return !text.empty() && text.find('\0') == std::string::npos;
}

}  // namespace

const std::vector<ConfigKey>& config_keys() {
  static const std::vector<ConfigKey> keys = [] {
    std::vector<ConfigKey> all = make_config_keys();
    const auto behind = std::ranges::find(all, "first_view.elevation", &ConfigKey::path) + 1;
    std::vector<ConfigKey> view = view_config_keys();
    all.insert(behind, std::move_iterator(view.begin()), std::move_iterator(view.end()));
    return all;
  }();
  return keys;
}

const std::vector<ConfigSection>& config_sections() {
  static const std::vector<ConfigSection> sections = {
      {"objects",
       "the things that the mesh consists of, with names and properties; a text is the key `from`",
       "from"},
      {"partition", "how the mesh is cut into partitions, the finest tiles"},
      {"simplify", "how the coarser tiles are made"},
      {"outline", "the shape-outline, the lines that are shown first"},
      {"first_view", "from where the model is looked at before anybody turns it"},
      {"view",
       "how the model is shown first, in `preview.webp`, viewers and `meshhier preview`, unless "
       "they are told otherwise; `meshhier view` changes it later"},
      {"storage", "how tiles are stored"},
      {"storage.positions", "how positions are rounded; without it they keep every bit"},
      {"normal_map", "what normal maps of simplified tiles are like"},
      {"texture", "what becomes of the pictures of a textured mesh"},
      {"placement",
       "where the tileset puts the model: on the globe (WGS 84), x to the east; where its map "
       "coordinates are; or anywhere by a transform"},
      {"tileset", "what viewers of 3D Tiles are told"}};
  return sections;
}

const ConfigKey* find_config_key(std::string_view path) {
  const std::vector<ConfigKey>& keys = config_keys();
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const ConfigKey& key) { return key.path == path; });
  return found == keys.end() ? nullptr : &*found;
}

const ConfigSection* find_config_section(std::string_view path) {
  const std::vector<ConfigSection>& sections = config_sections();
  const auto found = std::ranges::find(sections, path, &ConfigSection::path);
  return found == sections.end() ? nullptr : &*found;
}

bool is_config_section(std::string_view path) {
  return find_config_section(path) != nullptr;
}

Json::json_pointer json_pointer_to(std::string path) {
  std::replace(path.begin(), path.end(), '.', '/');
  return Json::json_pointer('/' + path);
}

bool accepts(const ConfigKey& key, const Json& value) {
  switch (key.kind) {
    case KeyKind::text:
      return value.is_string() &&
             static_cast<double>(value.get_ref<const std::string&>().size()) <= key.maximum;
    case KeyKind::path:
      return is_usable_path(value);
    case KeyKind::paths:
      return is_usable_path(value) || (value.is_array() && !value.empty() &&
                                       static_cast<double>(value.size()) <= key.maximum &&
                                       std::all_of(value.begin(), value.end(), is_usable_path));
    case KeyKind::boolean:
      return value.is_boolean();
    case KeyKind::integer:
      return is_integer_within(key, value);
    case KeyKind::number:
      return is_number_within(key, value);
    case KeyKind::numbers:
      return is_list_of_numbers(key, value);
    case KeyKind::levels:
      return is_integer_within(key, value) || is_list_of_levels(key, value);
    case KeyKind::size:
      return is_size_within(key, value);
    case KeyKind::choice:
      return is_choice(key, value);
    case KeyKind::names:
      return is_choice(key, value) || is_list_of_names(key, value);
    case KeyKind::view:
      return storage::accepts(*key.view, value);
  }
  return false;
}

ConfigKey level_entry(const ConfigKey& key) {
  return {.path = key.path,
          .meaning = key.meaning,
          .kind = KeyKind::integer,
          .minimum = key.minimum,
          .maximum = key.maximum};
}

std::string expectation(const ConfigKey& key) {
  switch (key.kind) {
    case KeyKind::text:
      return fmt::format("a string of at most {:.0f} bytes", key.maximum);
    case KeyKind::path:
      return "a path";
    case KeyKind::paths:
      return fmt::format("a path or a list of 1 to {:.0f} paths", key.maximum);
    case KeyKind::boolean:
      return "true or false";
    case KeyKind::integer:
      return fmt::format("an integer from {:.0f} to {:.0f}", key.minimum, key.maximum);
    case KeyKind::number:
      return key.takes_minimum
                 ? fmt::format("a number from {} to {}", key.minimum, key.maximum)
                 : fmt::format("a number above {} and at most {}", key.minimum, key.maximum);
    case KeyKind::numbers:
      return fmt::format("a list of {:.0f} numbers", key.maximum);
    case KeyKind::levels:
      return fmt::format("{} or a list of 1 to {} of them", expectation(level_entry(key)),
                         key.most_levels);
    case KeyKind::size:
      return std::string(execution::kSizeSyntax);
    case KeyKind::view:
      return storage::expectation(*key.view);
    case KeyKind::choice:
    case KeyKind::names:
      break;
  }
  return fmt::format("{}\"{}\"{}", key.choices.size() > 1 ? "one of " : "",
                     fmt::join(key.choices, "\", \""),
                     key.kind == KeyKind::names ? " or a list of names"
                     : !key.prefix.empty()      ? fmt::format(" or \"{}NAME\"", key.prefix)
                                                : "");
}

}  // namespace meshhier::config
