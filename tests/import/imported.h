// An imported mesh, read back as a build reads it.
#pragma once

#include "hierarchy/object_row.h"
#include "hierarchy/published.h"
#include "images/material_list.h"
#include "import/mesh_input.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::tests {

struct Imported {
  AttributeLayout layout;
  images::MaterialList materials;
  SourceSummary summary;
  importing::InputRecord record;
  std::vector<std::string> warnings;
  std::uint64_t disk_bytes = 0;            ///< temporary, at most at once
  std::uint64_t predicted_bytes = 0;       ///< as importing::predict_import
  std::vector<ObjectProperty> properties;  ///< of the objects
  std::vector<ObjectRow> objects;
  std::vector<Vec3d> positions;
  std::vector<float> attributes;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Returns a count of the summary; 0 if it is not there.
  std::uint64_t count(const std::string& name) const;
  /// Returns the files that belong to the meshes: "w/a.png", and "no w/b.png" for a missing one.
  std::vector<std::string> companions() const;
  /// Returns the object of each triangle, whose corners must all have it.
  std::vector<std::uint32_t> objects_of_triangles() const;
  /// Returns the name of each triangle's object.
  std::vector<std::string> names_of_triangles() const;
  /// Returns the names of all objects.
  std::vector<std::string> object_names() const;
  /// The number of a triangle's material, which all of its corners must name.
  std::uint32_t material_of(std::size_t triangle) const;
  /// Number `attribute` of layout.values, of all vertices.
  std::vector<double> values(std::size_t attribute) const;
  /// As SourceSummary::values, but for names.
  std::vector<ValueStatistics> statistics() const;
  /// Texture coordinates of a corner.
  Vec2f texcoord(std::size_t triangle, std::size_t corner) const;
  /// "a.png 0 1, 0.5 1, 1 0" or "#ff0000" of what it shows; "0 1, ..." if nothing is textured.
  std::string shown(std::size_t triangle) const;
  /// Returns the pictures of all triangles.
  std::vector<std::string> all_shown() const;
};

inline constexpr importing::ImportMemory kRoomy{64 << 20, 64 << 20};
/// All is spooled and merged in many runs.
inline constexpr importing::ImportMemory kTight{0, 1};

struct ImportHow {
  bool weld = false;
  importing::Textures textures = importing::Textures::use;
  importing::ImportMemory memory = kRoomy;
  std::filesystem::path folder = "w";  ///< for temporary files
  std::optional<BoundsD> crop{};
  mesh_io::AttributeChoice attributes{};
  mesh_io::ObjectChoice objects{mesh_io::ObjectSource::none};
  std::filesystem::path object_table{};
};

/// Throws as importing::MeshInput.
Imported import_files(storage::FileSystem& files, const mesh_io::InputPaths& inputs,
                      const ImportHow& how = {});

}  // namespace meshhier::tests
