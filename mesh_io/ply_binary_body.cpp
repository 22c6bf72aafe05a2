#include "mesh_io/byte_window.h"
#include "mesh_io/input_error.h"
#include "mesh_io/ply_body.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Role = PlyElementPlan::Role;

/// The value at `bytes`; `Swap` if the file's byte order is not this machine's.
template <class T, bool Swap>
T load(const std::byte* bytes) {
  std::array<std::byte, sizeof(T)> raw_bytes;
  std::memcpy(raw_bytes.data(), bytes, sizeof(T));
  if constexpr (Swap)
    std::reverse(raw_bytes.begin(), raw_bytes.end());
  return std::bit_cast<T>(raw_bytes);
}

/// Calls visit(T{}) with the C++ type of `type`.
template <class Visit>
auto with_type(PlyType type, Visit visit) {
  switch (type) {
    case PlyType::i8:
      return visit(std::int8_t{});
    case PlyType::u8:
      return visit(std::uint8_t{});
    case PlyType::i16:
      return visit(std::int16_t{});
    case PlyType::u16:
      return visit(std::uint16_t{});
    case PlyType::i32:
      return visit(std::int32_t{});
    case PlyType::u32:
      return visit(std::uint32_t{});
    case PlyType::f32:
      return visit(float{});
    case PlyType::f64:
      break;
  }
  return visit(double{});
}

template <bool Swap>
class BinaryBody final : public PlyBody {
 public:
  BinaryBody(const storage::File& file, std::uint64_t file_bytes, const PlyPlan& plan,
             PlyPosition start)
      : window_(file, file_bytes), check_colours_(plan.check_colours) {
    vertex_count_ = plan.elements[plan.vertex_element].element.count;
    window_.seek(start.offset);
  }

  PlyPosition position() const override { return {window_.offset(), 0}; }
  void skip(const PlyElementPlan& plan) override;
  void read_vertices(const PlyElementPlan& plan, VertexBlocks& blocks) override;
  void read_faces(const PlyElementPlan& plan, TriangleBlocks& blocks) override;
  void expect_end() override;

 private:
  struct Row {
    const PlyElementPlan& plan;
    std::uint64_t number;
  };
  struct Gathered {
    int slot = 0;
    PlyType type{};
    std::size_t offset = 0;  ///< in the row
  };

  [[noreturn]] void fail(std::uint64_t offset, const std::string& message) const {
    fail_at_byte(window_.file().path(), offset, message);
  }
  void require(const Row& row, const PlyProperty& property, std::uint64_t bytes);
  std::uint64_t take_count(const Row& row, const PlyProperty& property);
  void skip_property(const Row& row, const PlyProperty& property);
  void read_fixed_vertices(const PlyElementPlan& plan, VertexBlocks& blocks);
  void read_vertex_row(const Row& row, VertexBlocks& blocks);
  std::uint64_t read_triangle_rows(const PlyElementPlan& plan, std::uint64_t first,
                                   TriangleBlocks& blocks);
  void read_face_row(const Row& row, TriangleBlocks& blocks);
  void take_corners(const Row& row, const PlyProperty& property, TriangleBlocks& blocks);

  ByteWindow window_;
  bool check_colours_;
  std::uint64_t vertex_count_ = 0;
};

/// Makes `bytes` (at most a buffer) available, or fails as truncated.
template <bool Swap>
void BinaryBody<Swap>::require(const Row& row, const PlyProperty& property, std::uint64_t bytes) {
  if (window_.ensure(static_cast<std::size_t>(bytes)))
    return;
  fail(window_.offset(),
       fmt::format("expected {} bytes for {} in {}, found the end of the file after {} (truncated)",
                   bytes, in_quotes(property.name), row_name(row.plan, row.number),
                   window_.remaining()));
}

/// Takes a list's length; the list fits into the rest of the file.
template <bool Swap>
std::uint64_t BinaryBody<Swap>::take_count(const Row& row, const PlyProperty& property) {
  const PlyType type = *property.count_type;
  require(row, property, size_of(type));
  const std::uint64_t offset = window_.offset();
  const auto count = with_type(type, [&](auto zero) {
    return static_cast<std::int64_t>(load<decltype(zero), Swap>(window_.begin()));
  });
  window_.advance(size_of(type));
  const std::uint64_t fitting = window_.remaining() / size_of(property.type);
  if (count < 0 || static_cast<std::uint64_t>(count) > fitting) {
    fail(offset,
         fmt::format("expected the length of list {} in {} from 0 to {}, as many as fit "
                     "into the rest of the file, found {} (truncated or damaged)",
                     in_quotes(property.name), row_name(row.plan, row.number), fitting, count));
  }
  return static_cast<std::uint64_t>(count);
}

template <bool Swap>
void BinaryBody<Swap>::skip_property(const Row& row, const PlyProperty& property) {
  if (property.is_list()) {
    const std::uint64_t count = take_count(row, property);
    window_.skip(count * size_of(property.type));
  } else {
    require(row, property, size_of(property.type));
    window_.advance(size_of(property.type));
  }
}

template <bool Swap>
void BinaryBody<Swap>::skip(const PlyElementPlan& plan) {
  if (plan.stride) {
    const std::uint64_t bytes = *plan.stride * plan.element.count;
    if (bytes > window_.remaining()) {
      fail(window_.offset(), fmt::format("expected {} bytes of element {}, found {} (truncated)",
                                         bytes, in_quotes(plan.element.name), window_.remaining()));
    }
    window_.skip(bytes);
    return;
  }
  for (std::uint64_t i = 0; i < plan.element.count; ++i) {
    for (const PlyProperty& property : plan.element.properties)
      skip_property({plan, i}, property);
  }
}

template <bool Swap>
void BinaryBody<Swap>::read_vertices(const PlyElementPlan& plan, VertexBlocks& blocks) {
  if (plan.stride) {
    read_fixed_vertices(plan, blocks);
    return;
  }
  for (std::uint64_t i = 0; i < plan.element.count; ++i)
    read_vertex_row({plan, i}, blocks);
}

template <class T, bool Swap, class Out>
void gather(const std::byte* from, std::size_t from_stride, VertexBlocks::Column to,
            std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    const auto value = static_cast<Out>(load<T, Swap>(from + i * from_stride));
    std::memcpy(to.data + i * to.stride, &value, sizeof(value));
  }
}

/// All rows have one size: takes them batch by batch, each property as one column.
template <bool Swap>
void BinaryBody<Swap>::read_fixed_vertices(const PlyElementPlan& plan, VertexBlocks& blocks) {
  std::vector<Gathered> fields;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < plan.slots.size(); ++i) {
    const PlyType type = plan.element.properties[i].type;
    if (plan.slots[i] != kSkipped)
      fields.push_back({plan.slots[i], type, offset});
    offset += size_of(type);
  }
  const std::size_t stride = offset;
  constexpr std::uint64_t kBatch =
      2048;  // rows: source and result together stay in the L1/L2 cache
  for (std::uint64_t done = 0; done < plan.element.count;) {
    require({plan, done}, plan.element.properties[0], stride);
    const auto rows = static_cast<std::size_t>(
        std::min({std::uint64_t{window_.available() / stride}, std::uint64_t{blocks.room()},
                  plan.element.count - done, kBatch}));
    for (const Gathered& field : fields) {
      const VertexBlocks::Column column = blocks.column(field.slot);
      const std::byte* from = window_.begin() + field.offset;
      with_type(field.type, [&](auto zero) {
        using T = decltype(zero);
        column.wide ? gather<T, Swap, double>(from, stride, column, rows)
                    : gather<T, Swap, float>(from, stride, column, rows);
      });
    }
    if (const auto bad = blocks.commit(rows, check_colours_)) {
      const auto field = std::find_if(fields.begin(), fields.end(),
                                      [&](const Gathered& f) { return f.slot == bad->slot; });
      fail(window_.offset() + bad->row * stride + field->offset,
           defect_text(plan, done + bad->row, bad->slot, bad->value));
    }
    window_.advance(rows * stride);
    done += rows;
  }
}

template <bool Swap>
void BinaryBody<Swap>::read_vertex_row(const Row& row, VertexBlocks& blocks) {
  const std::uint64_t start = window_.offset();
  for (std::size_t i = 0; i < row.plan.slots.size(); ++i) {
    const PlyProperty& property = row.plan.element.properties[i];
    if (row.plan.slots[i] == kSkipped) {
      skip_property(row, property);
      continue;
    }
    require(row, property, size_of(property.type));
    blocks.set(row.plan.slots[i], with_type(property.type, [&](auto zero) {
                 return static_cast<double>(load<decltype(zero), Swap>(window_.begin()));
               }));
    window_.advance(size_of(property.type));
  }
  if (const auto bad = blocks.commit(1, check_colours_)) {
    fail(start, defect_text(row.plan, row.number, bad->slot, bad->value));
  }
}

/// The usual faces, `list uchar int` and perhaps scalars around it: takes triangles as long as all
/// is well, and leaves any other row, the last of the buffer and every error to read_face_row.
/// Returns the number of the next row.
template <bool Swap>
std::uint64_t BinaryBody<Swap>::read_triangle_rows(const PlyElementPlan& plan, std::uint64_t first,
                                                   TriangleBlocks& blocks) {
  std::size_t before = 0;
  for (std::size_t i = 0; i < plan.corners; ++i)
    before += size_of(plan.element.properties[i].type);
  const std::size_t stride = plan.min_row_bytes + 3 * sizeof(std::uint32_t);
  // A negative int is a uint of 2^31 or more.
  const bool is_signed = plan.element.properties[plan.corners].type == PlyType::i32;
  const std::uint64_t limit =
      is_signed ? std::min(vertex_count_, std::uint64_t{1} << 31) : vertex_count_;
  std::uint64_t row = first;
  std::size_t left = window_.available() / stride;
  const std::byte* at = window_.begin() + before;
  for (; left > 0 && row < plan.element.count; --left, ++row, at += stride) {
    if (at[0] != std::byte{3})
      break;
    const auto a = load<std::uint32_t, Swap>(at + 1);
    const auto b = load<std::uint32_t, Swap>(at + 5);
    const auto c = load<std::uint32_t, Swap>(at + 9);
    if (std::max({a, b, c}) >= limit)
      break;
    blocks.add_triangle_face(a, b, c);
  }
  window_.advance((row - first) * stride);
  return row;
}

bool has_usual_faces(const PlyElementPlan& plan) {
  const PlyProperty& corners = plan.element.properties[plan.corners];
  const auto lists = std::count_if(plan.element.properties.begin(), plan.element.properties.end(),
                                   [](const PlyProperty& p) { return p.is_list(); });
  return plan.role == Role::polygons && lists == 1 && corners.count_type == PlyType::u8 &&
         (corners.type == PlyType::i32 || corners.type == PlyType::u32);
}

template <bool Swap>
void BinaryBody<Swap>::read_faces(const PlyElementPlan& plan, TriangleBlocks& blocks) {
  const bool usual = has_usual_faces(plan);
  for (std::uint64_t row = 0; row < plan.element.count; ++row) {
    if (usual)
      row = read_triangle_rows(plan, row, blocks);
    if (row < plan.element.count)
      read_face_row({plan, row}, blocks);
  }
}

template <bool Swap>
void BinaryBody<Swap>::read_face_row(const Row& row, TriangleBlocks& blocks) {
  for (std::size_t i = 0; i < row.plan.element.properties.size(); ++i) {
    const PlyProperty& property = row.plan.element.properties[i];
    if (i == row.plan.corners) {
      take_corners(row, property, blocks);
    } else {
      skip_property(row, property);
    }
  }
}

template <bool Swap>
void BinaryBody<Swap>::take_corners(const Row& row, const PlyProperty& property,
                                    TriangleBlocks& blocks) {
  const bool strip = row.plan.role == Role::strips;
  const std::uint64_t count = take_count(row, property);
  strip ? blocks.begin_strip() : blocks.begin_polygon();
  for (std::uint64_t i = 0; i < count; ++i) {
    require(row, property, size_of(property.type));
    const auto index = with_type(property.type, [&](auto zero) {
      return static_cast<std::int64_t>(load<decltype(zero), Swap>(window_.begin()));
    });
    if (index >= 0 && static_cast<std::uint64_t>(index) < vertex_count_) {
      const auto corner = static_cast<std::uint32_t>(index);
      strip ? blocks.add_strip_corner(corner) : blocks.add_polygon_corner(corner);
    } else if (strip && is_strip_restart(index, property.type)) {
      blocks.restart_strip();
    } else {
      fail(window_.offset(), index_text(row.plan, row.number, index, vertex_count_));
    }
    window_.advance(size_of(property.type));
  }
  strip ? blocks.end_strip() : blocks.end_polygon();
}

/// Some writers end every file with a line end, also behind zeros that fill up to a multiple of
/// four: at most three bytes, the last of them LF, the others zero or CR, are left alone.
template <bool Swap>
void BinaryBody<Swap>::expect_end() {
  const std::uint64_t remaining = window_.remaining();
  if (remaining == 0)
    return;
  if (remaining < 4) {
    window_.ensure(static_cast<std::size_t>(remaining));
    const bool padding = std::all_of(window_.begin(), window_.end() - 1, [](std::byte b) {
      return b == std::byte{0} || b == std::byte{'\r'};
    });
    if (padding && window_.end()[-1] == std::byte{'\n'})
      return;
  }
  fail(window_.offset(),
       fmt::format("expected the end of the file behind the last row the header declares, found {} "
                   "bytes more (the header's counts or types do not match the data)",
                   remaining));
}

}  // namespace

std::unique_ptr<PlyBody> make_binary_body(const storage::File& file, std::uint64_t file_bytes,
                                          const PlyPlan& plan, PlyPosition start) {
  const bool big = plan.encoding == PlyEncoding::big_endian;
  if (big == (std::endian::native == std::endian::big)) {
    return std::make_unique<BinaryBody<false>>(file, file_bytes, plan, start);
  }
  return std::make_unique<BinaryBody<true>>(file, file_bytes, plan, start);
}

}  // namespace meshhier::mesh_io
