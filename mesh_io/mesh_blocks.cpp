#include "mesh_io/mesh_blocks.h"

#include "mesh_io/ply_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

namespace meshhier::mesh_io {
namespace {

/// True if all are finite: no exponent has all bits set. Without branches, so that it vectorizes.
bool all_finite(const float* values, std::size_t count) {
  constexpr std::uint32_t kExponent = 0x7f800000;
  std::uint32_t bad = 0;
  for (std::size_t i = 0; i < count; ++i) {
    bad |= static_cast<std::uint32_t>((std::bit_cast<std::uint32_t>(values[i]) & kExponent) ==
                                      kExponent);
  }
  return bad == 0;
}

template <class Vec>
bool all_finite(std::span<const Vec> points) {
  bool finite = true;
  for (const Vec& p : points) {
    finite = finite & std::isfinite(p.x) & std::isfinite(p.y) & std::isfinite(p.z);
  }
  return finite;
}

bool is_byte(double value) {
  return value >= 0 && value <= 255 && value == std::floor(value);
}

}  // namespace

VertexBlocks::VertexBlocks(const MeshDescription& mesh, const VertexVisitor& visit)
    : layout_(mesh.attributes),
      capacity_(std::min<std::uint64_t>(mesh.vertex_count, MeshSource::kBlockSize)),
      channels_(static_cast<std::size_t>(mesh.attributes.channels())),
      wide_(mesh.wide_coordinates),
      visit_(visit) {
  if (wide_) {
    exact_.resize(capacity_);
  } else {
    positions_.resize(capacity_);
  }
  attributes_.resize(capacity_ * channels_);
}

VertexBlocks::Column VertexBlocks::column(int slot) {
  if (slot >= kFirstAttributeSlot) {
    const auto channel = static_cast<std::size_t>(slot - kFirstAttributeSlot);
    float* first = attributes_.data() + filled_ * channels_ + channel;
    return {reinterpret_cast<std::byte*>(first), channels_ * sizeof(float), false};
  }
  const auto axis = static_cast<std::size_t>(slot);
  if (wide_) {
    auto* first = reinterpret_cast<std::byte*>(exact_.data() + filled_);
    return {first + axis * sizeof(double), sizeof(Vec3d), true};
  }
  auto* first = reinterpret_cast<std::byte*>(positions_.data() + filled_);
  return {first + axis * sizeof(float), sizeof(Vec3f), false};
}

void VertexBlocks::set(int slot, double value) {
  const Column target = column(slot);
  if (target.wide) {
    std::memcpy(target.data, &value, sizeof(value));
    return;
  }
  const auto narrow = static_cast<float>(value);
  std::memcpy(target.data, &narrow, sizeof(narrow));
}

std::optional<VertexBlocks::Defect> VertexBlocks::commit(std::size_t rows, bool check_colours) {
  const bool finite =
      (wide_ ? all_finite(std::span<const Vec3d>(exact_).subspan(filled_, rows))
             : all_finite(std::span<const Vec3f>(positions_).subspan(filled_, rows))) &&
      all_finite(attributes_.data() + filled_ * channels_, rows * channels_);
  if (!finite || check_colours) {
    if (const auto defect = find_defect(rows, check_colours))
      return defect;
  }
  filled_ += rows;
  if (filled_ == MeshSource::kBlockSize)
    flush();
  return std::nullopt;
}

double VertexBlocks::value_of(std::size_t row, int slot) const {
  if (slot >= kFirstAttributeSlot) {
    return attributes_[row * channels_ + static_cast<std::size_t>(slot - kFirstAttributeSlot)];
  }
  return wide_ ? exact_[row][slot] : static_cast<double>(positions_[row][slot]);
}

std::optional<VertexBlocks::Defect> VertexBlocks::find_defect(std::size_t rows,
                                                              bool check_colours) const {
  const int slots = kFirstAttributeSlot + layout_.channels();
  const int first_colour = kFirstAttributeSlot + layout_.colour_offset();
  const int last_colour = first_colour + layout_.colour_channels();
  for (std::size_t row = 0; row < rows; ++row) {
    for (int slot = 0; slot < slots; ++slot) {
      const double value = value_of(filled_ + row, slot);
      const bool colour = check_colours && slot >= first_colour && slot < last_colour;
      if (!std::isfinite(value) || (colour && !is_byte(value)))
        return Defect{row, slot, value};
    }
  }
  return std::nullopt;
}

void VertexBlocks::flush() {
  if (filled_ == 0)
    return;
  VertexBlock block;
  block.first = first_;
  if (wide_) {
    block.exact = std::span<const Vec3d>(exact_).first(filled_);
  } else {
    block.positions = std::span<const Vec3f>(positions_).first(filled_);
  }
  block.attributes = std::span<const float>(attributes_).first(filled_ * channels_);
  first_ += filled_;
  filled_ = 0;
  visit_(block);
}

void TriangleBlocks::add_polygon_corner(std::uint32_t corner) {
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
  visit_(std::span<const SourceTriangle>(block_.get(), count));
}

}  // namespace meshhier::mesh_io
