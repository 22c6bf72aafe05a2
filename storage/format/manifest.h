// hierarchy.json: what the hierarchy was made from, how, and what is in it (docs/file_format.md).
#pragma once

#include "base/vec.h"
#include "hierarchy/frame.h"
#include "hierarchy/model_view.h"
#include "hierarchy/outline.h"
#include "hierarchy/published.h"
#include "hierarchy/standpoint.h"
#include "storage/format/object_table.h"
#include "storage/format/tile_glb.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

// The versions that are read. Manifest::format_version() tells by the content which one a manifest
// has.
inline constexpr int kFormatVersion = 14;
/// No objects; tiles with both a picture and a normal map.
inline constexpr int kNoObjectsFormatVersion = 13;
/// No such tiles either.
inline constexpr int kNoReliefFormatVersion = 12;
/// No Manifest::tileset_pixels either; pictures or normal maps in KTX2.
inline constexpr int kTrueErrorsFormatVersion = 11;
/// No KTX2 either; tiles with normal maps.
inline constexpr int kNoKtx2FormatVersion = 10;
/// No normal maps either; tiles with values.
inline constexpr int kNoMapsFormatVersion = 9;
/// No values either.
inline constexpr int kNoValuesFormatVersion = 8;
/// Tiles hold colours as screens have them.
inline constexpr int kScreenColoursFormatVersion = 7;
/// No first view either; the oldest that is read.
inline constexpr int kOldestFormatVersion = 6;

/// The range of Manifest::tileset_pixels.
inline constexpr double kFewestTilesetPixels = 1, kMostTilesetPixels = 1000;

/// The lattice that positions were rounded to, and the effect.
struct Quantization {
  Lattice lattice;
  double worst_rounding =
      0;  ///< the largest distance that a position of any tile went, input units
};

/// The picture of the whole model, preview.webp.
struct Preview {
  std::uint32_t width = 0, height = 0;  ///< pixels, 1 to kMostPreviewSide each
  std::uint64_t bytes = 0;              ///< at most kMostPreviewBytes
  std::uint64_t checksum = 0;           ///< XXH3-64
  friend bool operator==(const Preview&, const Preview&) = default;
};
inline constexpr std::uint32_t kMostPreviewSide = 512;
/// A gallery of a hundred models is loaded in a few seconds.
inline constexpr std::uint64_t kMostPreviewBytes = 40000;

/// The objects that the mesh consists of.
struct ObjectsSummary {
  ObjectTableFacts table;
  std::vector<std::uint64_t> shown;  ///< of each level: objects of which its cut shows a triangle
  bool are_in_tiles = false;         ///< tiles have tables of theirs, for other viewers
  std::optional<ObjectTableFacts> words{};  ///< the table of their names' words, if there is one
  friend bool operator==(const ObjectsSummary&, const ObjectsSummary&) = default;
};

/// The facts of a hierarchy that all its tiles share.
struct Manifest {
  std::string generator;  ///< "meshhier 0.1.0"
  SourceSummary source;
  Vec3d origin;               ///< add to every stored position
  UpAxis up = UpAxis::y;      ///< the input's
  std::optional<Unit> units;  ///< unit of the input's coordinates, if it is known
  /// The view that the model is shown with first. None only in format version 6, with
  /// screen_colours.
  std::optional<Standpoint> first_view;
  ModelView view{};  ///< how it is shown first; empty: as the viewer does
  /// The transform of the tileset's root, for instance to the globe; from z-up coordinates, as 3D
  /// Tiles has them.
  std::optional<Transform> transform;
  std::string licence;  ///< may be empty
  std::uint32_t partition_count = 0;
  Compression compression = Compression::none;
  std::optional<Quantization> quantization;  ///< none: positions are exact
  /// Tiles have normals that the build computed, as the source has none.
  bool computed_normals = false;
  std::optional<TextureFormat> textures;  ///< tiles' pictures; if and only if the source has any
  bool screen_colours = false;            ///< as TileFormat's; only in format versions up to 7
  std::optional<NormalMapFormat> normal_maps{};  ///< some tiles have one
  std::optional<ObjectsSummary> objects{};       ///< if and only if a value of the source is one
  /// The tileset's geometric errors are the tiles' errors times this, at least 1. None in format
  /// versions up to 11, whose nodes hold the origin; later it is in the tileset's root.
  std::optional<double> tileset_pixels{};
  /// An object: the keys of the resolved config that decide the result (not budget, threads,
  /// paths).
  nlohmann::ordered_json config;
  std::uint64_t index_bytes = 0;
  std::uint64_t index_checksum = 0;  ///< XXH3-64 of tiles.bin
  std::uint64_t outline_bytes = 0;
  std::uint64_t outline_checksum = 0;  ///< XXH3-64 of outline.glb
  OutlineReport outline;
  std::optional<Preview> preview;  ///< none: the build was to make none, or is an older one's
  /// An array: the level table, for people and scripts; derived from tiles.bin.
  nlohmann::ordered_json levels;
  std::uint64_t tileset_files = 0;
  std::uint64_t tileset_bytes = 0;     ///< all of them together
  std::uint64_t tileset_checksum = 0;  ///< XXH3-64 of all, one after another, tileset.json first
  std::uint64_t total_bytes = 0;       ///< all files but this one

  /// Returns the transform of the tileset's root, from the coordinates of nodes (tile_frame()):
  /// `transform`, else the scale to metres, with the origin where nodes do not hold it. Nothing if
  /// that changes nothing, as with metres or an unknown unit at the origin 0.
  std::optional<Transform> root_transform() const;

  /// The frame of the nodes of tiles and of the outline.
  Frame tile_frame() const { return {tileset_pixels ? Vec3d{} : origin, up}; }

  bool has_images_in(ImageFormat format) const {
    return (textures && textures->format == format) ||
           (normal_maps && normal_maps->format == format);
  }
  bool has_ktx2() const { return has_images_in(ImageFormat::ktx2); }
  /// Whether simplified tiles have pictures and normal maps.
  bool has_relief() const { return textures && normal_maps; }

  int format_version() const {
    return objects                             ? kFormatVersion
           : has_relief()                      ? kNoObjectsFormatVersion
           : tileset_pixels                    ? kNoReliefFormatVersion
           : has_ktx2()                        ? kTrueErrorsFormatVersion
           : normal_maps                       ? kNoKtx2FormatVersion
           : !source.attributes.values.empty() ? kNoMapsFormatVersion
           : !screen_colours                   ? kNoValuesFormatVersion
           : first_view                        ? kScreenColoursFormatVersion
                                               : kOldestFormatVersion;
  }
};

/// Returns the manifest's object on the input. File names keep their bytes, UTF-8 or not.
nlohmann::ordered_json source_json(const SourceSummary& source);
/// Parses such an object. Throws Error(corrupt) that starts with `name`, and says which key is
/// missing or wrong.
SourceSummary parse_source(const nlohmann::ordered_json& source, const std::string& name);

/// Returns the file's text, which ends with a checksum of itself. Deterministic. Bytes in texts
/// that are no UTF-8 become U+FFFD. Requires finite numbers.
std::string to_json_text(const Manifest& manifest);

/// Parses a text that nobody vouches for. Throws Error(corrupt) that starts with `name`, and says
/// which key is missing or wrong, or that the text was changed; other format versions are refused
/// by their number, with what to do.
Manifest parse_manifest(const std::string& text, const std::string& name);

}  // namespace meshhier::storage
