// Triangles of a mesh in spools whose vertices get other numbers.
#pragma once

#include "import/raw_mesh.h"
#include "partition/renumber.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::importing {

/// Calls take(triangle) for each, with entry i of `numbers` for corner i. In their order, but for
/// those that wait for a part of a table that exceeds room.sort_bytes.
template <class Take>
void renumber_triangles(const storage::RecordSpool<Triangle<std::uint32_t>>& triangles,
                        const storage::RecordSpool<std::uint32_t>& numbers, const ImportRoom& room,
                        const Take& take) {
  partition::Renumberer<std::uint32_t> renumberer(
      numbers, partition::plan_renumbering(numbers.size(), sizeof(std::uint32_t), room.sort_bytes),
      room.scratch);
  partition::Renumbered<std::uint32_t> renumbered;
  const auto hand_on = [&] {
    room.cancel.check();
    std::ranges::for_each(renumbered.finished, take);
    renumberer.keep(renumbered);
  };
  constexpr std::uint64_t kBlockTriangles = 16384;
  std::vector<Triangle<std::uint32_t>> block;
  for (std::uint64_t i = 0; i < triangles.size(); i += block.size()) {
    block.resize(std::min(kBlockTriangles, triangles.size() - i));
    triangles.read(i, block);
    renumberer.translate(std::span<const Triangle<std::uint32_t>>(block), renumbered);
    hand_on();
  }
  while (renumberer.next_round()) {
    for (std::uint64_t batch = 0; batch < renumberer.batches(); ++batch) {
      renumberer.translate_batch(batch, renumbered);
      hand_on();
    }
  }
}

}  // namespace meshhier::importing
