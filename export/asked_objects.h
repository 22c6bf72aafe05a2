// The objects that options of commands ask for, and the tiles that may show them.
//
// Problem. A city of a million buildings has as many tiles; a street of it is in a few of them. A
// simplified tile's triangles may lie beyond the boxes that the table has of their objects.
//
// Idea. A triangle of a simplified tile was one of the partitions below it, with the same object.
// So boxes are compared with those of partitions, down the tree, and marks go up again:
//
//                 o             a tile may show an object if a partition below it may
//             x       o
//           x   x   x   o       o  the box of a partition meets that of an object
//
// Cost. The rows that names lead to, or all of the table for a condition, one at a time; a walk
// down the tree for each object. Memory: a bit an object, 50 bytes a tile.
#pragma once

#include "base/bounds.h"
#include "execution/cancel.h"
#include "hierarchy/published.h"
#include "hierarchy/value_channels.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/object_table.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::exporting {

struct ObjectRequest {
  std::vector<std::string> names{};  ///< one that ends in "/" stands for all that begin with it
  std::string where{};               ///< as ObjectCondition reads it; empty: all of these names
  std::string prefix{};              ///< without names: those whose names begin so
  std::optional<std::vector<std::uint32_t>> numbers{};  ///< instead of names: these, ascending

  bool is_any() const { return !names.empty() || !where.empty() || numbers; }
};

/// Calls visit(object, row) for each object that is asked for, ascending; all if none is. Throws
/// Error(usage) if there is none of a name, or `where` is no condition; Error(interrupted), and as
/// `table`.
void for_each_asked(const storage::ObjectTable& table, const ObjectRequest& request,
                    const execution::CancelToken& cancel,
                    const std::function<void(std::uint32_t object, const ObjectRow& row)>& visit);

/// Thread-safe once constructed.
class AskedObjects {
 public:
  /// Throws Error(usage) if the hierarchy has no objects or none is asked for, Error(io | corrupt |
  /// interrupted), and as for_each_asked().
  AskedObjects(const storage::HierarchyReader& reader, const ObjectRequest& request,
               const execution::CancelToken& cancel);

  /// Returns whether a triangle with such a corner, or of this object, is asked for.
  bool has(std::span<const float> attributes) const { return has(place_.in(attributes.data())); }
  bool has(double object) const {
    return object >= 0 && object < static_cast<double>(asked_.size()) &&
           asked_[static_cast<std::size_t>(object)];
  }
  /// Returns false only if the node's tile shows no triangle of these objects.
  bool may_show(NodeId node) const;
  /// Returns the box of their triangles in the input, relative to the origin.
  const BoundsD& box() const { return box_; }

 private:
  enum class Mark : std::uint8_t { none, some, all };

  std::vector<BoundsD> boxes_below(const storage::HierarchyReader& reader) const;
  void mark(NodeId node, const BoundsD& box, const std::vector<BoundsD>& boxes);

  Tree tree_;
  PlacedValue place_{};
  std::vector<bool> asked_;
  std::vector<Mark> marks_;  ///< by level, then by index
  BoundsD box_;
};

/// Leaves the interior triangles of these objects in a tile, and of `border`, which of
/// tile.mesh.border are drawn, those that are theirs.
void keep_objects(const AskedObjects& asked, PublishedTile& tile,
                  std::vector<std::uint32_t>& border);

}  // namespace meshhier::exporting
