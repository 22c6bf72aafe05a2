// Values that vertices refer to, brought into the vertices' order.
#pragma once

#include "execution/spool_cursor.h"
#include "import/split_corners.h"
#include "partition/external_sort.h"

#include <cstdint>
#include <span>

namespace meshhier::importing {

/// A value of the vertex, or the target, with that number.
template <class Value>
struct Placed {
  std::uint32_t place;
  Value value;
};
struct PlaceOf {
  template <class Value>
  std::uint32_t operator()(const Placed<Value>& placed) const {
    return placed.place;
  }
};

/// Gathers the values that vertices refer to, from 1 on, in the vertices' order; vertices without a
/// reference (0) get Value{}. Requires fewer than 2^32 references, each no larger than the number
/// of values, an empty `gathered`, and a Value without padding. Two sorts, however the references
/// jump.
template <class Value>
void gather(const References& references, const storage::RecordSpool<Value>& values,
            storage::RecordSpool<Value>& gathered, const ImportRoom& room) {
  partition::ExternalSort<Placed<Value>, PlaceOf> by_place(room.scratch, room.sort_bytes);
  {
    partition::ExternalSort<Placed<std::uint32_t>, PlaceOf> by_target(room.scratch,
                                                                      room.sort_bytes);
    execution::SpoolCursor all(references, room.cancel);
    for (std::uint64_t i = 0; i < references.size(); ++i) {
      if (all.at(i) > 0)
        by_target.add({all.at(i) - 1, static_cast<std::uint32_t>(i)});
    }
    by_target.sort();
    execution::SpoolCursor targets(values, room.cancel);
    by_target.for_each_block([&](std::span<const Placed<std::uint32_t>> block) {
      for (const auto& [target, from] : block)
        by_place.add({from, targets.at(target)});
    });
  }
  by_place.sort();
  by_place.for_each_block([&](std::span<const Placed<Value>> block) {
    room.cancel.check();
    for (const Placed<Value>& placed : block) {
      while (gathered.size() < placed.place)
        gathered.append(Value{});
      gathered.append(placed.value);
    }
  });
  while (gathered.size() < references.size())
    gathered.append(Value{});
}

}  // namespace meshhier::importing
