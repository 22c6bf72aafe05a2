// hierarchy.json: what the hierarchy was made from, how, and what is in it (docs/file_format.md).
#pragma once

#include "hierarchy/frame.h"
#include "hierarchy/outline.h"
#include "hierarchy/published.h"
#include "hierarchy/standpoint.h"
#include "hierarchy/vec.h"
#include "storage/format/tile_glb.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

inline constexpr int kFormatVersion = 12;
/// Without Manifest::tileset_pixels, of pictures or normal maps in KTX2.
inline constexpr int kTrueErrorsFormatVersion = 11;
/// The same without pictures or normal maps in KTX2, of tiles with normal maps.
inline constexpr int kNoKtx2FormatVersion = 10;
/// The same without normal maps, of tiles with values.
inline constexpr int kNoMapsFormatVersion = 9;
/// The same with tiles that have no values either.
inline constexpr int kNoValuesFormatVersion = 8;
/// The one before: with tiles that hold colours as screens have them.
inline constexpr int kScreenColoursFormatVersion = 7;
/// The oldest that is read: that without a first view.
inline constexpr int kOldestFormatVersion = 6;

/// Of Manifest::tileset_pixels.
inline constexpr double kFewestTilesetPixels = 1, kMostTilesetPixels = 1000;

/// What rounding to a lattice did.
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

struct Manifest {
  std::string generator;  ///< "meshhier 0.1.0"
  SourceSummary source;
  Vec3d origin;               ///< add to every stored position
  UpAxis up = UpAxis::y;      ///< of the input
  std::optional<Unit> units;  ///< of the input's coordinates, if they are known
  /// From where the model is looked at first; none: of format version 6, with screen_colours.
  std::optional<Standpoint> first_view;
  /// Of the tileset's root, for instance on the globe; from z-up coordinates, as 3D Tiles has them.
  std::optional<Transform> transform;
  std::string licence;  ///< may be empty
  std::uint32_t partition_count = 0;
  Compression compression = Compression::none;
  std::optional<Quantization> quantization;  ///< none: positions are exact
  bool computed_normals = false;  ///< tiles have normals that the build computed; the source none
  std::optional<TextureFormat> textures;  ///< of tiles' pictures; if and only if the source has any
  bool screen_colours = false;            ///< as TileFormat's; of format versions up to 7
  std::optional<NormalMapFormat> normal_maps{};  ///< some tiles have one
  /// The tileset's geometric errors are the tiles' errors times this, at least 1. None: of format
  /// versions up to 11, whose nodes hold the origin; later it is in the tileset's root.
  std::optional<double> tileset_pixels{};
  /// An object: the resolved config, what decides the result (not budget, threads, paths).
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
  std::uint64_t tileset_bytes = 0;     ///< of all of them
  std::uint64_t tileset_checksum = 0;  ///< XXH3-64 of all, one after another, tileset.json first
  std::uint64_t total_bytes = 0;       ///< of all files but this one

  /// Of the tileset's root: its coordinates become metres, those of the nodes (tile_frame()) the
  /// input's. None: they are, or are not known.
  std::optional<Transform> root_transform() const;

  /// Of the nodes of tiles and of the outline.
  Frame tile_frame() const { return {tileset_pixels ? Vec3d{} : origin, up}; }

  /// Of pictures or normal maps: there are never both.
  std::optional<ImageFormat> image_format() const {
    return textures      ? std::optional(textures->format)
           : normal_maps ? std::optional(normal_maps->format)
                         : std::nullopt;
  }
  bool has_ktx2() const { return image_format() == ImageFormat::ktx2; }

  int format_version() const {
    return tileset_pixels                      ? kFormatVersion
           : has_ktx2()                        ? kTrueErrorsFormatVersion
           : normal_maps                       ? kNoKtx2FormatVersion
           : !source.attributes.values.empty() ? kNoMapsFormatVersion
           : !screen_colours                   ? kNoValuesFormatVersion
           : first_view                        ? kScreenColoursFormatVersion
                                               : kOldestFormatVersion;
  }
};

/// What the manifest says of the input, on its own. File names keep their bytes, UTF-8 or not.
nlohmann::ordered_json source_json(const SourceSummary& source);
/// The inverse. Throws Error(corrupt) that starts with `name`, and says which key is missing or
/// wrong.
SourceSummary parse_source(const nlohmann::ordered_json& source, const std::string& name);

/// Deterministic; ends with a checksum of the text. What is no UTF-8 in texts becomes U+FFFD.
/// Requires finite numbers.
std::string to_json_text(const Manifest& manifest);

/// The inverse of to_json_text, on text nobody vouches for. Throws Error(corrupt) that starts with
/// `name`, and says which key is missing or wrong, or that the text was changed; other format
/// versions are refused by their number, with what to do.
Manifest parse_manifest(const std::string& text, const std::string& name);

}  // namespace meshhier::storage
