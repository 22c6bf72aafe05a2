// The client of a progressive stream has two arrays, into which each file's lists put entries.
//
// Lin & Luo, "Progressive Display Method for Interactive Mobile 3D Graphics": vertices and
// triangles are put into their places; then each merge copies one vertex's slot to another's.
// Nothing else is ever updated: O(1) for each entry of a file.
#pragma once

#include "hierarchy/detail.h"
#include "hierarchy/triangle.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::progressive {

/// The size of the original mesh.
struct StreamSize {
  std::uint64_t vertices = 0;      ///< slots, < 2^32
  std::uint64_t own_vertices = 0;  ///< <= vertices; the others may move from file to file
  std::uint64_t triangles = 0;
};

/// For one thread.
class Reconstruction {
 public:
  /// Takes memory for both arrays.
  Reconstruction(const StreamSize& size, const AttributeLayout& layout);

  /// Returns the bytes that both arrays take.
  static std::uint64_t memory_bytes(const StreamSize& size, const AttributeLayout& layout);

  /// Applies the next run of the stream. Throws Error(corrupt) if it contradicts those before: an
  /// index beyond the mesh, a vertex or triangle that is there already, a place that is not finite,
  /// a merge with a vertex that is nowhere. A vertex is predicted from the one before it in its
  /// run; the first has none.
  void apply(const DetailRun& run);

  std::uint64_t shown_vertices() const { return shown_vertices_; }
  std::uint64_t shown_triangles() const { return shown_triangles_; }

  /// Hands out the mesh as it is now: vertices that are there, in the order of their indices, each
  /// as its values; then triangles, in theirs, as numbers of these vertices. Both come in blocks.
  /// Throws Error(corrupt) if a triangle's corner is nowhere. It can be done once, and ends the
  /// reconstruction: the numbers take the vertices' place in memory.
  void hand_out(const std::function<void(std::span<const float> values)>& vertices,
                const std::function<void(std::span<const Triangle<std::uint32_t>>)>& triangles) &&;

 private:
  void apply(const VertexRun& run);
  void apply(const TriangleRun& run);
  void apply(const MergeRun& run);
  std::span<float> values_of(std::uint32_t vertex) {
    return std::span(values_).subspan(vertex * width_, width_);
  }
  bool is_there(std::uint32_t vertex) const { return origins_[vertex] == vertex; }

  StreamSize size_;
  AttributeLayout layout_;
  std::size_t width_;
  // The vertex array has two columns: a slot has the values of a vertex, and says whose they are.
  std::vector<float> values_;
  std::vector<std::uint32_t> origins_;
  std::vector<Triangle<std::uint32_t>> corners_;  ///< the triangle array
  std::uint64_t shown_vertices_ = 0;
  std::uint64_t shown_triangles_ = 0;
};

}  // namespace meshhier::progressive
