// How far a surface is from another one, object by object.
//
// Problem. A mesh may have millions of objects, each in several tiles.
// Idea. Each tile adds up what its triangles tell of an object; the sums are sorted by object, out
// of core, and joined. Of all objects only the farthest are kept.
//
//     tile 0   (bone 1: area, sums)  (bone 2: ...)        bone 1: tile 0, tile 1   -> 0.3 mm
//     tile 1   (bone 1: ...)                        ->    bone 2: tile 0           -> 2.1 mm
//
// Invariant. Sums are added by tile: neither threads nor memory show in the result.
// Cost. 56 bytes for each object of a tile.
#pragma once

#include "compare/cut_surface.h"
#include "compare/place_transform.h"
#include "partition/external_sort.h"
#include "storage/format/object_table.h"
#include "storage/io/file.h"
#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace meshhier::comparing {

/// Distances of the corners of an object's triangles, each with a third of the triangle's area.
struct DistanceSums {
  double area = 0, sum = 0, sum_of_sizes = 0, sum_of_squares = 0;
  double least = 0, largest = 0;

  double mean() const { return area > 0 ? sum / area : 0; }
  double mean_size() const { return area > 0 ? sum_of_sizes / area : 0; }
  double rms() const;
  /// Returns the largest distance without its sign.
  double farthest() const;
};

/// An object of the first surface.
struct ObjectDistance {
  std::uint32_t object = 0;
  std::string name{};
  DistanceSums distances{};
  std::optional<double> other_area{};  ///< in the input, of the second one's object of that name
  std::optional<double> moved{};       ///< between the middles of the two boxes
};

/// Objects of one surface whose names the other one's do not have.
struct LoneObjects {
  std::uint32_t objects = 0;  ///< all of the surface's
  std::uint32_t lone = 0;
  std::vector<std::string> names{};  ///< the first ones
};

struct ObjectComparison {
  std::uint32_t compared = 0;              ///< objects that the first surface shows
  std::vector<ObjectDistance> farthest{};  ///< the farthest first
  LoneObjects from{};
  std::optional<LoneObjects> to{};  ///< none: the second one has no objects
};

/// For one thread.
class ObjectDistances {
 public:
  /// `scratch`: made where sums exceed the memory.
  ObjectDistances(storage::FileSystem& files, const std::filesystem::path& scratch,
                  std::uint64_t memory_bytes)
      : pool_(memory_bytes / 4),
        scratch_(files, scratch, pool_),
        sums_(scratch_, memory_bytes / 2) {}

  /// Adds a tile, whose triangles have objects; `points` and `distances`: of its places.
  void add(std::uint32_t position, const PlacedTile& tile, std::span<const Vec3d> points,
           std::span<const double> distances);
  /// Returns the `most` farthest objects. Called once. `to`: null if it has no objects. Throws
  /// Error(io | corrupt | interrupted).
  ObjectComparison finish(const storage::ObjectTable& from, const storage::ObjectTable* to,
                          const std::optional<PlaceTransform>& transform, std::size_t most,
                          const execution::CancelToken& cancel);

 private:
  struct ObjectTileSums {
    std::uint32_t object = 0, tile = 0;
    DistanceSums distances;
  };
  struct Order {
    std::pair<std::uint32_t, std::uint32_t> operator()(const ObjectTileSums& sums) const {
      return {sums.object, sums.tile};
    }
  };

  std::vector<ObjectDistance> farthest(std::size_t most, std::uint32_t& compared);

  storage::MemoryPool pool_;
  storage::ScratchFile scratch_;
  partition::ExternalSort<ObjectTileSums, Order> sums_;
};

}  // namespace meshhier::comparing
