// Binary rows of one size, decoded block by block, by any number of threads at once.
//
// Blocks are cut at multiples of a power of two in the file, so that reading them all reads whole
// blocks of the file's checksum; a row belongs to the block that its first byte lies in:
//
//     file      |  unit 0          |  unit 1          |  unit 2
//     rows      header[r0][r1][r2][r3][r4][r5][r6][r7][r8][r9]...
//     blocks          |0              |1              |2
//
// So any thread finds the rows of any block by arithmetic alone; reading one takes a row's end from
// the next unit.
#pragma once

#include "mesh_io/byte_window.h"
#include "mesh_io/mesh_blocks.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_plan.h"
#include "mesh_io/ply_values.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::mesh_io {

/// The places of the blocks of a run of rows in a file.
class RowBlocks {
 public:
  /// `rows` rows of `stride` bytes from `offset` on. Requires 3 <= stride <= 2^18.
  RowBlocks(std::uint64_t offset, std::uint64_t stride, std::uint64_t rows);

  std::uint64_t count() const { return count_; }
  std::uint64_t stride() const { return stride_; }
  std::uint64_t offset_of(std::uint64_t row) const { return offset_ + row * stride_; }

  struct Block {
    std::uint64_t first = 0;  ///< row
    std::size_t rows = 0;     ///< 1 to MeshSource::kBlockSize
  };
  Block operator[](std::uint64_t block) const;

  /// Reads a block, with the bytes around it that belong to its part of the file; returns its first
  /// row. If the file ends within the block, `block.rows` becomes the number of whole rows.
  const std::byte* read(const InputFile& input, std::uint64_t index, Block& block,
                        std::vector<std::byte>& bytes) const;

 private:
  /// Returns the first row that begins at `offset` or behind; at most rows_.
  std::uint64_t first_row_from(std::uint64_t offset) const;

  std::uint64_t offset_, stride_, rows_;
  std::uint64_t unit_ = 0;   ///< bytes of the file for a block
  std::uint64_t start_ = 0;  ///< multiple of unit_: where block 0 begins
  std::uint64_t count_ = 0;
};

/// Vertices without lists. Refers to its arguments.
class PlyVertexBlocks {
 public:
  /// `offset`: the first row's in the file.
  PlyVertexBlocks(const PlyPlan& plan, const MeshDescription& mesh, std::uint64_t offset);

  std::uint64_t count() const { return blocks_.count(); }
  /// Reads a block. Thread-safe for different `memory`. Throws Error(input) for the block's first
  /// defect.
  VertexBlock read(const InputFile& input, std::uint64_t index, BlockMemory& memory) const;
  /// Returns any rows, unchecked. Throws Error(input) if the file ends before, Error(io).
  VertexBlock rows(const InputFile& input, std::uint64_t first, std::size_t count,
                   BlockMemory& memory) const;

 private:
  struct Field {
    int slot = 0;
    PlyType type{};
    std::size_t offset = 0;  ///< in bytes within the row
  };
  std::uint64_t decode(const std::byte* rows, std::size_t count, VertexRows& to) const;
  bool has_plain_positions() const;
  [[noreturn]] void fail_truncated(const InputFile& input, std::uint64_t row) const;

  const PlyPlan& plan_;
  const MeshDescription& mesh_;
  std::vector<Field> fields_;
  bool swapped_;
  std::size_t first_gathered_ = 0;  ///< fields before are taken as plain positions
  RowBlocks blocks_;
};

/// Faces, read as if all were triangles of TriangleRows. Refers to its arguments.
class PlyTriangleBlocks {
 public:
  PlyTriangleBlocks(const PlyPlan& plan, const PlyElementPlan& faces, const TriangleRows& rows,
                    std::uint64_t offset);

  std::uint64_t count() const { return blocks_.count(); }
  std::uint64_t offset_of(std::uint64_t row) const { return blocks_.offset_of(row); }
  /// Reads a block. Thread-safe for different `memory`. The first row that is no triangle ends the
  /// block; its errors are told by a reader of rows.
  TriangleBlock read(const InputFile& input, std::uint64_t index, BlockMemory& memory) const;

 private:
  TriangleRows rows_;
  bool swapped_;
  RowBlocks blocks_;
};

}  // namespace meshhier::mesh_io
