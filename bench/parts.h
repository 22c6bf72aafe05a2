// A mesh whose vertices are divided into parts, however that was done, and how good the parts are.
#pragma once

#include "bench/generator.h"
#include "hierarchy/build_tile.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::bench {

/// Geometry alone. Corners are < positions.size().
struct PlainMesh {
  std::vector<Vec3f> positions;
  std::vector<MeshTriangle> triangles;
};

/// The mesh in single precision; double coordinates relative to the middle of their bounding box.
PlainMesh plain_mesh(const LoadedMesh& mesh);

/// A division of a mesh's vertices. No part is empty.
struct Parts {
  std::vector<std::uint32_t> part_of;  ///< one entry a vertex, < count
  std::uint32_t count = 0;
};

/// Removes empty parts; the others keep their order. `part_of`: entries < `count`.
Parts without_empty_parts(std::vector<std::uint32_t> part_of, std::uint32_t count);

/// Throws Error(usage) unless 1 <= count <= points: so many parts none of which is empty.
void check_part_count(std::size_t points, std::uint32_t count);

/// Hands out the parts one by one as tiles, so that what is known of tiles can be asked of any
/// division.
class PartTiles {
 public:
  /// Refers to both. O(n).
  PartTiles(const PlainMesh& mesh, const Parts& parts);

  std::uint32_t count() const { return parts_.count; }

  /// A part's own vertices by number, then its ghosts; every vertex stands for itself alone.
  /// Triangles are in the order of the mesh.
  BuildTile tile(std::uint32_t part) const;

 private:
  /// Numbers of one kind grouped by part: those of part p are numbers[starts[p]] to
  /// numbers[starts[p + 1]].
  struct Groups {
    std::vector<std::size_t> starts;
    std::vector<std::uint32_t> numbers;
    std::span<const std::uint32_t> of(std::uint32_t part) const {
      return std::span(numbers).subspan(starts[part], starts[part + 1] - starts[part]);
    }
  };

  template <class Visit>
  void for_each_part(const MeshTriangle& triangle, const Visit& visit) const;

  const PlainMesh& mesh_;
  const Parts& parts_;
  Groups vertices_;
  Groups triangles_;                  ///< each in every part it touches
  std::vector<std::uint32_t> place_;  ///< of a vertex among its part's
};

struct PartFigures {
  std::uint32_t count = 0;
  std::uint64_t least_vertices = 0;
  std::uint64_t most_vertices = 0;
  double mean_vertices = 0;
  /// p^2 / (4 pi w) by partition::compactness, over the parts that have an area. The median is the
  /// lower of two.
  double mean_compactness = 0;
  double median_compactness = 0;
  std::uint32_t without_area = 0;
};

PartFigures measure_parts(const PlainMesh& mesh, const Parts& parts);

}  // namespace meshhier::bench
