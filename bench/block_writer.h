// Collects the single vertices and triangles of a generator into blocks for a visitor.
#pragma once

#include "bench/generator.h"

#include <cassert>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::bench {

class VertexCollector {
 public:
  /// `visit` must outlive this object.
  VertexCollector(std::size_t block_size, const VertexBlockVisitor& visit)
      : block_size_(block_size), visit_(visit) {
    assert(block_size >= 1);
  }

  void add(Vec3d position, std::span<const float> attributes) {
    positions_.push_back(position);
    attributes_.insert(attributes_.end(), attributes.begin(), attributes.end());
    if (positions_.size() == block_size_)
      flush();
  }
  /// Required after the last vertex.
  void flush() {
    if (!positions_.empty())
      visit_(positions_, attributes_);
    positions_.clear();
    attributes_.clear();
  }

 private:
  std::size_t block_size_;
  const VertexBlockVisitor& visit_;
  std::vector<Vec3d> positions_;
  std::vector<float> attributes_;
};

class TriangleCollector {
 public:
  /// `visit` must outlive this object.
  TriangleCollector(std::size_t block_size, const TriangleBlockVisitor& visit)
      : block_size_(block_size), visit_(visit) {
    assert(block_size >= 1);
  }

  void add(const MeshTriangle& triangle) {
    triangles_.push_back(triangle);
    if (triangles_.size() == block_size_)
      flush();
  }
  /// Required after the last triangle.
  void flush() {
    if (!triangles_.empty())
      visit_(triangles_);
    triangles_.clear();
  }

 private:
  std::size_t block_size_;
  const TriangleBlockVisitor& visit_;
  std::vector<MeshTriangle> triangles_;
};

/// The nearest float, as a double. By way of memory: g++ 12 at -O2 takes a conversion to float and
/// back for nothing where it vectorises neighbouring values.
inline double rounded_to_float(double x) {
  const volatile float narrow = static_cast<float>(x);
  return narrow;
}

/// Returns `p` as a file of single precision holds it.
inline Vec3d rounded_to_float(Vec3d p) {
  return {rounded_to_float(p.x), rounded_to_float(p.y), rounded_to_float(p.z)};
}

}  // namespace meshhier::bench
