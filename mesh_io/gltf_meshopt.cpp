#include "mesh_io/gltf_meshopt.h"

#include "mesh_io/meshopt_filters.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

namespace meshhier::mesh_io {
namespace {

using Mode = GltfMeshopt::Mode;
using Filter = GltfMeshopt::Filter;

/// A byte of a stream stands for at most so many: of attributes, 64 elements' bytes have 2 bits a
/// 16 of them; of triangles, three indices have a byte, and of other indices each has one.
constexpr std::uint64_t kMostAttributeBytes = 64;
constexpr std::uint64_t kMostTriangleIndices = 3;

bool has_sound_stride(const GltfMeshopt& view) {
  switch (view.mode) {
    case Mode::attributes:
      return view.stride > 0 && view.stride % 4 == 0;
    case Mode::triangles:
    case Mode::indices:
      return view.stride == 2 || view.stride == 4;
  }
  return false;
}

bool fits_filter(const GltfMeshopt& view) {
  switch (view.filter) {
    case Filter::none:
      return true;
    case Filter::octahedral:
      return view.mode == Mode::attributes && (view.stride == 4 || view.stride == 8);
    case Filter::quaternion:
      return view.mode == Mode::attributes && view.stride == 8;
    case Filter::exponential:
      return view.mode == Mode::attributes;
  }
  return false;
}

bool can_hold(const GltfMeshopt& view) {
  switch (view.mode) {
    case Mode::attributes:
      return view.count * view.stride <= kMostAttributeBytes * view.bytes;
    case Mode::triangles:
      return view.count <= kMostTriangleIndices * view.bytes;
    case Mode::indices:
      return view.count <= view.bytes;
  }
  return false;
}

void unfilter(const GltfMeshopt& view, std::span<std::byte> plain) {
  switch (view.filter) {
    case Filter::none:
      return;
    case Filter::octahedral:
      return undo_octahedral(plain, view.stride);
    case Filter::quaternion:
      return undo_quaternion(plain);
    case Filter::exponential:
      return meshopt_decodeFilterExp(plain.data(), view.count, view.stride);
  }
}

}  // namespace

std::string meshopt_fault(const GltfMeshopt& view) {
  if (!has_sound_stride(view))
    return fmt::format("byteStride {} is none of its mode", view.stride);
  if (!fits_filter(view))
    return "its filter does not fit its mode and byteStride";
  if (view.count == 0 || (view.mode == Mode::triangles && view.count % 3 != 0))
    return fmt::format("count {} is none of its mode", view.count);
  if (!can_hold(view))
    return fmt::format("{} bytes cannot hold {} elements", view.bytes, view.count);
  return {};
}

bool decode_meshopt(const GltfMeshopt& view, std::span<const std::byte> stream,
                    std::span<std::byte> plain) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(stream.data());
  int failed = 0;
  switch (view.mode) {
    case Mode::attributes:
      failed =
          meshopt_decodeVertexBuffer(plain.data(), view.count, view.stride, bytes, stream.size());
      break;
    case Mode::triangles:
      failed =
          meshopt_decodeIndexBuffer(plain.data(), view.count, view.stride, bytes, stream.size());
      break;
    case Mode::indices:
      failed =
          meshopt_decodeIndexSequence(plain.data(), view.count, view.stride, bytes, stream.size());
      break;
  }
  if (failed != 0)
    return false;
  unfilter(view, plain);
  return true;
}

}  // namespace meshhier::mesh_io
