// Objects as readers come upon them: their names and properties, and the triangles that are theirs.
//
// A reader gives each object a number, 0, 1, ..., and says whose the triangles are that it appends.
// Two numbers may have the same name: a name is looked up among those that came lately only, so
// that memory is bounded, and names are compared when all are sorted (object_table.h).
//
//     names    0 "roof"  1 "wall"  2 "roof"         entries, in a spool
//     runs     [1: 200 triangles] [0: 12] [2: 30]   in the triangles' order
#pragma once

#include "hierarchy/object_row.h"
#include "import/import_room.h"
#include "import/row_sort.h"
#include "mesh_io/object_choice.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::importing {

/// The names of properties that objects have, each once, by first use.
class PropertyNames {
 public:
  /// Returns the number of a property; none if there are kMostObjectProperties already, or if it
  /// cannot be the name of one.
  std::optional<std::uint8_t> number(std::string_view name);
  const std::vector<std::string>& all() const { return names_; }
  /// Notes a property that is not kept.
  void drop(std::string_view name);
  /// Returns how many had no number or were dropped; beyond 4096, how often.
  std::uint64_t dropped() const { return dropped_.size() + more_dropped_; }
  /// Returns what a warning says of them: `"colour", "" and 4 more`; empty: there are none.
  std::string dropped_names() const;
  /// Notes those that others have dropped.
  void drop_all(const PropertyNames& others);

 private:
  std::vector<std::string> names_;
  std::set<std::string> dropped_;  ///< their names, cut
  std::uint64_t more_dropped_ = 0;
};

/// Returns a name in UTF-8, as utf8_of_windows() makes it, without a zero, which ends keys of
/// sorts.
std::string sound_name(std::string_view name);

/// Values of an object, each with the number of its property.
using ObjectValues = std::vector<std::pair<std::uint8_t, ObjectValue>>;

/// Return values as bytes, and the values of such bytes.
std::string encode_values(const ObjectValues& values);
ObjectValues decode_values(std::string_view bytes);

/// An object as its reader found it.
struct FoundObject {
  std::string name;
  std::string id{};  ///< the text by which a table may know it; empty: its name
  ObjectValues values{};
};

/// Objects by number. For one thread.
class ObjectNames {
 public:
  explicit ObjectNames(storage::ScratchFile& scratch) : rows_(scratch) {}

  /// Returns the number of an object of that name. `id`: that of all of that name.
  std::uint32_t number(std::string_view name, std::string_view id = {});
  /// Adds an object, whose number is new. Names become UTF-8. Throws Error(input) if a name is too
  /// long, or if there are 2^32 numbers.
  std::uint32_t add(const FoundObject& object);
  /// Adds the objects of another list; returns the number of its first one.
  std::uint32_t append(const ObjectNames& others);

  std::uint32_t count() const { return static_cast<std::uint32_t>(rows_.rows()); }
  /// Returns whether an object has a name that is not empty; two have different ones.
  bool has_any() const { return !first_.empty(); }
  bool are_different() const { return are_different_; }

  /// Returns whether an object has an id that is not its name.
  bool have_ids() const { return have_ids_; }

  /// Calls `visit(number, object)` for all.
  template <class Visit>
  void for_each(const Visit& visit) const {
    RowCursor rows(rows_);
    for (std::uint32_t number = 0; rows.next(); ++number)
      visit(number, object_of(rows.row()));
  }

 private:
  static FoundObject object_of(const Row& row);
  void compare(std::string_view name);

  struct Known {
    std::string name;
    std::uint32_t number = UINT32_MAX;  ///< none
  };

  RowSpool rows_;
  std::vector<Known> known_;  ///< by a hash of the name, the last one of each; short names only
  std::string first_;         ///< a name that is not empty
  bool are_different_ = false, have_ids_ = false;
};

/// The objects of triangles that come one after the other.
class ObjectRuns {
 public:
  struct Run {
    std::uint32_t object, triangles;
  };

  explicit ObjectRuns(storage::ScratchFile& scratch) : runs_(scratch, kImportSpoolBytes) {}

  /// Says that the next triangles are an object's.
  void add(std::uint32_t object, std::uint64_t triangles);
  /// Adds the runs of another list, whose objects are numbered from `first` on.
  void append(const ObjectRuns& others, std::uint32_t first);
  /// Returns how many triangles there are.
  std::uint64_t triangles() const { return triangles_; }

  std::uint64_t count() const { return runs_.size() + (last_.triangles > 0 ? 1 : 0); }

 private:
  friend class RunCursor;
  storage::RecordSpool<Run> runs_;
  Run last_{};  ///< it may grow
  std::uint64_t triangles_ = 0;
};

/// Reads runs forwards. Nothing may be added meanwhile.
class RunCursor {
 public:
  explicit RunCursor(const ObjectRuns& runs) : runs_(runs) {}

  /// Goes on to the next run; false behind the last.
  bool next();
  const ObjectRuns::Run& run() const { return run_; }
  /// Returns the object of a triangle, which is there. Triangles ascend from call to call.
  std::uint32_t object_of(std::uint64_t triangle) {
    while (triangle >= end_)
      next();
    return run_.object;
  }

 private:
  const ObjectRuns& runs_;
  std::vector<ObjectRuns::Run> block_;
  std::uint64_t first_ = 0, next_ = 0;  ///< of the block; the next run
  std::uint64_t end_ = 0;               ///< of the run here, in triangles
  ObjectRuns::Run run_{};
};

/// The objects of a mesh.
struct MeshObjects {
  MeshObjects(storage::ScratchFile& scratch, mesh_io::ObjectChoice from)
      : choice(std::move(from)), names(scratch), runs(scratch) {}

  /// Says that the triangles up to `end`, which nobody has spoken of, are of no object.
  void fill(std::uint64_t end) {
    if (end > runs.triangles())
      runs.add(names.number(""), end - runs.triangles());
  }
  /// Adds those of a mesh whose triangles come behind. Both have properties of their own numbers.
  void append(const MeshObjects& others);

  mesh_io::ObjectChoice choice;
  PropertyNames properties;
  ObjectNames names;
  ObjectRuns runs;
};

}  // namespace meshhier::importing
