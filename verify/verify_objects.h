// Checks the objects of a hierarchy: the table, and what tiles say of them.
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/published.h"
#include "partition/object_census.h"
#include "partition/rows_by_tile.h"
#include "storage/format/object_facts.h"
#include "storage/format/object_table.h"
#include "verify/verify_parts.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::verifying {

/// Looks at all tiles, then at the table. For one thread.
class ObjectCheck {
 public:
  /// `memory_bytes`: for sorts.
  ObjectCheck(const VerifyJob& job, std::uint64_t memory_bytes);

  /// Checks that triangles have one object each, which the table has.
  void add(const PublishedTile& tile);
  /// Checks that the tables of the tiles that were added say of their objects what the hierarchy's
  /// table does.
  void finish_tiles();
  /// Compares the table with the triangles of all partitions, and the manifest with all tiles.
  void finish();

 private:
  /// A tile with a table; its number is its place in the list.
  struct Told {
    NodeId node;
    std::uint64_t checksum;  ///< of the table
  };
  void tell(NodeId node, const std::string& what) const;
  void check_rows();
  void check_sum(const storage::ObjectFile& told) const;
  void check_words() const;

  const VerifyJob& job_;
  const std::uint64_t memory_bytes_;
  std::unique_ptr<const storage::ObjectTable> table_;  ///< null if it cannot be read
  partition::ObjectCensus census_;
  partition::RowsByTile rows_;
  std::vector<Told> told_;
};

/// Compares names and properties of the hierarchy's objects with those of a table that an import of
/// the input has made; tells of the first difference.
void compare_objects(const VerifyJob& job, const std::filesystem::path& imported,
                     const std::function<void(const std::string&)>& tell);

}  // namespace meshhier::verifying
