#include "compare/compare.h"

#include "base/error.h"
#include "compare/cut_surface.h"
#include "compare/difference_ply.h"
#include "compare/farthest_bound.h"
#include "compare/surface_distance.h"
#include "compare/surface_samples.h"
#include "compare/surface_sides.h"
#include "execution/parallel.h"
#include "mesh_io/coordinate_range.h"
#include "mesh_io/output_name.h"
#include "storage/format/archive.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::comparing {
namespace {

namespace fs = std::filesystem;

/// Vertices looked up together: enough to make the trees of their surroundings worth building.
constexpr std::size_t kBatchPoints = 65536;
/// Triangles that are bounded together.
constexpr std::size_t kBatchTriangles = 16384;
/// The memory of a comparison beside its caches, about: the program, a batch and the trees it is
/// looked up in, tiles on their way, sums.
constexpr std::uint64_t kFixedBytes = std::uint64_t{56} << 20;
/// Scans of one object are nearer to each other, as a rule.
constexpr double kFarPart = 0.05;

/// A hierarchy that is open.
struct Opened {
  explicit Opened(const ComparedPlace& place)
      : name(place.name.empty() ? place.path.string() : place.name),
        files(place.files, place.path),
        reader(files.files(), place.path) {}

  const BoundsD& box() const { return reader.manifest().source.bounds; }

  std::string name;
  storage::HierarchyFiles files;
  storage::HierarchyReader reader;
};

ComparedSurface facts_of(const Opened& opened, const CutSurface& surface) {
  ComparedSurface facts;
  facts.name = opened.name;
  facts.tiles = surface.size();
  facts.vertices = surface.place_count();
  facts.triangles = surface.total().triangles;
  facts.error_bound = error_bound(opened.reader, surface.cut());
  return facts;
}

/// Returns the memory that caches may have.
std::uint64_t spare_bytes(const CompareOptions& options) {
  return options.memory_budget - std::min(options.memory_budget, kFixedBytes);
}

std::vector<Vec3d> in_order(const std::vector<Vec3d>& points,
                            std::span<const std::uint32_t> order) {
  std::vector<Vec3d> sorted;
  sorted.reserve(points.size());
  for (const std::uint32_t i : order)
    sorted.push_back(points[i]);
  return sorted;
}

struct MeasuredTriangle {
  std::array<Vec3d, 3> corners;
  std::array<double, 3> distances{};
};

class Comparer {
 public:
  Comparer(const Opened& from, const Opened& to, const CompareOptions& options,
           execution::Progress& progress, const execution::CancelToken& cancel)
      : from_(from),
        to_(to),
        options_(options),
        progress_(progress),
        cancel_(cancel),
        surface_(from.reader, selected_cut(from.reader, options.selection),
                 spare_bytes(options) / 8),
        target_(selected_surface(to.reader, options.selection, spare_bytes(options) / 8, progress,
                                 cancel)),
        search_(target_, spare_bytes(options) / 2),
        result_(options.tolerance) {
    result_.from = facts_of(from_, surface_);
    result_.to = facts_of(to_, target_);
    result_.is_signed = options.is_signed;
    if (target_.total().triangles == 0)
      throw Error(ErrorCode::input, result_.to.name + " has no triangle to measure from");
  }

  SurfaceComparison run(DifferencePly* output, storage::FileSystem& files) {
    warn_of_places();
    if (options_.listed_objects > 0 && from_.reader.manifest().objects)
      objects_.emplace(files, options_.scratch, spare_bytes(options_) / 8);
    progress_.stage("compare", surface_.size(), "tiles");
    from_.reader.will_read(surface_.cut().nodes());
    execution::ordered_for(
        surface_.size(), tiles_in_flight(), cancel_,
        [&](std::size_t position) { return surface_.load_placed(position); },
        [&](std::size_t position, PlacedTile tile) {
          waiting_positions_.push_back(static_cast<std::uint32_t>(position));
          waiting_points_ += tile.places.size();
          waiting_.push_back(std::move(tile));
          if (waiting_points_ >= kBatchPoints)
            look_up(output);
        });
    look_up(output);
    finish();
    return std::move(result_);
  }

 private:
  void warn(std::string text) {
    progress_.warn(text);
    result_.warnings.push_back(std::move(text));
  }

  void warn_of_places() {
    const auto &mine = from_.reader.manifest().units, &theirs = to_.reader.manifest().units;
    if (mine && theirs && *mine != *theirs && !options_.transform) {
      warn(
          fmt::format("{} is in {}, {} in {}: numbers are compared as they are (--transform can "
                      "scale)",
                      result_.from.name, name_of(*mine), result_.to.name, name_of(*theirs)));
    }
    const BoundsD box = moved_box(options_.transform, from_.box());
    const bool are_there = !box.empty() && !to_.box().empty();
    if (const double gap = are_there ? std::sqrt(squared_gap(box, to_.box())) : 0; gap > 0) {
      warn(fmt::format("the boxes of the two are {:.6g} apart: nothing aligns them but --transform",
                       gap));
    }
  }

  std::vector<Vec3d> waiting_points() const {
    std::vector<Vec3d> points;
    points.reserve(waiting_points_);
    const Vec3d origin = from_.reader.manifest().origin, there = to_.reader.manifest().origin;
    for (const PlacedTile& tile : waiting_) {
      for (const Vec3f place : tile.places)
        points.push_back(moved(options_.transform, to_double(place) + origin) - there);
    }
    return points;
  }

  /// Returns the distances of points, in their order.
  std::vector<double> distances_of(const std::vector<Vec3d>& points, std::vector<Side>& sides,
                                   bool with_sides) {
    const std::vector<std::uint32_t> order = curve_order(points);
    const std::vector<Vec3d> sorted = in_order(points, order);
    const std::vector<NearestOnSurface> nearest = search_.nearest(sorted, cancel_);
    std::vector<Side> sorted_sides(points.size(), Side::outside);
    if (with_sides)
      sorted_sides = surface_sides(target_, search_.trees(), sorted, nearest, cancel_);
    std::vector<double> distances(points.size());
    sides.resize(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const double distance = std::sqrt(nearest[i].squared);
      distances[order[i]] = sorted_sides[i] == Side::inside ? -distance : distance;
      sides[order[i]] = sorted_sides[i];
    }
    return distances;
  }

  void look_up(DifferencePly* output) {
    const std::vector<Vec3d> points = waiting_points();
    std::vector<Side> sides;
    const std::vector<double> distances = distances_of(points, sides, options_.is_signed);
    std::size_t first = 0;
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      const PlacedTile& tile = waiting_[i];
      const std::size_t count = tile.places.size();
      if (objects_)
        objects_->add(waiting_positions_[i], tile, std::span(points).subspan(first, count),
                      std::span(distances).subspan(first, count));
      account(tile, std::span(points).subspan(first, count),
              std::span(distances).subspan(first, count), std::span(sides).subspan(first, count));
      if (output != nullptr)
        output->add(tile, std::span(distances).subspan(first, count));
      first += count;
      progress_.advance(1);
    }
    bound_triangles(points, distances);
    waiting_.clear();
    waiting_positions_.clear();
    waiting_points_ = 0;
  }

  /// Bounds the triangles of the waiting tiles.
  void bound_triangles(std::span<const Vec3d> points, std::span<const double> distances) {
    std::vector<MeasuredTriangle> loose;
    std::size_t first = 0;
    for (const PlacedTile& tile : waiting_) {
      for (const Triangle<std::uint32_t>& t : tile.triangles) {
        MeasuredTriangle measured;
        for (std::size_t i = 0; i < 3; ++i) {
          measured.corners[i] = points[first + t[i]];
          measured.distances[i] = std::abs(distances[first + t[i]]);
        }
        if (options_.bounds_triangles && !bound_.is_settled(measured.corners, measured.distances))
          loose.push_back(measured);
        else
          bound_.add(measured.corners, measured.distances);
        if (loose.size() == kBatchTriangles)
          bound_loose(loose);
      }
      first += tile.places.size();
    }
    bound_loose(loose);
  }

  /// Bounds triangles by the triangle of `to` that is nearest to their middle: the farthest point
  /// from that one is a corner.
  void bound_loose(std::vector<MeasuredTriangle>& loose) {
    std::vector<Vec3d> middles;
    for (const MeasuredTriangle& t : loose)
      middles.push_back((t.corners[0] + t.corners[1] + t.corners[2]) * (1.0 / 3));
    const std::vector<std::uint32_t> order = curve_order(middles);
    const std::vector<Vec3d> sorted = in_order(middles, order);
    std::vector<SurfaceTriangle> targets(sorted.size());
    const std::vector<NearestOnSurface> nearest = search_.nearest(
        sorted, cancel_, Ties::any,
        [&](std::size_t i, const ShownTriangle& triangle) { targets[i] = triangle.corners; });
    std::vector<double> most(loose.size());
    execution::parallel_for(block_count(loose.size()), [&](std::size_t block) {
      const std::size_t first = block * kSearchedPoints;
      for (std::size_t i = first; i < std::min(first + kSearchedPoints, most.size()); ++i) {
        for (const Vec3d corner : loose[order[i]].corners)
          most[i] = std::max(most[i], squared_distance(corner, targets[i]));
      }
    });
    for (std::size_t i = 0; i < loose.size(); ++i) {
      bound_.add(std::sqrt(nearest[i].squared));
      bound_.add(loose[order[i]].corners, loose[order[i]].distances, std::sqrt(most[i]));
    }
    loose.clear();
  }

  void account(const PlacedTile& tile, std::span<const Vec3d> points,
               std::span<const double> distances, std::span<const Side> sides) {
    std::vector<double> weights(points.size());
    for (const Triangle<std::uint32_t>& t : tile.triangles) {
      const Vec3d a = points[t[0]], b = points[t[1]], c = points[t[2]];
      const double third = length(cross(b - a, c - a)) / 6;
      for (const std::uint32_t corner : t)
        weights[corner] += third;
    }
    const bool is_cloud = result_.from.triangles == 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_own = i < tile.own_count;
      if (is_own && !is_cloud && !tile.is_used[i]) {
        ++result_.lone_vertices;
      } else if (is_own) {
        result_.farthest = std::max(result_.farthest, std::abs(distances[i]));
        bound_.add(std::abs(distances[i]));
        result_.unknown_sides += sides[i] == Side::unknown ? 1 : 0;
      }
      // Vertices of triangles without area weigh nothing; they can be the farthest ones.
      const double weight = is_cloud && is_own ? 1 : weights[i];
      if (weight > 0 || (is_own && tile.is_used[i]))
        result_.distances.add(distances[i], weight);
    }
  }

  void finish() {
    const auto measure = [&](const std::vector<Vec3d>& points) {
      std::vector<Side> sides;
      std::vector<double> distances = distances_of(points, sides, false);
      progress_.advance(distances.size());
      return distances;
    };
    progress_.stage("bound", 0, "points");
    result_.no_farther_than =
        bound_.refine(measure) + result_.from.error_bound + result_.to.error_bound;
    result_.tiles_read = search_.trees().tiles_read();
    if (objects_) {
      const auto from = from_.reader.open_objects();
      const auto to = to_.reader.manifest().objects ? to_.reader.open_objects() : nullptr;
      result_.objects =
          objects_->finish(*from, to.get(), options_.transform, options_.listed_objects, cancel_);
    }
    if (result_.distances.empty() || to_.box().empty())
      return;
    const double diagonal = length(to_.box().max - to_.box().min);
    const double middle = result_.distances.size_quantile(0.5);
    if (middle > kFarPart * diagonal) {
      warn(
          fmt::format("half of the surface is farther than {:.6g}, {:.0f} % of the size of {}: "
                      "nothing aligns the two but --transform",
                      middle, 100 * middle / diagonal, result_.to.name));
    }
  }

  const Opened& from_;
  const Opened& to_;
  const CompareOptions& options_;
  execution::Progress& progress_;
  const execution::CancelToken& cancel_;
  CutSurface surface_;
  CutSurface target_;
  SurfaceDistance search_;
  SurfaceComparison result_;
  std::optional<ObjectDistances> objects_;
  std::vector<PlacedTile> waiting_;
  std::vector<std::uint32_t> waiting_positions_;  ///< theirs, in the cut
  std::size_t waiting_points_ = 0;
  FarthestBound bound_;
};

/// Returns the tolerance in units of the coordinates of `to`.
std::optional<double> tolerance_in(const Opened& to, const CompareOptions& options) {
  const std::optional<Unit>& units = to.reader.manifest().units;
  if (!options.tolerance || !options.tolerance_unit)
    return options.tolerance;
  if (!units) {
    throw Error(ErrorCode::usage, fmt::format("the unit of {} is not known: give the tolerance "
                                              "without one, or build with \"units\"",
                                              to.name));
  }
  return *options.tolerance * metres_of(*options.tolerance_unit) / metres_of(*units);
}

void check_options(const Opened& from, const Opened& to, const CompareOptions& options) {
  if (options.tolerance && !(*options.tolerance >= 0 && std::isfinite(*options.tolerance)))
    throw Error(ErrorCode::usage, "the tolerance must be a number of at least 0");
  const auto* level = std::get_if<Level>(&options.selection);
  const BoundsD box = moved_box(options.transform, from.box());
  for (const Vec3d corner : {box.min, box.max}) {
    if (!box.empty() && !(mesh_io::is_coordinate(corner.x) && mesh_io::is_coordinate(corner.y) &&
                          mesh_io::is_coordinate(corner.z)))
      throw Error(ErrorCode::usage, "the transform leads out of the range of coordinates");
  }
  const Level deepest = std::max(from.reader.tree().depth(), to.reader.tree().depth());
  if (level != nullptr && *level > deepest) {
    throw Error(ErrorCode::usage,
                fmt::format("there is no level {}: the deepest is {}", raw(*level), raw(deepest)));
  }
}

}  // namespace

bool is_hierarchy_there(storage::FileSystem& files, const fs::path& path) {
  if (files.kind(path) != storage::FileKind::regular)
    return true;  // the reading will say what is wrong
  return storage::is_archive(*files.open(path));
}

SurfaceComparison compare_surfaces(const ComparedPlace& from, const ComparedPlace& to,
                                   storage::FileSystem& files, const CompareOptions& given,
                                   execution::Progress& progress,
                                   const execution::CancelToken& cancel) {
  const Opened opened_from(from), opened_to(to);
  check_options(opened_from, opened_to, given);
  CompareOptions options = given;
  options.tolerance = tolerance_in(opened_to, given);
  const auto check = [&] { cancel.check(); };
  std::unique_ptr<DifferencePly> output;
  if (!options.output.empty()) {
    if (!storage::is_standard_output(files, options.output))
      storage::require_outside(files, options.output);
    mesh_io::require_true_ending(options.output.string(), {".ply"},
                                 "compare writes .ply, .hier and .3tz; choose one of these");
    storage::OutputRequest request{options.output, options.replace, options.inputs};
    request.inputs.insert(request.inputs.end(), {from.path, to.path});
    output = std::make_unique<DifferencePly>(files, request, spare_bytes(options) / 8, check);
  }
  SurfaceComparison comparison =
      Comparer(opened_from, opened_to, options, progress, cancel).run(output.get(), files);
  if (output) {
    output->write(opened_from.reader.manifest().origin,
                  fmt::format("meshhier compare: distance to {}", comparison.to.name), check);
  }
  return comparison;
}

}  // namespace meshhier::comparing
