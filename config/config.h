// The config of a build, as values.
//
// The keys, their ranges and their meanings are listed once, in config_schema.cpp.
#pragma once

#include "base/bounds.h"
#include "base/named_value.h"
#include "cluster_simplify/contraction.h"
#include "hierarchy/frame.h"
#include "hierarchy/model_view.h"
#include "hierarchy/standpoint.h"
#include "hierarchy/target_vertex_counts.h"
#include "hierarchy/texture.h"
#include "hierarchy/topology.h"
#include "hierarchy/unit.h"
#include "mesh_io/attribute_choice.h"
#include "mesh_io/input_paths.h"
#include "mesh_io/object_choice.h"
#include "partition/direction.h"
#include "storage/format/tile_glb.h"
#include "storage/format/work_directory.h"
#include "storage/io/file.h"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::config {

/// The rule by which a node's split direction is chosen.
using AxisRule = partition::Axis;
inline constexpr std::array kAxisRules{NamedValue{"compactness", AxisRule::compactness},
                                       NamedValue{"longest", AxisRule::longest}};

struct PartitionConfig {
  /// Upper bound per partition, 4 to 32768; without effect if `count` is set.
  std::uint32_t vertices = kDefaultTileVertices;
  std::optional<std::uint32_t> count;  ///< number of partitions, >= 1
  AxisRule axis = AxisRule::compactness;
  friend bool operator==(const PartitionConfig&, const PartitionConfig&) = default;
};

/// The method by which a tile is contracted. A new method has its name here.
using SimplifyMethod = cluster_simplify::Method;
inline constexpr std::array kSimplifyMethods{
    NamedValue{"edge_collapse", SimplifyMethod::edge_collapse},
    NamedValue{"half_edge", SimplifyMethod::half_edge},
    NamedValue{"cluster", SimplifyMethod::cluster}};

using Representative = cluster_simplify::Representative;
inline constexpr std::array kRepresentatives{NamedValue{"mean", Representative::mean},
                                             NamedValue{"quadric", Representative::quadric},
                                             NamedValue{"vertex", Representative::vertex}};

using HalfEdgeCost = cluster_simplify::HalfEdgeCost;
inline constexpr std::array kHalfEdgeCosts{NamedValue{"quadric", HalfEdgeCost::quadric},
                                           NamedValue{"melax", HalfEdgeCost::melax}};

struct SimplifyConfig {
  SimplifyMethod method = SimplifyMethod::edge_collapse;
  std::optional<TargetVertexCounts>
      vertices;  ///< a simplified tile's, 4 to 32768 each; not set: as many as a partition has
  Representative representative = Representative::quadric;  ///< used by `cluster`
  HalfEdgeCost cost = HalfEdgeCost::quadric;                ///< used by `half_edge`
  friend bool operator==(const SimplifyConfig&, const SimplifyConfig&) = default;
};

struct OutlineConfig {
  std::uint32_t sectors = 128;  ///< about so many
  double tolerance = 0.002;     ///< as a part of the bounding-box diagonal, above 0, at most 1
  friend bool operator==(const OutlineConfig&, const OutlineConfig&) = default;
};

/// The view that the model is shown with first, in degrees as a Standpoint: both or none, then the
/// build chooses.
struct FirstViewConfig {
  std::optional<double> azimuth, elevation;
  friend bool operator==(const FirstViewConfig&, const FirstViewConfig&) = default;

  std::optional<Standpoint> standpoint() const {
    return azimuth && elevation ? std::optional(Standpoint{*azimuth, *elevation}) : std::nullopt;
  }
};

using Compression = storage::Compression;
inline constexpr auto kCompressions = storage::kCompressions;

using Container = storage::Container;
inline constexpr std::array kContainers{NamedValue{"files", Container::files},
                                        NamedValue{"3tz", Container::archive}};

/// Normals that tiles are lit by.
enum class Normals {
  smooth,  ///< computed ones, smooth but for creases
  none,
  map,          ///< the same; simplified tiles a map of the original's normals besides
  map_or_none,  ///< a map where it pays
};
inline constexpr std::array kNormals{
    NamedValue{"smooth", Normals::smooth}, NamedValue{"none", Normals::none},
    NamedValue{"map", Normals::map}, NamedValue{"auto", Normals::map_or_none}};
constexpr bool makes_maps(Normals normals) {
  return normals == Normals::map || normals == Normals::map_or_none;
}

struct StorageConfig {
  Container container = Container::files;  ///< decides nothing of the files themselves
  Compression compression = Compression::none;
  std::optional<std::uint32_t> position_bits;  ///< bits of the lattice that positions are rounded
                                               ///< to, 8 to 24; not set: exact
  Normals normals = Normals::map_or_none;
  friend bool operator==(const StorageConfig&, const StorageConfig&) = default;
};

using ImageFormat = meshhier::ImageFormat;
inline constexpr auto kImageFormats = meshhier::kImageFormats;

/// Options of storage.normals map and auto.
struct NormalMapConfig {
  std::uint32_t texels = 896;  ///< side of a map, at most
  NormalMapFormat format;
  friend bool operator==(const NormalMapConfig&, const NormalMapConfig&) = default;
};

/// The pictures of a textured mesh.
struct TextureConfig {
  bool use = true;  ///< else textures are left out, and coordinates kept as attributes
  std::uint32_t texels =
      512;               ///< a simplified tile's picture has at most so many squared, 64 to 4096
  TextureFormat format;  ///< the tiles' pictures
  std::filesystem::path drape{};  ///< an orthophoto that lies on heights; empty: none
  friend bool operator==(const TextureConfig&, const TextureConfig&) = default;
};

/// The things that the mesh consists of.
struct ObjectsConfig {
  mesh_io::ObjectChoice from;  ///< what they are made from
  std::filesystem::path
      table{};           ///< of their properties, besides those that the mesh has; or empty
  bool in_tiles = true;  ///< tiles have tables of theirs, for other viewers
  friend bool operator==(const ObjectsConfig&, const ObjectsConfig&) = default;
};

/// The effect of a picture that cannot be decoded.
enum class MissingImages {
  warn,   ///< one that is not there is a warning, a broken one an error
  ignore  ///< both are warnings
};
inline constexpr std::array kMissingImages{NamedValue{"warn", MissingImages::warn},
                                           NamedValue{"ignore", MissingImages::ignore}};

inline constexpr std::array kUpAxes{NamedValue{name_of(UpAxis::y), UpAxis::y},
                                    NamedValue{name_of(UpAxis::z), UpAxis::z}};

/// The place of the model for viewers of the tileset: on the globe, or anywhere, or nowhere in
/// particular.
struct PlacementConfig {
  std::optional<double> longitude, latitude, height;  ///< degrees, degrees, metres
  /// Instead of these: the reference system, for PROJ, of the map that the z-up coordinates of the
  /// model belong to.
  std::optional<std::string> crs;
  std::optional<std::array<double, 3>> offset;  ///< from z-up coordinates to the map's; else 0
  std::filesystem::path metadata;               ///< the file that crs and offset are in, or empty
  /// The point that is there, in input coordinates; else 0. With a crs the point where the
  /// transform is exact; else the middle of the input.
  std::optional<std::array<double, 3>> anchor;
  std::optional<Transform> transform;  ///< instead of all these
  /// The file of the input that says that its coordinates belong to no map; else empty.
  std::filesystem::path unplaced_by;
  friend bool operator==(const PlacementConfig&, const PlacementConfig&) = default;
};

/// Options of the tileset, for viewers of 3D Tiles.
struct TilesetConfig {
  /// Its geometric errors are the tiles' errors times this. CesiumJS, 3d-tiles-renderer and iTowns
  /// allow for 16 pixels by default: then the error is one.
  double pixels = 16;
  friend bool operator==(const TilesetConfig&, const TilesetConfig&) = default;
};

inline constexpr std::array kTopologies{NamedValue{"place", Topology::place},
                                        NamedValue{"index", Topology::index}};

struct Config {
  mesh_io::InputPaths input;  ///< not empty
  /// Two corners: only triangles that touch the box between them are built.
  std::optional<std::array<double, 6>> crop;
  mesh_io::AttributeChoice attributes;  ///< those that are read besides those that are shown
  bool weld = false;                    ///< vertices of equal position and attributes become one
  Topology topology = Topology::place;  ///< decides which vertices are one point of the surface
  std::filesystem::path output;         ///< a directory or file, without a slash at its end
  /// Bytes, > 0; none: pipeline::memory_budget() chooses by the machine.
  std::optional<std::uint64_t> memory_budget;
  std::uint32_t threads = 0;  ///< 0: all
  PartitionConfig partition;
  SimplifyConfig simplify;
  OutlineConfig outline;
  bool preview = true;  ///< the hierarchy has a picture of the whole model
  FirstViewConfig first_view;
  ModelView view;  ///< how the model is shown first
  StorageConfig storage;
  TextureConfig texture;
  ObjectsConfig objects;
  NormalMapConfig normal_map;
  MissingImages missing_images = MissingImages::warn;
  /// The axis of the input that points up; none: z for a tileset, else y (with_input_frame()).
  std::optional<UpAxis> up;
  std::optional<Unit> units;  ///< the input's coordinates; none: as the format says, or unknown
  PlacementConfig placement;
  TilesetConfig tileset;
  std::string licence;  ///< the model's; for the tileset; may be empty
  std::optional<BoundsD> crop_box() const {
    if (!crop)
      return std::nullopt;
    const std::array<double, 6>& c = *crop;
    return BoundsD{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
  }
  UpAxis up_axis() const { return up.value_or(UpAxis::y); }
  /// The format of tiles' pictures. A normal map shows nothing without light: a mesh with pictures
  /// that is to have maps is lit.
  TextureFormat picture_format() const {
    TextureFormat format = texture.format;
    format.unlit = format.unlit && storage.normals != Normals::map;
    return format;
  }
  friend bool operator==(const Config&, const Config&) = default;
};

/// The origin of a config's text.
struct ConfigOrigin {
  std::string name;                 ///< for messages
  std::filesystem::path directory;  ///< relative paths of the text start here; may be empty
};

/// The words of a command line besides a config, or instead of one. Its paths are relative to the
/// current directory.
struct CommandLine {
  CommandLine() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): most say no more
  CommandLine(std::vector<std::string> what) : settings(std::move(what)) {}

  mesh_io::InputPaths meshes;         ///< the key `input`; may be empty
  std::filesystem::path output;       ///< the key `output`; may be empty
  std::vector<std::string> settings;  ///< "key=value", in order
};

/// Reads a config: JSON with // and /* */ comments, then the words of the command line on top.
///
/// A setting is "key=value", the key dotted ("partition.vertices"), the value JSON, or else a plain
/// string. One of partition.vertices or partition.count replaces whichever of the two the text has.
/// `output` also decides the container by its ending, ".3tz", unless a key does; without any
/// output, that of one mesh is beside it: scan.hier for scan.ply.gz.
///
/// Pure: looks at no file. Throws Error(usage) naming origin, key, what was expected, what was
/// found and the nearest known key.
Config parse_config(std::string_view text, const ConfigOrigin& origin, const CommandLine& words);

/// Reads a config from a whole file, as parse_config() does; its paths are relative to the file's
/// directory. Throws also Error(io).
Config load_config(storage::FileSystem& files, const std::filesystem::path& file,
                   const CommandLine& words);

/// Does the same, but for what only the meshes that it names tell: these are not looked at.
Config read_config(storage::FileSystem& files, const std::filesystem::path& file,
                   const CommandLine& words);

/// Returns all files that a build of that config reads.
std::vector<std::filesystem::path> read_by(const Config& config);

/// Returns all that decides the result: weld, topology, partition, simplify, outline, storage,
/// texture; not paths, budget, threads, container. All defaults are filled in, except that
/// simplify.vertices is absent if it follows partition.count.
nlohmann::ordered_json resolved_json(const Config& config);

/// Returns a text of the whole config, for another process in whatever directory: parse_config()
/// makes the same config of it, its paths absolute as seen from `directory`. Throws Error(usage) if
/// a path or text is not UTF-8.
std::string complete_text(const Config& config, const std::filesystem::path& directory);

}  // namespace meshhier::config
