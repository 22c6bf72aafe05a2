// Texts whose blocks are parsed in parallel.
#pragma once

#include "execution/parallel.h"
#include "import/raw_mesh.h"
#include "mesh_io/block_runner.h"
#include "mesh_io/line_blocks.h"

#include <cstddef>
#include <cstdint>

namespace meshhier::importing {

/// Runs the blocks of a text on all threads. `cancel` must outlive it.
inline mesh_io::BlockRunner parallel_blocks(std::size_t in_flight,
                                            const execution::CancelToken& cancel) {
  return {in_flight, [in_flight, &cancel](const mesh_io::BlockSteps& steps) {
            execution::ordered_steps(in_flight, cancel, {steps.read, steps.work, steps.take});
          }};
}

/// Does the same for an import, while no sort runs. `block_bytes`: memory of a block at work.
inline mesh_io::BlockRunner parallel_blocks(std::uint64_t block_bytes, const ImportRoom& room) {
  return parallel_blocks(execution::useful_blocks(2 * room.sort_bytes, block_bytes), room.cancel);
}

/// Hands the blocks of a text to `reader` in their order, each after parse(block), and the rest to
/// be read by words; returns what its finish() does. `block_bytes`: memory of a block at work. No
/// sort may run meanwhile.
template <class Block, class Reader>
auto read_text_blocks(mesh_io::LineBlocks lines, std::uint64_t block_bytes, void (*parse)(Block&),
                      Reader& reader, const ImportRoom& room) {
  execution::ordered_read_blocks<Block>(
      execution::useful_blocks(2 * room.sort_bytes, block_bytes), room.cancel,
      [&](Block& block) { return lines.next(block.text); }, parse,
      [&](const Block& block) { reader.take(block); });
  reader.take_rest(lines.rest());
  return reader.finish();
}

}  // namespace meshhier::importing
