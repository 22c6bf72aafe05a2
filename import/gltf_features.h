// Objects that features of a glTF are: rows of a property table, or of a b3dm's batch table.
#pragma once

#include "import/object_names.h"
#include "mesh_io/feature_table.h"
#include "mesh_io/gltf_metadata.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::importing {

/// Features of one file. For one thread.
class GltfFeatures {
 public:
  /// `batch`: the table of the b3dm that the file is in; null: it is in none, or that has none.
  /// `prefix`: before names that only number features: "tile.b3dm/"; may be empty. All must outlive
  /// it.
  GltfFeatures(mesh_io::GltfFile& file, MeshObjects& objects, mesh_io::FeatureTable* batch,
               std::string prefix);

  /// Returns the ids that say the features of a primitive: those of the first set with a table,
  /// else of the first set; none if it has none in an attribute.
  std::optional<mesh_io::GltfFeatureIds> ids_of(const mesh_io::GltfPrimitive& primitive);
  /// Returns the number of a feature's object.
  std::uint32_t object_of(const mesh_io::GltfFeatureIds& ids, double feature);
  /// Returns how many sets of ids are in textures, which are not read.
  std::uint64_t in_textures() const { return in_textures_; }
  /// Returns how many tables have their schema in another file, or are damaged and nobody asked for
  /// them, and were not read for that.
  std::uint64_t unread_tables() const { return unread_tables_; }

 private:
  /// Objects of all rows of a table, one after the other.
  struct Rows {
    std::uint32_t first = 0;
    std::uint64_t count = 0;
  };

  template <class Read>
  Rows rows_if_sound(const Read& read);
  Rows add_rows(mesh_io::FeatureTable& table, const std::string& way);
  std::optional<std::size_t> naming_column(mesh_io::FeatureTable& table) const;
  bool are_different(mesh_io::FeatureTable& table, std::size_t column) const;
  const Rows& rows_of(std::uint32_t table);
  const Rows& batch_rows();

  mesh_io::GltfFile& file_;
  MeshObjects& objects_;
  mesh_io::FeatureTable* batch_;
  std::string prefix_;
  std::map<std::uint32_t, Rows> tables_;
  std::optional<Rows> batched_;
  std::uint64_t in_textures_ = 0, unread_tables_ = 0;
};

}  // namespace meshhier::importing
