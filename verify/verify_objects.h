// Checks the objects of a hierarchy: the table, and what tiles say of them.
#pragma once

#include "hierarchy/published.h"
#include "partition/object_census.h"
#include "storage/format/object_table.h"
#include "verify/verify_parts.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace meshhier::verifying {

/// Looks at all tiles, then at the table. For one thread.
class ObjectCheck {
 public:
  /// `memory_bytes`: for a sort.
  ObjectCheck(const VerifyJob& job, std::uint64_t memory_bytes);

  /// Checks that triangles have one object each, which the table has, and that the tile's own table
  /// tells of its objects what the hierarchy's does.
  void add(const PublishedTile& tile);
  /// Compares the table with the triangles of all partitions, and the manifest with all tiles.
  void finish();

 private:
  void check_rows();
  void check_sum() const;

  const VerifyJob& job_;
  std::unique_ptr<const storage::ObjectTable> table_;  ///< null if it cannot be read
  partition::ObjectCensus census_;
};

/// Compares names and properties of the hierarchy's objects with those of a table that an import of
/// the input has made; tells of the first difference.
void compare_objects(const VerifyJob& job, const std::filesystem::path& imported,
                     const std::function<void(const std::string&)>& tell);

}  // namespace meshhier::verifying
