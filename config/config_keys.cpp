#include "config/config_schema.h"
#include "config/key_kinds.h"
#include "config/view_config.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_folder.h"
#include "storage/format/manifest.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

namespace meshhier::config {
namespace {

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

/// A half turn in degrees.
constexpr double kHalfTurn = 180;
/// Beyond any orbit: such a number is in other units.
constexpr double kMostMetres = 1e9;

/// The picture of a simplified tile: smaller ones show nothing, larger ones are no tile's.
constexpr Limits kTexels{64, 4096};

constexpr Limits kTileVertices{kFewestTileVertices, kMostTileVertices};

// A change here changes the documents too: scripts/references writes them anew.

std::vector<ConfigKey> input_keys() {
  return {
      ignored_text(
          {.path = "$schema", .meaning = "where the JSON schema is, for editors; no other effect"}),
      required_paths({.path = "input",
                      .meaning = fmt::format(
                          "the mesh: a {} file, perhaps in gzip, a tileset of 3D Tiles, or a "
                          "folder with {}; the files of a list are joined in its order",
                          mesh_io::format_names(), mesh_io::folder_names()),
                      .decides_result = true},
                     kMostInputs, member([](auto& c) -> auto& { return c.input; })),
      path({.path = "output",
            .meaning = "the hierarchy to make: a directory, or a file if `storage.container` is "
                       "`3tz`; missing parent directories are made",
            .required = true},
           member([](auto& c) -> auto& { return c.output; })),
      bytes({.path = "memory_budget",
             .meaning = "peak resident memory of the build",
             .unset = "a quarter of the memory that the process may use, from 512 MiB to 16 GiB"},
            member([](auto& c) -> auto& { return c.memory_budget; })),
      number({.path = "threads", .meaning = "threads at work; 0: as many as the machine has"},
             {0, kMostThreads}, member([](auto& c) -> auto& { return c.threads; })),
      deciding(numbers(
          {.path = "crop",
           .meaning = "two corners of a box, in the input's coordinates: only triangles that touch "
                      "it are built, whole",
           .unset = "all"},
          member([](auto& c) -> auto& { return c.crop; }))),
      deciding(boolean(
          {.path = "weld",
           .meaning = "vertices of equal position and equal attributes become one; those of an STL "
                      "file, which have no numbers of their own, always do"},
          member([](auto& c) -> auto& { return c.weld; }))),
      deciding(choice(
          {.path = "topology",
           .meaning = "which vertices are one point of the surface: all at one place, whatever "
                      "their attributes (`place`), or each by itself (`index`)"},
          kTopologies, member([](auto& c) -> auto& { return c.topology; }))),
      deciding(attributes(
          {.path = "attributes",
           .meaning = "which numbers of vertices are kept besides normals, colours and texture "
                      "coordinates: `all`, `none`, or a list of their names"})),
      deciding(labels({.path = "labels",
                       .meaning =
                           "which of them are labels, of which no means are made: those of integer "
                           "types (`integers`), or a list of names"})),
  };
}

std::vector<ConfigKey> object_keys() {
  return {
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
          member([](auto& c) -> auto& { return c.objects.table; }))),
      deciding(untold_by_default(boolean(
          {.path = "objects.in_tiles",
           .meaning = "tiles have tables of their objects, which other viewers show: names and "
                      "properties once more in each tile",
           .unset = "`true`"},
          member([](auto& c) -> auto& { return c.objects.in_tiles; })))),
  };
}

std::vector<ConfigKey> tree_keys() {
  return {
      deciding(number({.path = "partition.vertices", .meaning = "most vertices of a partition"},
                      kTileVertices,
                      member([](auto& c) -> auto& { return c.partition.vertices; }))),
      deciding(number({.path = "partition.count",
                       .meaning = "number of partitions, any",
                       .excludes = {"vertices"}},
                      {1, kMostPartitions},
                      member([](auto& c) -> auto& { return c.partition.count; }))),
      deciding(choice({.path = "partition.axis",
                       .meaning = "how a split direction is chosen: the shortest boundary "
                                  "(`compactness`), or the longest axis of the bounding box"},
                      kAxisRules, member([](auto& c) -> auto& { return c.partition.axis; }))),
      deciding(choice(
          {.path = "simplify.method",
           .meaning = "how coarser tiles are made: `edge_collapse` moves an edge to the point of "
                      "least quadric error; `half_edge` moves a vertex onto another, so coarse "
                      "vertices are a subset of the finer ones; `cluster` makes one vertex of each "
                      "cell of equal vertex count"},
          kSimplifyMethods, member([](auto& c) -> auto& { return c.simplify.method; }))),
      deciding(levels(
          {.path = "simplify.vertices",
           .meaning = "target vertex count of simplified tiles; a list is by level, from the root "
                      "down, and its last entry holds for all deeper levels",
           .unset = "as a partition has"},
          kTileVertices, member([](auto& c) -> auto& { return c.simplify.vertices; }))),
      deciding(choice({.path = "simplify.representative",
                       .meaning = "of `cluster`: which point stands for a cell, the `mean` of its "
                                  "vertices, the point of least `quadric` error, or the best "
                                  "original `vertex`"},
                      kRepresentatives,
                      member([](auto& c) -> auto& { return c.simplify.representative; }))),
      deciding(
          choice({.path = "simplify.cost",
                  .meaning = "of `half_edge`: what a collapse costs, by `quadric` error, or by "
                             "length and curvature (`melax`)"},
                 kHalfEdgeCosts, member([](auto& c) -> auto& { return c.simplify.cost; }))),
  };
}

std::vector<ConfigKey> first_sight_keys() {
  return {
      deciding(number(
          {.path = "outline.sectors",
           .meaning = "about how many sectors the outline draws the boundaries of: tiles of one "
                      "level, or parts of these"},
          {1, kMostSectors}, member([](auto& c) -> auto& { return c.outline.sectors; }))),
      deciding(number({.path = "outline.tolerance",
                       .meaning = "how far a line may move to have fewer points, as a part of the "
                                  "bounding-box diagonal"},
                      {0, 1}, member([](auto& c) -> auto& { return c.outline.tolerance; }))),
      deciding(boolean(
          {.path = "preview",
           .meaning =
               "`preview.webp`, a picture of the whole model for galleries and file managers"},
          member([](auto& c) -> auto& { return c.preview; }))),
      deciding(number(
          {.path = "first_view.azimuth",
           .meaning = "where `preview.webp`, the outline, viewers and `meshhier preview` look "
                      "from first: degrees from the model's front to its right",
           .unset = "chosen by the build",
           .needs = {"elevation"}},
          {-2 * kHalfTurn, 2 * kHalfTurn},
          member([](auto& c) -> auto& { return c.first_view.azimuth; }))),
      deciding(number({.path = "first_view.elevation",
                       .meaning = "degrees above its equator; 90 is from above, -90 from below",
                       .unset = "chosen by the build",
                       .needs = {"azimuth"},
                       .takes_minimum = true},
                      {-kHalfTurn / 2, kHalfTurn / 2},
                      member([](auto& c) -> auto& { return c.first_view.elevation; }))),
  };
}

std::vector<ConfigKey> storage_keys() {
  return {
      choice({.path = "storage.container",
              .meaning = "a directory (`files`), or one file, a 3D Tiles archive with the same "
                         "files in it (`3tz`)"},
             kContainers, member([](auto& c) -> auto& { return c.storage.container; })),
      deciding(choice(
          {.path = "storage.compression",
           .meaning = "how tiles are packed: plain glTF (`none`), a gzip stream each (`zlib`), "
                      "`EXT_meshopt_compression` (`meshopt`), or both, the smallest; none of them "
                      "loses anything"},
          kCompressions, member([](auto& c) -> auto& { return c.storage.compression; }))),
      deciding(number({.path = "storage.positions.bits",
                       .meaning = "rounds all positions to one lattice of so many bits an axis; up "
                                  "to 16 bits, tiles hold 16-bit numbers (`KHR_mesh_quantization`)",
                       .unset = "none: exact"},
                      {Lattice::kFewestBits, Lattice::kMostBits},
                      member([](auto& c) -> auto& { return c.storage.position_bits; }))),
      deciding(choice(
          {.path = "storage.normals",
           .meaning = "of a mesh without normals: tiles get computed ones, `smooth` but for "
                      "creases, in 4 bytes a vertex, or `none`; normals that a mesh has stay as "
                      "they are. `auto`: `smooth`, and coarse tiles, all but three levels above "
                      "the partitions, get a normal map of the original surface where its bytes "
                      "are worth more than triangles; none where there are pictures. `map`: all "
                      "simplified tiles get one, and pictures are lit"},
          kNormals, member([](auto& c) -> auto& { return c.storage.normals; }))),
      deciding(number(
          {.path = "normal_map.texels",
           .meaning = "side of a normal map, at most; there are fewer texels where the "
                      "original has no more to show, and beside a picture as many as it has"},
          kTexels, member([](auto& c) -> auto& { return c.normal_map.texels; }))),
      deciding(choice(
          {.path = "normal_map.format",
           .meaning =
               "how normal maps are stored; `png` and `webp` lose nothing, `ktx2` (UASTC) stays "
               "compressed in the memory of graphics devices"},
          kImageFormats, member([](auto& c) -> auto& { return c.normal_map.format.format; }))),
      deciding(number({.path = "normal_map.quality", .meaning = "of `jpeg`"}, {1, kBestQuality},
                      member([](auto& c) -> auto& { return c.normal_map.format.quality; }))),
  };
}

std::vector<ConfigKey> texture_keys() {
  return {
      deciding(boolean(
          {.path = "texture.use",
           .meaning =
               "tiles show the pictures or colours of the mesh's materials; `false` leaves both "
               "out and keeps texture coordinates as they are"},
          member([](auto& c) -> auto& { return c.texture.use; }))),
      deciding(
          path({.path = "texture.drape",
                .meaning =
                    "an orthophoto (GeoTIFF) that heights of a raster show, by its own place, CRS "
                    "and resolution; `--drape` of `build` sets it"},
               member([](auto& c) -> auto& { return c.texture.drape; }))),
      deciding(number(
          {.path = "texture.texels",
           .meaning = "side of the picture of a simplified tile, at most; partitions have the "
                      "input's texels"},
          kTexels, member([](auto& c) -> auto& { return c.texture.texels; }))),
      deciding(choice(
          {.path = "texture.format",
           .meaning =
               "how pictures of tiles are stored; with `jpeg`, those with transparent texels "
               "are PNG; `ktx2` stays compressed in the memory of graphics devices, where others "
               "take four to eight times as much; below a quality of 100 it wants Node.js where "
               "it is built"},
          kImageFormats, member([](auto& c) -> auto& { return c.texture.format.format; }))),
      deciding(number(
          {.path = "texture.quality",
           .meaning = "of `jpeg`, `webp` and `ktx2`; with 100 WebP loses nothing and KTX2 is UASTC "
                      "instead of ETC1S; PNG never loses anything"},
          {1, kBestQuality}, member([](auto& c) -> auto& { return c.texture.format.quality; }))),
      deciding(boolean(
          {.path = "texture.unlit",
           .meaning = "viewers show the pictures as they are (`KHR_materials_unlit`): those of "
                      "photogrammetry have their light already; with normal maps they are lit in "
                      "any case"},
          member([](auto& c) -> auto& { return c.texture.format.unlit; }))),
      deciding(choice(
          {.path = "missing_images",
           .meaning =
               "a picture that is not there is a warning, and its material's colour is shown; "
               "a broken one is an error (`warn`) or likewise a warning (`ignore`)"},
          kMissingImages, member([](auto& c) -> auto& { return c.missing_images; }))),
  };
}

std::vector<ConfigKey> place_keys() {
  return {
      deciding(choice(
          {.path = "up",
           .meaning = "which axis of the input points up: `y` as in glTF, `z` as in maps and "
                      "medical images",
           .unset = "`z` of a tileset of 3D Tiles, else `y`"},
          kUpAxes, member([](auto& c) -> auto& { return c.up; }))),
      deciding(choice(
          {.path = "units",
           .meaning = "what lengths of the input are in: the tileset and its place are in metres, "
                      "and viewers show it (`us_ft`: the foot of US surveys)",
           .unset = "metres of glTF, else not known: placed as metres, or as the map's unit"},
          kUnits, member([](auto& c) -> auto& { return c.units; }))),
      deciding(number(
          {.path = "placement.longitude", .meaning = "degrees east", .needs = {"latitude"}},
          {-kHalfTurn, kHalfTurn}, member([](auto& c) -> auto& { return c.placement.longitude; }))),
      deciding(
          number({.path = "placement.latitude", .meaning = "degrees north", .needs = {"longitude"}},
                 {-kHalfTurn / 2, kHalfTurn / 2},
                 member([](auto& c) -> auto& { return c.placement.latitude; }))),
      deciding(number({.path = "placement.height",
                       .meaning = "metres above the ellipsoid",
                       .unset = "0",
                       .needs = {"longitude"}},
                      {-kMostMetres, kMostMetres},
                      member([](auto& c) -> auto& { return c.placement.height; }))),
      deciding(optional_text(
          {.path = "placement.crs",
           .meaning = "instead of a place: the reference system (CRS) of a model in map "
                      "coordinates, as PROJ takes it: `EPSG:25832`, `EPSG:32633+5773`, WKT, a "
                      "PROJ string; heights in degrees are brought there",
           .excludes = {"longitude", "transform"}},
          member([](auto& c) -> auto& { return c.placement.crs; }))),
      deciding(numbers(
          {.path = "placement.offset",
           .meaning = "what makes map coordinates when it is added to the model's z-up coordinates",
           .unset = "[0, 0, 0]",
           .needs = {"crs", "metadata"}},
          member([](auto& c) -> auto& { return c.placement.offset; }))),
      deciding(path({.path = "placement.metadata",
                     .meaning = "a file that crs and offset are read from, unless they are given: "
                                "`metadata.xml`, `coords.txt`, `offset.xyz`, a `.prj`",
                     .excludes = {"longitude", "transform"}},
                    member([](auto& c) -> auto& { return c.placement.metadata; }))),
      deciding(numbers(
          {.path = "placement.anchor",
           .meaning = "the point of the model, in input coordinates, that stands at that place; "
                      "with a map, the point where the transform is exact",
           .unset = "[0, 0, 0]; with a map, the middle of the bounding box",
           .needs = {"longitude", "crs", "metadata"}},
          member([](auto& c) -> auto& { return c.placement.anchor; }))),
      deciding(
          numbers({.path = "placement.transform",
                   .meaning = "instead of a place: the matrix of the tileset's root, column "
                              "by column, from z-up coordinates (in metres, if `units` are given)",
                   .excludes = {"longitude"}},
                  member([](auto& c) -> auto& { return c.placement.transform; }))),
      deciding(number(
          {.path = "tileset.pixels",
           .meaning = "the tileset's `geometricError` is a tile's error times this: pixels that a "
                      "viewer of 3D Tiles allows for by default, where the error shall be one "
                      "pixel; 1: the error itself",
           .takes_minimum = true},
          {storage::kFewestTilesetPixels, storage::kMostTilesetPixels},
          member([](auto& c) -> auto& { return c.tileset.pixels; }))),
      deciding(
          text({.path = "licence", .meaning = "the licence of the model, a text in the tileset"},
               member([](auto& c) -> auto& { return c.licence; }))),
  };
}

}  // namespace

const std::vector<ConfigKey>& config_keys() {
  static const std::vector<ConfigKey> keys = [] {
    std::vector<ConfigKey> all;
    for (const auto make : {input_keys, object_keys, tree_keys, first_sight_keys, view_config_keys,
                            storage_keys, texture_keys, place_keys})
      std::ranges::move(make(), std::back_inserter(all));
    return all;
  }();
  return keys;
}

}  // namespace meshhier::config
