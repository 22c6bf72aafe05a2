// The files that an input was made of: the meshes, and files that they are not whole without.
#pragma once

#include "hierarchy/published.h"
#include "mesh_io/odd_syntax.h"
#include "mesh_io/polygon_counts.h"
#include "mesh_io/zeroed.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

/// The part of a file in the input, in the order in which checksums are joined.
enum class InputPart : std::uint8_t { mesh, buffer, library, picture, tileset, tile, table };

/// A file that meshes are not whole without.
struct CompanionFile {
  std::filesystem::path path;
  InputPart part = InputPart::buffer;
  storage::FileIdentity identity;
};

/// The companions of an input, each once, in the order in which they were added.
class CompanionFiles {
 public:
  void add(CompanionFile file);
  /// Notes where a missing file would have been: one that appears at any of these places belongs to
  /// the input.
  void await(const std::vector<std::filesystem::path>& places);
  /// Adds all of another list, and awaits what it does.
  void add_all(const CompanionFiles& others);

  const std::vector<CompanionFile>& files() const { return files_; }
  bool has(const std::filesystem::path& file) const { return known_.contains(file); }
  const std::vector<std::filesystem::path>& awaited() const { return awaited_; }

 private:
  std::vector<CompanionFile> files_;
  std::vector<std::filesystem::path> awaited_;
  std::set<std::filesystem::path> known_, known_places_;
};

struct ReadFile {
  std::filesystem::path path;
  InputPart part = InputPart::mesh;
  storage::FileIdentity identity;  ///< before it was read
  std::uint64_t checksum = 0;      ///< storage::FileChecksum
};

struct InputRecord {
  std::vector<ReadFile> files;  ///< by part, meshes first
  std::vector<std::filesystem::path> awaited;
};

/// The most meshes that are listed one by one; if there are more, one fewer and an entry for all
/// behind these. The manifest has room for that, with names of any length.
inline constexpr std::size_t kMostListedMeshes = 50;

/// Returns SourceSummary's files: an entry for each of kMostListedMeshes, and one for all files of
/// each other part. `files`: by part, meshes first. `formats`: those of the meshes, for people.
std::vector<SourceFile> source_files(const std::vector<ReadFile>& files,
                                     const std::vector<std::string>& formats);

/// Names of SourceCounts follow. Colours of materials that vertices have.
inline constexpr std::string_view kMaterialColours = "material_colours";
/// Colours of vertices in a wider type whose numbers are all those of bytes.
inline constexpr std::string_view kColoursTakenForBytes = "colours_taken_for_bytes";
/// Vertices without a colour, where others have one.
inline constexpr std::string_view kMadeWhite = "vertices_made_white";
/// Faces without a colour, where others have one.
inline constexpr std::string_view kFacesMadeWhite = "faces_made_white";
/// Vertices that show no picture, and whose colour is not seen either, as others have both.
inline constexpr std::string_view kHiddenColours = "vertices_with_hidden_colours";
/// Materials that emit light of which nothing is shown.
inline constexpr std::string_view kIgnoredEmission = "ignored_emission";
/// Materials of colours that light shines through, in a mesh without pictures.
inline constexpr std::string_view kMadeOpaque = "materials_made_opaque";
/// Materials that are shaders with several pictures, of which none is known to be the colour.
inline constexpr std::string_view kIgnoredTechniques = "ignored_techniques";
/// Parts of a mesh whose materials let all light through: they are left out.
inline constexpr std::string_view kInvisibleParts = "invisible_parts";
/// Parts that are no triangles: they are left out.
inline constexpr std::string_view kPointsAndLines = "ignored_points_and_lines";
/// Sets of feature ids that textures have: they are not read.
inline constexpr std::string_view kFeaturesInTextures = "ignored_feature_textures";
/// Sets of feature ids beside the one that says the objects.
inline constexpr std::string_view kFurtherFeatures = "ignored_feature_ids";
/// Property tables that are damaged, or whose schema is not there: they are not read.
inline constexpr std::string_view kUnreadTables = "ignored_property_tables";
/// Properties that texels or vertices have, of EXT_structural_metadata.
inline constexpr std::string_view kPropertyTextures = "ignored_property_textures";
inline constexpr std::string_view kPropertyAttributes = "ignored_property_attributes";
/// Vertices of which a coordinate is not finite.
inline constexpr std::string_view kDroppedUnplaced = "dropped_unplaced_vertices";

/// Normals and texture coordinates that were no numbers.
inline constexpr std::string_view kZeroedNormals = "normals_made_zero";
inline constexpr std::string_view kZeroedTexcoords = "texcoords_made_zero";
/// Integers of 64 bits that were rounded to doubles.
inline constexpr std::string_view kRounded = "rounded_integers";

/// Adds to the count of that name, which is made if there is none; nothing if `count` is 0.
void add_count(std::vector<SourceCount>& counts, std::string_view name, std::uint64_t count);

/// Return the counts that are not 0, by name.
std::vector<SourceCount> source_counts(const mesh_io::ZeroedCounts& zeroed);
std::vector<SourceCount> source_counts(const mesh_io::OddSyntax& odd);
std::vector<SourceCount> source_counts(const mesh_io::PolygonCounts& polygons);

/// Returns whether the import looked for materials, as it does with Textures::use: there are
/// textures or colours of materials, or a library or a picture is among the files.
bool shows_materials(const SourceSummary& source);

/// Returns the checksum of several files from theirs; one file's is its own.
std::uint64_t joined_checksum(const std::vector<std::uint64_t>& checksums);
std::uint64_t joined_checksum(const std::vector<SourceFile>& files);

}  // namespace meshhier::importing
