// Objects that features of a glTF are: rows of a property table, or of a b3dm's batch table.
//
// Problem. A number of a feature says nothing beyond its table: feature 3 of one tile is another
// thing than feature 3 of the next. But one building may stand in several tiles.
//
// Idea. A column that is an id ("gml:id", "guid", the semantic ID) says what is the same thing, in
// all files; a column "name" says how it is called. Without either, a thing is its file's:
//
//     row   gml:id   name          object                      known by
//     0     DE_17    Town hall     "Town hall"                 DE_17
//     1     DE_18                  "DE_18"                     DE_18
//     2                            "tile.b3dm/feature 2"       its name
#pragma once

#include "import/object_names.h"
#include "mesh_io/feature_table.h"
#include "mesh_io/gltf_metadata.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

/// Returns the attribute that says rows of a batch table; null: there is none.
const char* batch_ids_in(const mesh_io::GltfAttributes& attributes);

/// Features of one file. For one thread.
class GltfFeatures {
 public:
  /// `batch`: the table of the b3dm that the file is in; null: it is in none, or that has none.
  /// `prefix`: before names that only number features: "tile.b3dm/"; may be empty. All must outlive
  /// it.
  GltfFeatures(mesh_io::GltfFile& file, MeshObjects& objects, mesh_io::FeatureTable* batch,
               std::string prefix);

  /// Returns the ids that say the features of a primitive, or of copies of a mesh: those of the
  /// first set with a table, else of the first set; none if it has none that can be read.
  /// `attributes`: those that it has.
  std::optional<mesh_io::GltfFeatureIds> ids_of(
      const std::shared_ptr<const nlohmann::json>& extension,
      const mesh_io::GltfAttributes& attributes) const;
  /// Returns the number of a feature's object.
  std::uint32_t object_of(const mesh_io::GltfFeatureIds& ids, double feature);
  /// Returns how many tables are damaged, and nobody asked for them, and were not read for that.
  std::uint64_t unread_tables() const { return unread_tables_; }

 private:
  /// Objects of all rows of a table, one after the other.
  struct Rows {
    std::uint32_t first = 0;
    std::uint64_t count = 0;
  };
  /// The columns that name the rows of a table.
  struct NamingColumns {
    std::optional<std::size_t> id{}, name{};
  };

  template <class Read>
  Rows rows_if_sound(const Read& read);
  Rows add_rows(mesh_io::FeatureTable& table, const std::string& way);
  FoundObject named_row(mesh_io::FeatureTable& table, const NamingColumns& columns,
                        std::uint64_t row, const std::string& way) const;
  std::optional<std::size_t> column_that(mesh_io::FeatureTable& table, std::string_view meaning,
                                         std::span<const std::string_view> names) const;
  bool tells_apart(mesh_io::FeatureTable& table, std::size_t column) const;
  const Rows& rows_of(std::uint32_t table);
  const Rows& batch_rows();

  mesh_io::GltfFile& file_;
  MeshObjects& objects_;
  mesh_io::FeatureTable* batch_;
  std::string prefix_;
  std::map<std::uint32_t, Rows> tables_;
  std::optional<Rows> batched_;
  std::uint64_t unread_tables_ = 0;
};

}  // namespace meshhier::importing
