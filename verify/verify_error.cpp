#include "verify/verify_error.h"

#include "base/error.h"
#include "compare/cut_surface.h"
#include "compare/surface_distance.h"
#include "compare/surface_samples.h"
#include "execution/parallel.h"
#include "export/cut_file.h"
#include "hierarchy/cut.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;

/// Samples drawn from a tile at a time, and looked up together: enough to make the trees of their
/// surroundings worth building, 10 MiB in all.
constexpr std::uint64_t kDrawnSamples = 65536;
constexpr std::size_t kBatchSamples = 131072;
/// Positions and bounds are floats, rounded by up to 2^-24 of the coordinate in each axis at every
/// level, and measured in doubles. 1e-6 of the largest coordinate is 17 such roundings.
constexpr double kRounding = 1e-6;
/// Means are less by far: half of it in each axis at each level, most of which evens out.
constexpr double kMeanRounding = 0x1p-24;
/// An error is an estimate of the root of the mean square, counted by vertices, or by area if that
/// is far more: means by area are a half of it as a rule.
constexpr double kMostMean = 2;

/// Streams of random numbers: samples of the two surfaces must not be alike.
constexpr std::uint64_t kForwardStream = 1;
constexpr std::uint64_t kBackwardStream = 2;

/// The means that all measurements share.
struct MeasureJob {
  const storage::HierarchyReader& reader;
  const ErrorOptions& options;
  const comparing::CutSurface& original;
  comparing::SurfaceDistance& to_original;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
};

/// Samples of one surface, each with the position of the shown tile that answers for it.
struct Samples {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> owners;

  void append(const Samples& more) {
    points.insert(points.end(), more.points.begin(), more.points.end());
    owners.insert(owners.end(), more.owners.begin(), more.owners.end());
  }
};

Samples along_curve(const Samples& samples) {
  Samples sorted;
  sorted.points.reserve(samples.points.size());
  sorted.owners.reserve(samples.points.size());
  for (std::uint32_t i : comparing::curve_order(samples.points)) {
    sorted.points.push_back(samples.points[i]);
    sorted.owners.push_back(samples.owners[i]);
  }
  return sorted;
}

/// Sums up the distances in one direction.
struct DistanceTally {
  explicit DistanceTally(std::size_t tiles) : tile_max(tiles) {}

  /// `told`: the owner's own error.
  void add(double distance, std::uint32_t owner, float told) {
    ++count;
    sum_of_errors += double{told};
    sum += distance;
    sum_of_squares += distance * distance;
    tile_max[owner] = std::max(tile_max[owner], distance);
  }
  DistanceSummary summary() const {
    if (count == 0)
      return {};
    const double n = static_cast<double>(count);
    return {sum / n, std::sqrt(sum_of_squares / n),
            *std::max_element(tile_max.begin(), tile_max.end())};
  }

  /// Returns a mean that the whole surface's is hardly below: few samples of a surface whose
  /// largest distances lie at a small part of it may show too much of that part.
  double least_mean() const {
    constexpr double kDeviations = 3;
    if (count == 0)
      return 0;
    const double n = static_cast<double>(count), mean = sum / n;
    const double variance = std::max(0.0, sum_of_squares / n - mean * mean);
    return mean - kDeviations * std::sqrt(variance / n);
  }

  /// Returns the mean of the tiles' errors, to be compared with summary().mean.
  double mean_error() const { return count == 0 ? 0 : sum_of_errors / static_cast<double>(count); }

  std::uint64_t count = 0;
  double sum_of_errors = 0;
  double sum = 0;
  double sum_of_squares = 0;
  std::vector<double> tile_max;  ///< the largest distance for each tile of the shown cut
};

/// The position in the shown cut of the tile that shows the tile at a position of the sampled one.
using ShownTile = std::function<std::size_t(std::uint32_t)>;

/// Sampled surface, and whose bound holds where.
struct Direction {
  const comparing::CutSurface& sampled;
  comparing::SurfaceDistance& target;
  ShownTile shown_tile;
  std::uint64_t stream = 0;
};

/// Tells which tile answers for each triangle of a tile.
class Owners {
 public:
  Owners(const MeasureJob& job, const Cut& shown, const Direction& direction, std::size_t position,
         const comparing::TileSurface& tile)
      : reader_(job.reader), shown_(shown), direction_(direction), tile_(tile) {
    own_ = static_cast<std::uint32_t>(direction.shown_tile(static_cast<std::uint32_t>(position)));
  }

  std::uint32_t operator()(std::uint32_t triangle) const {
    std::uint32_t owner = own_;
    if (triangle < tile_.facts.interior_count)
      return owner;
    for (std::uint32_t position : tile_.touched[triangle - tile_.facts.interior_count]) {
      const auto other = static_cast<std::uint32_t>(direction_.shown_tile(position));
      if (bound(other) > bound(owner))
        owner = other;
    }
    return owner;
  }

 private:
  float bound(std::uint32_t position) const { return reader_.record(shown_[position]).bound; }

  const storage::HierarchyReader& reader_;
  const Cut& shown_;
  const Direction& direction_;
  const comparing::TileSurface& tile_;
  std::uint32_t own_ = 0;
};

/// A tile's samples, or part of them: a coarse tile may have very many.
struct Portion {
  std::size_t position = 0;
  comparing::SampleRange range;
};

std::vector<Portion> portions_of(const comparing::CutSurface& surface,
                                 const comparing::SurfaceSampler& sampler) {
  std::vector<Portion> portions;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const comparing::SampleRange all = sampler.on_tile(i);
    for (std::uint64_t k = all.begin; k < all.end; k += kDrawnSamples)
      portions.push_back({i, {k, std::min(k + kDrawnSamples, all.end)}});
  }
  return portions;
}

Samples draw_samples(const MeasureJob& job, const Cut& shown, const Direction& direction,
                     const comparing::SurfaceSampler& sampler, const Portion& portion) {
  const comparing::TileSurface tile = direction.sampled.load(portion.position);
  const Owners owners(job, shown, direction, portion.position, tile);
  Samples samples;
  samples.points.reserve(portion.range.size());
  samples.owners.reserve(portion.range.size());
  for (const comparing::SurfaceSample& sample :
       sampler.draw(portion.position, tile, portion.range)) {
    samples.points.push_back(sample.point);
    samples.owners.push_back(owners(sample.triangle));
  }
  return samples;
}

DistanceTally measure(const MeasureJob& job, const Cut& shown, const Direction& direction) {
  const comparing::SurfaceSampler sampler(direction.sampled, job.options.samples, direction.stream);
  const std::vector<Portion> portions = portions_of(direction.sampled, sampler);
  DistanceTally tally(shown.size());
  Samples waiting;
  const auto look_up = [&] {
    const Samples sorted = along_curve(waiting);
    const std::vector<double> distances = direction.target.distances(sorted.points, job.cancel);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const std::uint32_t owner = sorted.owners[i];
      tally.add(distances[i], owner, job.reader.record(shown[owner]).error);
    }
    job.progress.advance(distances.size());
    waiting = {};
  };
  execution::ordered_for(
      portions.size(), comparing::tiles_in_flight(), job.cancel,
      [&](std::size_t i) { return draw_samples(job, shown, direction, sampler, portions[i]); },
      [&](std::size_t, const Samples& samples) {
        waiting.append(samples);
        if (waiting.points.size() >= kBatchSamples)
          look_up();
      });
  look_up();
  return tally;
}

double largest_coordinate(const Bounds& box) {
  if (box.empty())
    return 0;
  const auto largest = [](Vec3f v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  };
  return std::max(largest(box.min), largest(box.max));
}

/// Returns how far rounding alone may make a distance wrong.
double slack_of(const MeasureJob& job, const comparing::CutSurface& shown) {
  return kRounding * std::max(largest_coordinate(job.original.total().bounds),
                              largest_coordinate(shown.total().bounds));
}

/// Returns how far rounding alone may make a mean wrong: vertices are rounded at each level above
/// the partitions.
double mean_slack_of(const MeasureJob& job, const comparing::CutSurface& shown) {
  int steps = 1;
  for (const NodeId node : shown.cut().nodes())
    steps = std::max(steps, raw(job.reader.tree().depth()) - raw(node.level));
  return steps * kMeanRounding / kRounding * slack_of(job, shown);
}

/// Bounds and errors hold to the input; quantized partitions, the original here, are so far away.
double rounding_of(const MeasureJob& job) {
  const auto& quantization = job.reader.manifest().quantization;
  return quantization ? quantization->worst_rounding : 0;
}

/// Holds the measured means against the tiles' errors.
void check_errors(const MeasureJob& job, const comparing::CutSurface& shown,
                  const DistanceTally& forward, const DistanceTally& backward,
                  ErrorMeasurement& result) {
  for (const DistanceTally* tally : {&forward, &backward}) {
    const double told = tally->mean_error();
    result.error = std::max(result.error, told);
    if (tally->least_mean() <= kMostMean * told + rounding_of(job) + mean_slack_of(job, shown))
      continue;
    result.problems.push_back(fmt::format(
        "{}: {} is off by {:.6g} on average, more than twice the {:.6g} that its tiles' errors say",
        job.reader.directory().string(), result.name, tally->summary().mean, told));
    return;
  }
}

/// Holds the measured maxima of every tile against its bound.
void check_bounds(const MeasureJob& job, const comparing::CutSurface& shown,
                  const DistanceTally& forward, const DistanceTally& backward,
                  ErrorMeasurement& result) {
  const double slack = slack_of(job, shown);
  const double rounding = rounding_of(job);
  std::vector<double> ratios;
  ProblemList problems;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double bound = job.reader.record(shown.cut()[i]).bound;
    const double measured = std::max(forward.tile_max[i], backward.tile_max[i]);
    if (measured > slack)
      ratios.push_back(bound / measured);
    if (measured <= bound + rounding + slack)
      continue;
    problems.add(fmt::format(
        "{}: {:.6g} measured {}, its bound is {:.6g}",
        storage::tile_path(job.reader.directory(), shown.cut()[i]).string(), measured,
        forward.tile_max[i] >= backward.tile_max[i] ? "from the original surface to what is shown"
                                                    : "from what it shows to the original surface",
        bound));
  }
  result.problems = problems.take();
  if (ratios.empty())
    return;
  std::sort(ratios.begin(), ratios.end());
  // The nearest rank: so many of 100 tiles have at most this.
  const auto percentile = [&](std::size_t percent) {
    return ratios[(ratios.size() * percent + 99) / 100 - 1];
  };
  result.ratio = BoundRatio{percentile(50), percentile(95)};
}

double source_diagonal(const storage::HierarchyReader& reader) {
  const BoundsD& box = reader.manifest().source.bounds;
  return box.empty() ? 0 : length(box.max - box.min);
}

/// Samples both surfaces, which have triangles.
void measure_both_ways(const MeasureJob& job, const comparing::CutSurface& shown,
                       ErrorMeasurement& result) {
  comparing::SurfaceDistance to_shown(shown, job.options.memory_budget / 4);
  const auto shown_partition = [&](std::uint32_t partition) {
    return shown.cut().position_of(static_cast<PartitionId>(partition));
  };
  const auto itself = [](std::uint32_t position) { return position; };
  job.progress.stage("error", 2 * job.options.samples, "samples");
  const DistanceTally forward =
      measure(job, shown.cut(), {job.original, to_shown, shown_partition, kForwardStream});
  const DistanceTally backward =
      measure(job, shown.cut(), {shown, job.to_original, itself, kBackwardStream});
  result.forward = forward.summary();
  result.backward = backward.summary();
  check_bounds(job, shown, forward, backward, result);
  check_errors(job, shown, forward, backward, result);
}

ErrorMeasurement measure_cut(const MeasureJob& job, Cut cut, std::string name,
                             std::optional<Level> level) {
  job.progress.stage("read", cut.size(), "tiles");
  const comparing::CutSurface shown(job.reader, std::move(cut), job.options.memory_budget / 8,
                                    job.progress, job.cancel);
  ErrorMeasurement result;
  result.level = level;
  result.name = std::move(name);
  result.tiles = shown.size();
  result.triangles = shown.total().triangles;
  result.flat = shown.total().flat;
  result.diagonal = source_diagonal(job.reader);
  result.samples = job.options.samples;
  for (NodeId node : shown.cut().nodes())
    result.bound = std::max(result.bound, double{job.reader.record(node).bound});
  const std::uint64_t originals = job.original.total().triangles;
  if (shown.total().triangles > 0 && originals > 0) {
    measure_both_ways(job, shown, result);
  } else if (originals > 0) {
    result.problems.push_back(
        fmt::format("{}: {} shows no triangle, the original has {}: there is "
                    "no distance to measure",
                    job.reader.directory().string(), result.name, originals));
  }
  return result;
}

/// Returns the expected times of the stages, as measured for a scan of 54 partitions.
std::vector<execution::ExpectedStage> expected_times(const Tree& tree, const ErrorOptions& options,
                                                     const std::optional<Cut>& cut) {
  std::vector<execution::ExpectedStage> times{
      {"original", "partitions", 0, tree.partition_count() * 0.8e-3}};
  const auto add_measured = [&](std::size_t tiles) {
    times.push_back({"read", "tiles", 0, static_cast<double>(tiles) * 0.6e-3});
    times.push_back({"error", "samples", 0, 2.0 * static_cast<double>(options.samples) * 1.5e-6});
  };
  if (cut)
    add_measured(cut->size());
  else if (const auto* level = std::get_if<Level>(&options.selection))
    add_measured(tree.node_count(*level));
  else
    for (Level each = tree.root().level; each < tree.depth(); each = finer(each))
      add_measured(tree.node_count(each));
  return times;
}

ErrorMeasurement measure_level(const MeasureJob& job, Level level) {
  return measure_cut(job, Cut::of_level(job.reader.tree(), level),
                     fmt::format("level {}", raw(level)), level);
}

}  // namespace

std::vector<ErrorMeasurement> measure_errors(storage::FileSystem& files, const fs::path& directory,
                                             const ErrorOptions& options,
                                             execution::Progress& progress,
                                             const execution::CancelToken& cancel) {
  const storage::HierarchyFiles place(files, directory);
  const storage::HierarchyReader reader(place.files(), directory);
  const Tree& tree = reader.tree();
  std::optional<Cut> cut;  // read first: errors of the selection are told before the work begins
  if (const auto* level = std::get_if<Level>(&options.selection))
    require_level(tree, *level);
  if (const auto* path = std::get_if<fs::path>(&options.selection))
    cut = exporting::read_cut(files, tree, *path);

  progress.expect(expected_times(tree, options, cut));
  progress.stage("original", tree.partition_count(), "partitions");
  const comparing::CutSurface original(reader, Cut::of_level(tree, tree.depth()),
                                       options.memory_budget / 16, progress, cancel);
  comparing::SurfaceDistance to_original(original, options.memory_budget / 4);
  const MeasureJob job{reader, options, original, to_original, progress, cancel};

  std::vector<ErrorMeasurement> results;
  if (cut) {
    const fs::path& path = std::get<fs::path>(options.selection);
    results.push_back(measure_cut(job, std::move(*cut), "cut " + path.string(), std::nullopt));
  } else if (const auto* level = std::get_if<Level>(&options.selection)) {
    results.push_back(measure_level(job, *level));
  } else {
    for (Level each = tree.root().level; each < tree.depth(); each = finer(each))
      results.push_back(measure_level(job, each));
  }
  return results;
}

}  // namespace meshhier::verifying
