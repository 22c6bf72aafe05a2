// Gives vertices other numbers in the triangles of a mesh in spools.
#pragma once

#include "import/raw_mesh.h"
#include "partition/renumber.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::importing {

/// Hands triangles of ids on as triangles of a table's values: take(triangle) for each, in their
/// order, but for those that wait for a part of a table that exceeds room.sort_bytes.
template <class Value, class Take>
class TriangleTranslator {
 public:
  /// `take` and `room` must outlive it.
  TriangleTranslator(partition::RenumberTable<Value> table, const Take& take,
                     const ImportRoom& room)
      : renumberer_(table,
                    partition::plan_renumbering(table.entries, sizeof(Value), room.sort_bytes),
                    room.scratch),
        take_(take),
        room_(room) {}

  template <class Id>
  void add(std::span<const Triangle<Id>> triangles) {
    renumberer_.translate(triangles, renumbered_);
    hand_on();
  }
  void add(const storage::RecordSpool<Triangle<std::uint32_t>>& triangles) {
    constexpr std::uint64_t kBlockTriangles = 16384;
    std::vector<Triangle<std::uint32_t>> block;
    for (std::uint64_t i = 0; i < triangles.size(); i += block.size()) {
      block.resize(std::min(kBlockTriangles, triangles.size() - i));
      triangles.read(i, block);
      add(std::span<const Triangle<std::uint32_t>>(block));
    }
  }
  /// Hands on the triangles that wait.
  void finish() {
    while (renumberer_.next_round()) {
      for (std::uint64_t batch = 0; batch < renumberer_.batches(); ++batch) {
        renumberer_.translate_batch(batch, renumbered_);
        hand_on();
      }
    }
  }

 private:
  void hand_on() {
    room_.cancel.check();
    std::ranges::for_each(renumbered_.finished, take_);
    renumberer_.keep(renumbered_);
  }

  partition::Renumberer<Value> renumberer_;
  partition::Renumbered<Value> renumbered_;
  const Take& take_;
  const ImportRoom& room_;
};

/// Calls take(triangle) for each triangle with new numbers: vertex i becomes numbers[i].
template <class Take>
void renumber_triangles(const storage::RecordSpool<Triangle<std::uint32_t>>& triangles,
                        const storage::RecordSpool<std::uint32_t>& numbers, const ImportRoom& room,
                        const Take& take) {
  const auto read = [&](std::uint64_t first, std::span<std::uint32_t> values) {
    numbers.read(first, values);
  };
  TriangleTranslator<std::uint32_t, Take> translator({0, numbers.size(), read, false}, take, room);
  translator.add(triangles);
  translator.finish();
}

}  // namespace meshhier::importing
