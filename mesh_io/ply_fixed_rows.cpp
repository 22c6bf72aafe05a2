#include "mesh_io/ply_fixed_rows.h"

#include "mesh_io/input_error.h"
#include "mesh_io/ply_body.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// Bytes of the file for a block: large enough that a disk streams and that a block's bookkeeping
/// is nothing, small enough that its bytes and its rows stay in the L2 cache.
constexpr std::uint64_t kMostUnit = std::uint64_t{1} << 19;

template <class T, bool Swap, class Out>
void gather(const std::byte* from, std::size_t from_stride, VertexRows::Column to,
            std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    const auto value = static_cast<Out>(load<T, Swap>(from + i * from_stride));
    std::memcpy(to.data + i * to.stride, &value, sizeof(value));
  }
}

template <class T, bool Swap>
void gather_halves(const std::byte* from, std::size_t from_stride, VertexRows::Column to,
                   std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    VertexRows::put(to, static_cast<double>(load<T, Swap>(from + i * from_stride)));
    to.data += to.stride;
  }
}

/// One property of all rows.
template <bool Swap>
void gather_column(PlyType type, const std::byte* from, std::size_t from_stride,
                   VertexRows::Column to, std::size_t rows) {
  with_type(type, [&](auto zero) {
    using T = decltype(zero);
    switch (to.form) {
      case VertexRows::Column::Form::one_float:
        return gather<T, Swap, float>(from, from_stride, to, rows);
      case VertexRows::Column::Form::one_double:
        return gather<T, Swap, double>(from, from_stride, to, rows);
      case VertexRows::Column::Form::two_channels:
        return gather_halves<T, Swap>(from, from_stride, to, rows);
    }
  });
}

template <bool Swap>
std::uint64_t count_rounded(PlyType type, const std::byte* from, std::size_t stride,
                            std::size_t rows) {
  return with_type(type, [&](auto zero) {
    std::uint64_t rounded = 0;
    for (std::size_t i = 0; i < rows; ++i)
      rounded += is_rounded(load<decltype(zero), Swap>(from + i * stride)) ? 1 : 0;
    return rounded;
  });
}

}  // namespace

RowBlocks::RowBlocks(std::uint64_t offset, std::uint64_t stride, std::uint64_t rows)
    : offset_(offset), stride_(stride), rows_(rows), unit_(kMostUnit) {
  // A unit of the file may begin one more row than it holds whole.
  while (unit_ / stride_ + 1 > MeshSource::kBlockSize)
    unit_ /= 2;
  start_ = offset_ / unit_ * unit_;
  count_ = rows_ == 0 ? 0 : (offset_of(rows_ - 1) - start_) / unit_ + 1;
}

std::uint64_t RowBlocks::first_row_from(std::uint64_t offset) const {
  if (offset <= offset_)
    return 0;
  return std::min((offset - offset_ + stride_ - 1) / stride_, rows_);
}

RowBlocks::Block RowBlocks::operator[](std::uint64_t block) const {
  const std::uint64_t first = first_row_from(start_ + block * unit_);
  const std::uint64_t next = first_row_from(start_ + (block + 1) * unit_);
  return {first, static_cast<std::size_t>(next - first)};
}

const std::byte* RowBlocks::read(const InputFile& input, std::uint64_t index, Block& block,
                                 std::vector<std::byte>& bytes) const {
  const std::uint64_t begin = std::min(start_ + index * unit_, input.bytes);
  const std::uint64_t end = std::max(begin + unit_, offset_of(block.first + block.rows));
  bytes.resize(static_cast<std::size_t>(std::min(end, input.bytes) - begin));
  input.read(begin, bytes);
  const std::uint64_t skipped = offset_of(block.first) - begin;
  if (skipped >= bytes.size()) {
    block.rows = 0;
    return bytes.data() + bytes.size();
  }
  block.rows = std::min<std::size_t>(block.rows, (bytes.size() - skipped) / stride_);
  return bytes.data() + skipped;
}

PlyVertexBlocks::PlyVertexBlocks(const PlyPlan& plan, const MeshDescription& mesh,
                                 std::uint64_t offset)
    : plan_(plan),
      mesh_(mesh),
      swapped_(is_swapped(plan.encoding)),
      blocks_(offset, *plan.elements[plan.vertex_element].stride,
              plan.elements[plan.vertex_element].element.count) {
  const PlyElementPlan& vertices = plan.elements[plan.vertex_element];
  std::size_t at = 0;
  for (std::size_t i = 0; i < vertices.slots.size(); ++i) {
    const PlyType type = vertices.element.properties[i].type;
    if (vertices.slots[i] != kSkipped)
      fields_.push_back({vertices.slots[i], type, at});
    at += size_of(type);
  }
  std::sort(fields_.begin(), fields_.end(),
            [](const Field& a, const Field& b) { return a.slot < b.slot; });
  first_gathered_ = has_plain_positions() ? 3 : 0;
}

/// Returns whether x, y and z are three floats as they are kept.
bool PlyVertexBlocks::has_plain_positions() const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Field& field = fields_[axis];
    if (field.type != PlyType::f32 || field.offset != fields_[0].offset + axis * sizeof(float))
      return false;
  }
  return !swapped_ && !mesh_.wide_coordinates;
}

/// Returns how many numbers were rounded.
std::uint64_t PlyVertexBlocks::decode(const std::byte* rows, std::size_t count,
                                      VertexRows& to) const {
  const std::size_t stride = blocks_.stride();
  if (first_gathered_ == 3) {
    const VertexRows::Column column = to.column(0, 0);
    const std::byte* from = rows + fields_[0].offset;
    if (stride == sizeof(Vec3f)) {
      std::memcpy(column.data, from, count * sizeof(Vec3f));
    } else {
      for (std::size_t i = 0; i < count; ++i)
        std::memcpy(column.data + i * sizeof(Vec3f), from + i * stride, sizeof(Vec3f));
    }
  }
  std::uint64_t rounded = 0;
  for (const Field& field : std::span(fields_).subspan(first_gathered_)) {
    const VertexRows::Column column = to.column(0, field.slot);
    const std::byte* from = rows + field.offset;
    swapped_ ? gather_column<true>(field.type, from, stride, column, count)
             : gather_column<false>(field.type, from, stride, column, count);
    if (has_64_bits(field.type))
      rounded += swapped_ ? count_rounded<true>(field.type, from, stride, count)
                          : count_rounded<false>(field.type, from, stride, count);
  }
  return rounded;
}

void PlyVertexBlocks::fail_truncated(const InputFile& input, std::uint64_t row) const {
  const PlyElementPlan& vertices = plan_.elements[plan_.vertex_element];
  const std::uint64_t offset = std::min(blocks_.offset_of(row), input.bytes);
  fail_at_byte(input.file.path(), offset,
               fmt::format("expected {} bytes for {} in {}, found the end of the file after {} "
                           "(truncated)",
                           blocks_.stride(), in_quotes(vertices.element.properties[0].name),
                           row_name(vertices, row), input.bytes - offset));
}

VertexBlock PlyVertexBlocks::rows(const InputFile& input, std::uint64_t first, std::size_t count,
                                  BlockMemory& memory) const {
  if (const std::uint64_t begin = blocks_.offset_of(first);
      blocks_.offset_of(first + count) > input.bytes) {
    const std::uint64_t left = input.bytes - std::min(begin, input.bytes);
    fail_truncated(input, first + left / blocks_.stride());
  }
  memory.bytes.resize(count * static_cast<std::size_t>(blocks_.stride()));
  input.read(blocks_.offset_of(first), memory.bytes);
  VertexRows rows(mesh_, count, memory);
  decode(memory.bytes.data(), count, rows);
  return rows.block(first, count, {});
}

VertexBlock PlyVertexBlocks::read(const InputFile& input, std::uint64_t index,
                                  BlockMemory& memory) const {
  RowBlocks::Block block = blocks_[index];
  const std::size_t wanted = block.rows;
  const std::byte* bytes = blocks_.read(input, index, block, memory.bytes);
  if (block.rows == 0)
    fail_truncated(input, block.first);
  VertexRows rows(mesh_, block.rows, memory);
  const std::uint64_t rounded = decode(bytes, block.rows, rows);
  ZeroedCounts zeroed = rows.zero_what_is_not_finite(0, block.rows);
  zeroed.rounded = rounded;
  if (const auto bad = rows.find_defect(0, block.rows, plan_.checks)) {
    const auto field = std::find_if(fields_.begin(), fields_.end(),
                                    [&](const Field& f) { return f.slot == bad->slot; });
    const std::uint64_t row = block.first + bad->row;
    fail_for(*bad, [&] {
      fail_at_byte(input.file.path(), blocks_.offset_of(row) + field->offset,
                   defect_text(plan_.elements[plan_.vertex_element], row, bad->slot, bad->value));
    });
  }
  if (block.rows < wanted)
    fail_truncated(input, block.first + block.rows);
  return rows.block(block.first, block.rows, zeroed);
}

PlyTriangleBlocks::PlyTriangleBlocks(const PlyPlan& plan, const PlyElementPlan& faces,
                                     const TriangleRows& rows, std::uint64_t offset)
    : rows_(rows),
      swapped_(is_swapped(plan.encoding)),
      blocks_(offset, rows.stride, faces.element.count) {}

TriangleBlock PlyTriangleBlocks::read(const InputFile& input, std::uint64_t index,
                                      BlockMemory& memory) const {
  RowBlocks::Block block = blocks_[index];
  const std::size_t wanted = block.rows;
  const std::byte* bytes = blocks_.read(input, index, block, memory.bytes);
  memory.triangles.resize(block.rows);
  Triangle<VertexId>* out = memory.triangles.data();
  const auto take = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    *out = {VertexId{a}, VertexId{b}, VertexId{c}};
    // A degenerate triangle is overwritten by the next one: no branch to mispredict.
    out += static_cast<int>(a != b) & static_cast<int>(b != c) & static_cast<int>(c != a);
  };
  TriangleBlock result;
  if (block.rows == 0)
    return result;
  result.faces = swapped_ ? take_triangles<true>(rows_, bytes, block.rows, take)
                          : take_triangles<false>(rows_, bytes, block.rows, take);
  result.triangles =
      std::span(memory.triangles).first(static_cast<std::size_t>(out - memory.triangles.data()));
  result.whole = result.faces == wanted;
  return result;
}

}  // namespace meshhier::mesh_io
