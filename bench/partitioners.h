// Three ways to divide a mesh's vertices into parts: those that Kim & Lee compare.
#pragma once

#include "bench/parts.h"
#include "hierarchy/vec.h"
#include "partition/direction.h"
#include "storage/io/file.h"

#include <cstdint>
#include <span>

namespace meshhier::bench {

/// The partitions that a build makes of the mesh: exact medians, from partition/'s own code.
/// `files`: for the scratch file, which is not made as long as memory suffices. Throws Error(usage)
/// unless 1 <= count <= vertices.
Parts kd_parts(const PlainMesh& mesh, std::uint32_t count, partition::Axis axis,
               storage::FileSystem& files);

/// Leaves of an adaptive octree over the cube around the points: cells are cut at their middle, the
/// one with the most points first, until there are `count` leaves with points or none can be cut.
/// This is the octree of the leaf capacity that gives `count` leaves; its last cut may leave up to
/// six more. Leaves are numbered in depth-first order. Throws Error(usage) unless 1 <= count <=
/// points. O(n log n) for surfaces.
Parts octree_parts(std::span<const Vec3f> points, std::uint32_t count);

struct KMeansParts {
  Parts parts;  ///< fewer than asked for if there are fewer distinct points, or a mean lost all
  int iterations = 0;
  bool converged = false;  ///< no point changed its part in the last iteration
};

/// k-means by Lloyd's iteration (Least squares quantization in PCM, 1982), at most
/// `most_iterations` of them, from the seeding of Arthur & Vassilvitskii (k-means++, 2007) with a
/// fixed random sequence. Means that cannot be nearest are passed over after Phillips (Acceleration
/// of k-means and related clustering algorithms, 2002), which changes nothing of the result. Throws
/// Error(usage) unless 1 <= count <= points.
KMeansParts kmeans_parts(std::span<const Vec3f> points, std::uint32_t count, int most_iterations);

}  // namespace meshhier::bench
