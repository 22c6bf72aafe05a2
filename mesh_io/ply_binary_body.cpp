#include "mesh_io/byte_window.h"
#include "mesh_io/input_error.h"
#include "mesh_io/ply_body.h"
#include "mesh_io/ply_values.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Role = PlyElementPlan::Role;

template <bool Swap>
class BinaryBody final : public PlyBody {
 public:
  BinaryBody(const InputFile& input, const PlyPlan& plan, PlyPosition start)
      : window_(input), checks_(plan.checks) {
    vertex_count_ = plan.elements[plan.vertex_element].element.count;
    window_.seek(start.offset);
  }

  PlyPosition position() const override { return {window_.offset(), 0}; }
  void skip(const PlyElementPlan& plan) override;
  void read_vertices(const PlyElementPlan& plan, std::uint64_t first,
                     VertexBlocks& blocks) override;
  void read_faces(const PlyElementPlan& plan, std::uint64_t first, TriangleBlocks& blocks) override;
  void read_rows(const PlyElementPlan& plan, const PlyRowVisitor& visit) override;
  void expect_end() override;
  OddSyntax take_odd() override { return std::exchange(odd_, {}); }

 private:
  struct Row {
    const PlyElementPlan& plan;
    std::uint64_t number;
  };

  [[noreturn]] void fail(std::uint64_t offset, const std::string& message) const {
    fail_at_byte(window_.file().path(), offset, message);
  }
  void require(const Row& row, const PlyProperty& property, std::uint64_t bytes);
  std::uint64_t take_count(const Row& row, const PlyProperty& property);
  void skip_property(const Row& row, const PlyProperty& property);
  void read_vertex_row(const Row& row, VertexBlocks& blocks);
  std::uint64_t read_triangle_rows(const TriangleRows& rows, std::uint64_t first,
                                   std::uint64_t count, TriangleBlocks& blocks);
  void read_face_row(const Row& row, TriangleBlocks& blocks);
  void take_corners(const Row& row, const PlyProperty& property, TriangleBlocks& blocks);
  template <class Take>
  void take_list(const Row& row, const PlyProperty& property, std::uint64_t count,
                 const Take& take);
  void take_property(const Row& row, std::size_t property, std::vector<double>& values);
  std::int64_t load_integer(PlyType type) const;
  double load_number(PlyType type);

  ByteWindow window_;
  RowChecks checks_;
  std::uint64_t vertex_count_ = 0;
  OddSyntax odd_;
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
  if (!property.count_type)
    return property.fixed_count;
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
void BinaryBody<Swap>::read_vertices(const PlyElementPlan& plan, std::uint64_t first,
                                     VertexBlocks& blocks) {
  for (std::uint64_t i = first; i < plan.element.count; ++i)
    read_vertex_row({plan, i}, blocks);
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
    blocks.set(row.plan.slots[i], load_number(property.type));
    window_.advance(size_of(property.type));
  }
  if (const auto bad = blocks.commit(checks_))
    fail_for(*bad, [&] { fail(start, defect_text(row.plan, row.number, bad->slot, bad->value)); });
}

/// Takes rows of usual triangles as long as all is well, and leaves any other row, the last of the
/// buffer and every error to read_face_row. Returns the number of the next row.
template <bool Swap>
std::uint64_t BinaryBody<Swap>::read_triangle_rows(const TriangleRows& rows, std::uint64_t first,
                                                   std::uint64_t count, TriangleBlocks& blocks) {
  const std::size_t most =
      std::min<std::uint64_t>(window_.available() / rows.stride, count - first);
  const std::size_t taken =
      take_triangles<Swap>(rows, window_.begin(), most,
                           [&](auto a, auto b, auto c) { blocks.add_triangle_face(a, b, c); });
  window_.advance(taken * rows.stride);
  return first + taken;
}

template <bool Swap>
void BinaryBody<Swap>::read_faces(const PlyElementPlan& plan, std::uint64_t first,
                                  TriangleBlocks& blocks) {
  const std::optional<TriangleRows> usual = triangle_rows(plan, vertex_count_);
  for (std::uint64_t row = first; row < plan.element.count; ++row) {
    if (usual)
      row = read_triangle_rows(*usual, row, plan.element.count, blocks);
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
  const std::uint64_t start = window_.offset();
  const std::uint64_t count = take_count(row, property);
  if (!strip && count > PolygonCut::kMostCorners)
    fail(start, PolygonCut::limit_text());
  strip ? blocks.begin_strip() : blocks.begin_polygon();
  take_list(row, property, count, [&] {
    const std::int64_t index = load_integer(property.type);
    if (index >= 0 && static_cast<std::uint64_t>(index) < vertex_count_) {
      const auto corner = static_cast<std::uint32_t>(index);
      strip ? blocks.add_strip_corner(corner) : blocks.add_polygon_corner(corner);
    } else if (strip && is_strip_restart(index, property.type)) {
      blocks.restart_strip();
    } else {
      fail(window_.offset(), index_text(row.plan, row.number, index, vertex_count_));
    }
  });
  strip ? blocks.end_strip() : blocks.end_polygon();
}

/// Calls `take` with each item at the window's beginning.
template <bool Swap>
template <class Take>
void BinaryBody<Swap>::take_list(const Row& row, const PlyProperty& property, std::uint64_t count,
                                 const Take& take) {
  for (std::uint64_t i = 0; i < count; ++i) {
    require(row, property, size_of(property.type));
    take();
    window_.advance(size_of(property.type));
  }
}

/// Reads a value of an integer type.
template <bool Swap>
std::int64_t BinaryBody<Swap>::load_integer(PlyType type) const {
  return with_type(type, [&](auto zero) {
    return static_cast<std::int64_t>(load<decltype(zero), Swap>(window_.begin()));
  });
}

template <bool Swap>
double BinaryBody<Swap>::load_number(PlyType type) {
  return with_type(type, [&](auto zero) {
    const auto value = load<decltype(zero), Swap>(window_.begin());
    odd_.rounded += is_rounded(value) ? 1 : 0;
    return static_cast<double>(value);
  });
}

template <bool Swap>
void BinaryBody<Swap>::read_rows(const PlyElementPlan& plan, const PlyRowVisitor& visit) {
  PlyRow taken;
  taken.values.resize(plan.element.properties.size());
  for (taken.number = 0; taken.number < plan.element.count; ++taken.number) {
    const std::uint64_t start = window_.offset();
    const Row row{plan, taken.number};
    for (std::size_t i = 0; i < taken.values.size(); ++i) {
      if (plan.takes(i)) {
        take_property(row, i, taken.values[i]);
      } else {
        skip_property(row, plan.element.properties[i]);
      }
    }
    const std::string defect = visit(taken);
    if (!defect.empty())
      fail(start, defect);
  }
}

template <bool Swap>
void BinaryBody<Swap>::take_property(const Row& row, std::size_t index,
                                     std::vector<double>& values) {
  const PlyProperty& property = row.plan.element.properties[index];
  const std::uint64_t start = window_.offset();
  const std::uint64_t count = property.is_list() ? take_count(row, property) : 1;
  if (count > most_items(row.plan, index))
    fail(start, corners_text(row.plan, row.number, count));
  values.clear();
  take_list(row, property, count, [&] { values.push_back(load_number(property.type)); });
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

std::unique_ptr<PlyBody> make_binary_body(const InputFile& input, const PlyPlan& plan,
                                          PlyPosition start) {
  if (is_swapped(plan.encoding))
    return std::make_unique<BinaryBody<true>>(input, plan, start);
  return std::make_unique<BinaryBody<false>>(input, plan, start);
}

}  // namespace meshhier::mesh_io
