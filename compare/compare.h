// Measures how far a surface is from another one: the difference of two scans, or of a model and
// its scan.
#pragma once

#include "compare/distance_tally.h"
#include "compare/object_distances.h"
#include "compare/place_transform.h"
#include "compare/selected_surface.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/model_view.h"
#include "hierarchy/unit.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::comparing {

struct CompareOptions {
  /// The part of both hierarchies: all partitions; a level, or the finest one of a tree that is
  /// less deep; tiles by their error.
  SurfaceSelection selection{};
  bool is_signed = true;
  /// Bound each triangle by the one of `to` that is nearest to its middle: distances to it are
  /// convex. Else bounds are loose where distances are less than edges. Two more points a vertex.
  bool bounds_triangles = false;
  std::optional<double> tolerance{};     ///< >= 0
  std::optional<Unit> tolerance_unit{};  ///< none: the unit of the second surface's coordinates
  std::optional<PlaceTransform> transform{};  ///< moves the first surface before it is compared
  std::uint64_t memory_budget = 1U << 30;     ///< bytes
  std::filesystem::path output{};             ///< a PLY; empty: none
  std::size_t listed_objects = 20;  ///< the farthest objects of the first surface; 0: none
  std::filesystem::path scratch{};  ///< becomes a temporary file where objects exceed the memory
  std::vector<std::filesystem::path> inputs{};  ///< files and folders that stay, besides the two
  /// Takes the place of an output that is there.
  bool replace = false;
};

/// Returns whether there is a hierarchy rather than a mesh: false only for a regular file that is
/// no archive; true also for nothing at all, of which reading will say what is wrong. Throws
/// Error(io).
bool is_hierarchy_there(storage::FileSystem& files, const std::filesystem::path& path);

/// The place where a hierarchy is read.
struct ComparedPlace {
  storage::FileSystem& files;
  std::filesystem::path path;
  std::string name{};  ///< for people; empty: the path
};

/// The part of a hierarchy that is compared.
struct ComparedSurface {
  std::string name;
  std::uint64_t tiles = 0;
  std::uint64_t vertices = 0;  ///< places
  std::uint64_t triangles = 0;
  double error_bound = 0;  ///< the original surface is nowhere farther from this one, nor this one
                           ///< from that; units of `to`
};

struct SurfaceComparison {
  explicit SurfaceComparison(std::optional<double> limit) : tolerance(limit), distances(limit) {}

  ComparedSurface from, to;
  bool is_signed = false;
  std::optional<double> tolerance;
  std::uint64_t tiles_read = 0;  ///< tiles of `to`
  /// Weights are areas: a third of each triangle's for each of its corners. Without triangles all
  /// vertices weigh the same.
  DistanceTally distances;
  /// Vertices of `from` that no triangle uses: they are no part of its surface, unless it has no
  /// triangle at all.
  std::uint64_t lone_vertices = 0;
  std::uint64_t unknown_sides = 0;  ///< vertices nearest to a border of `to`, taken for outside
  double farthest = 0;              ///< the largest distance of a vertex, exact
  /// No point of the original surface of `from` is farther from that of `to`.
  double no_farther_than = 0;
  std::optional<ObjectComparison> objects;  ///< none: `from` has none, or none are listed
  std::vector<std::string> warnings;

  /// Returns whether all vertices are within the tolerance; true without one.
  bool is_within() const { return !tolerance || farthest <= *tolerance; }
};

/// Measures for each vertex of `from`, exactly (to double rounding), the distance to the nearest
/// point of `to`'s surface, in the coordinates of the inputs; inside of `to` (surface_sides.h) it
/// is negative. Only tiles of `to` that may be nearest are read, unless they are chosen by their
/// error. O(n log n) expected; memory stays about options.memory_budget.
///
/// The output has the compared vertices of `from`, where `from` has them, with the property
/// `distance`, and its triangles. It appears complete or not at all. `files`: the file system of
/// the output.
///
/// Deterministic to the bit for any threads. Throws Error(usage) if the level is in neither tree or
/// the tolerance is none or of a unit that cannot be converted, or the transform leads out of the
/// range of coordinates, Error(input) if `to` has no triangle, Error(io | corrupt | interrupted),
/// and as storage::OutputFile.
SurfaceComparison compare_surfaces(const ComparedPlace& from, const ComparedPlace& to,
                                   storage::FileSystem& files, const CompareOptions& options,
                                   execution::Progress& progress,
                                   const execution::CancelToken& cancel);

/// Returns how a hierarchy with the distances is shown: on both sides of 0 up to what 99 % of the
/// surface is within, or twice the tolerance where that is more; the tolerance as a band.
ModelView view_of(const SurfaceComparison& comparison);

/// Returns the comparison for people.
std::string comparison_text(const SurfaceComparison& comparison);
/// Returns the comparison for scripts, as docs/command_line.md describes it.
nlohmann::ordered_json comparison_json(const SurfaceComparison& comparison);

}  // namespace meshhier::comparing
