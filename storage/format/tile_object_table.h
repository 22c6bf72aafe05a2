// The table of objects in a tile, as other viewers read it (docs/file_format.md, section 4.13):
// EXT_mesh_features gives each vertex a row, EXT_structural_metadata says what is in it.
//
// Problem. A viewer that knows glTF alone is to show the name and properties of what was clicked.
// objects.bin is none of its business, and numbers of objects are no rows of a small table.
//
// Idea. Each tile has a table of the objects that are in it, ascending; a vertex has its row:
//
//      vertices   0   1   2   3   4        row   object   name      height
//      object     7   7  12  90  90         0       7     "barn"      4.5
//      row        0   0   1   2   2         1      12     "house"    11
//                                           2      90     "tower"     -
//
// A column lies at a multiple of 8, as the extension asks, one behind another:
//
//      object | name: texts, where they begin | height: f64 | ...
//
// Bounds. Texts are cut at kMostTileTextBytes; a tile has as many columns, in their order, as fit
// kMostTileTableBytes and kMostColumnNameBytes. All of it stands in objects.bin.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/object_row.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/tile_objects.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

class ObjectTable;

inline constexpr const char* kFeaturesExtension = "EXT_mesh_features";
inline constexpr const char* kFeatureAttribute = "_FEATURE_ID_0";

inline constexpr std::size_t kMostTileTextBytes = 255;
inline constexpr std::uint64_t kMostTileTableBytes = std::uint64_t{4} << 20;
/// The names of all properties together take at most so many bytes: the JSON has each twice.
inline constexpr std::size_t kMostColumnNameBytes = 4096;
/// A table has a column for the object, one for its name, and one for each property.
inline constexpr std::size_t kMostColumns = 2 + kMostObjectProperties;

/// A column, and where it lies in the table.
struct ObjectColumn {
  enum class Kind : std::uint8_t { object, number, boolean, text };
  std::string id;    ///< in the schema
  std::string name;  ///< for people
  Kind kind{};
  std::uint64_t values = 0, value_bytes = 0;
  std::uint64_t starts = 0, start_bytes = 0;  ///< of texts: u32s, one more than rows
};

/// The numbers from which the place of everything in a table follows.
struct ObjectTableShape {
  std::vector<ObjectProperty> properties;  ///< the hierarchy's
  std::uint64_t rows = 0;
  std::uint32_t columns = 0;
  std::vector<std::uint64_t> text_bytes;  ///< of each of them that has texts
};

struct ObjectColumns {
  std::vector<ObjectColumn> columns;
  std::uint64_t rows = 0;
  std::uint64_t bytes = 0;  ///< a multiple of 8

  explicit ObjectColumns(const ObjectTableShape& shape);
};

/// Returns how many of the first columns have texts.
std::size_t text_columns(std::span<const ObjectProperty> properties, std::size_t count);

/// Returns the objects of a tile's vertices, copies included, ascending. Requires that the layout
/// has an object. O(n log n).
std::vector<std::uint32_t> objects_of(const TileMesh& mesh, const AttributeLayout& layout);

/// Returns what a table of a tile has of an object: its name, then the values of its properties,
/// each of the length that its kind has, texts behind a byte with theirs; 16,640 bytes at most.
using CellsOf = std::function<std::span<const std::byte>(std::uint32_t object)>;
/// Returns one that reads them from `table`, which must outlive it. They last until its next call.
CellsOf cell_reader(const ObjectTable& table);

/// Makes the table of a tile, which has one object or more.
class TileTableMaker {
 public:
  explicit TileTableMaker(std::span<const ObjectProperty> properties);

  /// Adds an object, greater than the one before. `cells`: as CellsOf has them.
  void add(std::uint32_t object, std::span<const std::byte> cells);
  TileObjects take();

 private:
  using Bytes = std::vector<std::byte>;
  struct Column {
    ObjectColumn::Kind kind{};
    Bytes values, starts;
  };
  std::uint64_t bytes() const;

  std::vector<std::uint32_t> objects_;
  std::vector<Column> columns_;  ///< the last ones go when the table becomes too large
};

/// Returns the table of these objects. `row`: of an object.
TileObjects make_tile_objects(std::span<const std::uint32_t> objects,
                              std::span<const ObjectProperty> properties,
                              const std::function<ObjectRow(std::uint32_t object)>& row);

/// Reads the objects of a table that nobody vouches for, which has the bytes that its columns say,
/// and checks the texts' places. Throws Error(corrupt) that starts with `name`.
std::vector<std::uint32_t> read_objects(std::span<const std::byte> table,
                                        const ObjectColumns& columns, const std::string& name);

/// Returns the class of the schema.
nlohmann::ordered_json object_class(const ObjectColumns& columns);
/// Returns the property table. `first_view`: the number of the buffer view of the first column;
/// others follow, those of places of texts behind those of the texts.
nlohmann::ordered_json object_table_json(const ObjectColumns& columns, std::size_t first_view);

}  // namespace meshhier::storage
