// The objects that a GLB shows: one table of them, and a row of it for each vertex
// (EXT_mesh_features, EXT_structural_metadata; docs/file_format.md, section 4.13, which says what
// tiles have).
//
// Problem. The table stands in front of nobody: the JSON tells its size, and it may be larger than
// memory.
// Idea. The first pass over the parts notes which objects are there. Then rows are made some at a
// time, as tiles' are, and their columns wait in scratch.
#pragma once

#include "export/byte_stream.h"
#include "export/export_parts.h"
#include "hierarchy/object_set.h"
#include "hierarchy/value_channels.h"
#include "storage/format/object_table.h"
#include "storage/format/tile_object_table.h"
#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::exporting {

/// For one thread. Memory: a bit and a half an object, and the spools.
class GlbObjects {
 public:
  /// Requires that the hierarchy has objects.
  explicit GlbObjects(const PartsJob& job);

  /// Notes the objects of a part, and returns how many there are.
  std::uint32_t add(const CutPart& part);
  /// Makes the table of all that was added; the rest needs it.
  void make_table();

  std::uint32_t rows() const { return shown_.size(); }
  /// Returns the row of a vertex.
  std::uint32_t row_of(std::span<const float> attributes) const {
    return shown_.place_of(object_of(attributes));
  }
  const storage::ObjectColumns& columns() const { return *columns_; }
  /// Returns the content of the root's extension. `first_view`: of the first column.
  nlohmann::ordered_json metadata(std::size_t first_view) const;
  /// Writes columns().bytes.
  void write(ByteStream& to) const;

 private:
  struct Column {
    explicit Column(storage::ScratchFile& scratch);
    storage::RecordSpool<std::byte> values;
    storage::RecordSpool<std::uint32_t> starts;  ///< of texts
  };

  std::uint32_t object_of(std::span<const float> attributes) const;
  void add_rows(const std::vector<std::uint32_t>& objects);

  const PartsJob& job_;
  PlacedValue place_;
  std::unique_ptr<storage::ObjectTable> table_;
  ObjectSet shown_;
  storage::MemoryPool pool_;
  storage::ScratchFile scratch_;
  std::vector<std::unique_ptr<Column>> made_;
  std::optional<storage::ObjectColumns> columns_;
};

}  // namespace meshhier::exporting
