#include "mesh_io/mesh_blocks.h"

#include "hierarchy/value_channels.h"
#include "mesh_io/coordinate_range.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

namespace meshhier::mesh_io {
namespace {

/// Returns whether no size is above `most`. Infinity's bits and those of NaN are above all others
/// as integers. Without branches, so that it vectorizes.
bool all_up_to(float most, const float* values, std::size_t count) {
  constexpr std::uint32_t kSign = 0x80000000;
  const auto limit = std::bit_cast<std::uint32_t>(most);
  std::uint32_t bad = 0;
  for (std::size_t i = 0; i < count; ++i)
    bad |= static_cast<std::uint32_t>((std::bit_cast<std::uint32_t>(values[i]) & ~kSign) > limit);
  return bad == 0;
}

bool all_finite(const float* values, std::size_t count) {
  return all_up_to(std::numeric_limits<float>::max(), values, count);
}

bool all_in_range(std::span<const Vec3f> points) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  return all_up_to(static_cast<float>(kMostCoordinate),
                   reinterpret_cast<const float*>(points.data()), 3 * points.size());
}

bool all_in_range(std::span<const Vec3d> points) {
  int good = 1;  // not a bool, so that the loop has no branch
  for (const Vec3d& p : points)
    good &= int{is_coordinate(p.x)} & int{is_coordinate(p.y)} & int{is_coordinate(p.z)};
  return good != 0;
}

bool is_byte(double value) {
  return value >= 0 && value <= 255 && value == std::floor(value);
}

bool is_quantity(const AttributePart& part) {
  return part.count > 0 && row_of(part.kind).rule == AttributeRule::quantities;
}

}  // namespace

VertexRows::VertexRows(const MeshDescription& mesh, std::size_t rows, BlockMemory& memory)
    : layout_(mesh.attributes),
      parts_(layout_.parts()),
      has_quantities_(std::ranges::any_of(parts_, is_quantity)),
      channels_(static_cast<std::size_t>(mesh.attributes.channels())),
      wide_(mesh.wide_coordinates),
      memory_(memory) {
  if (wide_) {
    memory_.exact.resize(rows);
  } else {
    memory_.positions.resize(rows);
  }
  memory_.attributes.resize(rows * channels_);
}

VertexRows::Column::Form VertexRows::form_of(int slot) const {
  const bool is_wide = std::ranges::any_of(placed_values(layout_), [&](const PlacedValue& value) {
    return takes_two_channels(value.type) &&
           static_cast<int>(value.channel) == slot - kFirstAttributeSlot;
  });
  return is_wide ? Column::Form::two_channels : Column::Form::one_float;
}

bool VertexRows::may_be_anything(int slot) const {
  const auto channel = static_cast<std::size_t>(slot - kFirstAttributeSlot);  // huge of places
  return std::ranges::any_of(
      parts_, [&](const AttributePart& part) { return is_quantity(part) && part.has(channel); });
}

/// Returns whether the attributes that must be finite are.
bool VertexRows::all_checked_finite(std::size_t first, std::size_t count) const {
  const float* rows = memory_.attributes.data() + first * channels_;
  if (!has_quantities_)
    return all_finite(rows, count * channels_);
  for (std::size_t i = 0; i < count; ++i, rows += channels_) {
    for (const AttributePart& part : parts_) {
      if (!is_quantity(part) && !all_finite(rows + part.first, part.count))
        return false;
    }
  }
  return true;
}

VertexRows::Column VertexRows::column(std::size_t row, int slot) {
  if (slot >= kFirstAttributeSlot) {
    const auto channel = static_cast<std::size_t>(slot - kFirstAttributeSlot);
    float* first = memory_.attributes.data() + row * channels_ + channel;
    return {reinterpret_cast<std::byte*>(first), channels_ * sizeof(float), form_of(slot)};
  }
  const auto axis = static_cast<std::size_t>(slot);
  if (wide_) {
    auto* first = reinterpret_cast<std::byte*>(memory_.exact.data() + row);
    return {first + axis * sizeof(double), sizeof(Vec3d), Column::Form::one_double};
  }
  auto* first = reinterpret_cast<std::byte*>(memory_.positions.data() + row);
  return {first + axis * sizeof(float), sizeof(Vec3f), Column::Form::one_float};
}

void VertexRows::put(const Column& to, double value) {
  if (to.form == Column::Form::one_double) {
    std::memcpy(to.data, &value, sizeof(value));
    return;
  }
  if (to.form == Column::Form::two_channels) {
    std::array<float, 2> halves;
    put_value(ValueType::f64, value, halves.data());
    std::memcpy(to.data, halves.data(), sizeof(halves));
    return;
  }
  const auto narrow = static_cast<float>(value);
  std::memcpy(to.data, &narrow, sizeof(narrow));
}

double VertexRows::value_of(std::size_t row, int slot) const {
  if (slot >= kFirstAttributeSlot) {
    const auto channel = static_cast<std::size_t>(slot - kFirstAttributeSlot);
    return memory_.attributes[row * channels_ + channel];
  }
  return wide_ ? memory_.exact[row][slot] : static_cast<double>(memory_.positions[row][slot]);
}

bool VertexRows::is_placed(std::size_t row) const {
  return wide_ ? is_finite(memory_.exact[row]) : is_finite(memory_.positions[row]);
}

ZeroedCounts VertexRows::zero_what_is_not_finite(std::size_t first, std::size_t count) {
  const std::span<float> rows =
      std::span(memory_.attributes).subspan(first * channels_, count * channels_);
  return all_checked_finite(first, count) ? ZeroedCounts{}
                                          : mesh_io::zero_what_is_not_finite(parts_, rows);
}

std::optional<VertexRows::Defect> VertexRows::find_defect(std::size_t first, std::size_t count,
                                                          const RowChecks& checks) const {
  const bool sound =
      (wide_ ? all_in_range(std::span<const Vec3d>(memory_.exact).subspan(first, count))
             : all_in_range(std::span<const Vec3f>(memory_.positions).subspan(first, count))) &&
      all_checked_finite(first, count);
  if (sound && !checks.colours)
    return std::nullopt;
  const int slots = kFirstAttributeSlot + layout_.channels();
  const AttributePart& colours = part_of(parts_, AttributeKind::colours);
  for (std::size_t row = 0; row < count; ++row) {
    if (!checks.places && !is_placed(first + row))
      continue;
    for (int slot = 0; slot < slots; ++slot) {
      if (may_be_anything(slot))
        continue;
      const double value = value_of(first + row, slot);
      const bool coordinate = slot < kFirstAttributeSlot;
      const bool colour = checks.colours && !coordinate &&
                          colours.has(static_cast<std::size_t>(slot - kFirstAttributeSlot));
      if (!std::isfinite(value) || (colour && !is_byte(value)) ||
          (coordinate && !is_coordinate(value)))
        return Defect{row, slot, value};
    }
  }
  return std::nullopt;
}

VertexBlock VertexRows::block(std::uint64_t first_id, std::size_t rows,
                              const ZeroedCounts& zeroed) const {
  VertexBlock block;
  block.zeroed = zeroed;
  block.first = first_id;
  if (wide_) {
    block.exact = std::span<const Vec3d>(memory_.exact).first(rows);
  } else {
    block.positions = std::span<const Vec3f>(memory_.positions).first(rows);
  }
  block.attributes = std::span<const float>(memory_.attributes).first(rows * channels_);
  return block;
}

VertexBlocks::VertexBlocks(const MeshDescription& mesh, const VertexVisitor& visit,
                           std::uint64_t first)
    : visit_(visit),
      rows_(mesh, std::min<std::uint64_t>(mesh.vertex_count - first, MeshSource::kBlockSize),
            memory_),
      first_(first) {}

void VertexBlocks::set(int slot, double value) {
  VertexRows::put(rows_.column(filled_, slot), value);
}

std::optional<VertexRows::Defect> VertexBlocks::commit(const RowChecks& checks) {
  zeroed_ += rows_.zero_what_is_not_finite(filled_, 1);
  if (const auto defect = rows_.find_defect(filled_, 1, checks))
    return defect;
  if (++filled_ == MeshSource::kBlockSize)
    flush();
  return std::nullopt;
}

void VertexBlocks::flush() {
  if (filled_ == 0)
    return;
  const VertexBlock block = rows_.block(first_, filled_, std::exchange(zeroed_, {}));
  first_ += filled_;
  filled_ = 0;
  visit_(block);
}

void TriangleBlocks::add_polygon_corner(std::uint32_t corner) {
  if (place_of_ == nullptr)
    return add_fan_corner(corner);
  corners_.push_back(corner);
  ++corner_count_;
}

void TriangleBlocks::add_fan_corner(std::uint32_t corner) {
  if (corner_count_ == 0)
    first_ = corner;
  if (corner_count_ >= 2)
    add(first_, previous_, corner);
  previous_ = corner;
  ++corner_count_;
}

void TriangleBlocks::end_polygon() {
  ++counts_.faces;
  if (corner_count_ < 3)
    ++counts_.degenerate_triangles;
  else if (corners_.size() >= 3)
    cut_polygon();
}

void TriangleBlocks::cut_polygon() {
  cut_.for_each_triangle(
      corners_.size(), [&](std::size_t i) { return (*place_of_)(corners_[i]); }, counts_.polygons,
      [&](std::size_t i, std::size_t j, std::size_t k) {
        add(corners_[i], corners_[j], corners_[k]);
      });
}

void TriangleBlocks::add_strip_corner(std::uint32_t corner) {
  if (corner_count_ >= 2) {
    const bool swapped = corner_count_ % 2 == 1;
    add(swapped ? previous_ : first_, swapped ? first_ : previous_, corner);
  }
  first_ = previous_;
  previous_ = corner;
  ++corner_count_;
}

FaceCounts TriangleBlocks::finish() {
  flush();
  return counts_;
}

void TriangleBlocks::flush() {
  if (filled_ == 0)
    return;
  const std::size_t count = filled_;
  filled_ = 0;
  counts_.triangles += count;
  visit_(std::span<const Triangle<VertexId>>(block_.get(), count));
}

}  // namespace meshhier::mesh_io
