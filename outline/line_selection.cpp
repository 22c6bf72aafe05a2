#include "outline/line_selection.h"

#include <algorithm>
#include <numeric>

namespace meshhier::outline {
namespace {

bool fits(const OutlineOptions& options, std::size_t vertices, std::size_t polylines) {
  return !options.file_bytes ||
         options.file_bytes(vertices, vertices - polylines) <= options.max_bytes;
}

/// How many of `order` fit with a tolerance in input units.
std::size_t count_that_fit(const Lines& lines, std::span<const std::uint32_t> order,
                           const OutlineOptions& options, double tolerance) {
  std::size_t vertices = 0, count = 0;
  for (; count < order.size(); ++count) {
    vertices += lines.vertex_count(order[count], tolerance);
    if (!fits(options, vertices, count + 1))
      break;
  }
  return count;
}

}  // namespace

Lines::Lines(const Network& network, double least, double crease)
    : positions_(network.positions()), chains_(trace_chains(network.count(), network.segments())) {
  add_long_ones(trace_chains(network.count(), network.creases()), crease);
  significance_.reserve(chains_.nodes.size());
  for (std::size_t chain = 0; chain < chains_.size(); ++chain) {
    const std::span<const std::uint32_t> nodes = chains_[chain];
    const std::vector<Vec3f> points = points_of(nodes);
    const std::vector<double> values = significance(points, nodes.front() == nodes.back(), least);
    lengths_.push_back(length_of(points));
    significance_.insert(significance_.end(), values.begin(), values.end());
  }
}

std::size_t Lines::vertex_count(std::size_t chain, double tolerance) const {
  const auto begin = significance_.begin() + chains_.starts[chain];
  const auto end = significance_.begin() + chains_.starts[chain + 1];
  return static_cast<std::size_t>(
      std::count_if(begin, end, [&](double value) { return value > tolerance; }));
}

void Lines::append_to(Outline& outline, std::size_t chain, double tolerance) const {
  for (std::uint32_t i = chains_.starts[chain]; i < chains_.starts[chain + 1]; ++i) {
    if (significance_[i] > tolerance)
      outline.vertices.push_back(positions_[chains_.nodes[i]]);
  }
  outline.starts.push_back(static_cast<std::uint32_t>(outline.vertices.size()));
}

std::vector<std::uint32_t> Lines::by_length() const {
  std::vector<std::uint32_t> order(size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [this](std::uint32_t a, std::uint32_t b) { return lengths_[a] > lengths_[b]; });
  return order;
}

std::vector<Vec3f> Lines::points_of(std::span<const std::uint32_t> nodes) const {
  std::vector<Vec3f> points;
  points.reserve(nodes.size());
  for (const std::uint32_t node : nodes)
    points.push_back(positions_[node]);
  return points;
}

void Lines::add_long_ones(const Chains& creases, double least) {
  for (std::size_t chain = 0; chain < creases.size(); ++chain) {
    if (length_of(points_of(creases[chain])) < least)
      continue;
    chains_.nodes.insert(chains_.nodes.end(), creases[chain].begin(), creases[chain].end());
    chains_.starts.push_back(static_cast<std::uint32_t>(chains_.nodes.size()));
  }
}

Selection select(const Lines& lines, const OutlineOptions& options) {
  const std::vector<std::uint32_t> order = lines.by_length();
  for (double tolerance = options.tolerance;;
       tolerance = std::min(2 * tolerance, kCoarsestTolerance)) {
    const double distance = tolerance * options.diagonal;
    const std::size_t count = count_that_fit(lines, order, options, distance);
    const bool only_specks_left =
        count == order.size() || lines.length(order[count]) < kSpeckLength * distance;
    if (!only_specks_left && tolerance < kCoarsestTolerance)
      continue;
    Selection result{{order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count)},
                     tolerance};
    std::sort(result.chains.begin(), result.chains.end());
    return result;
  }
}

}  // namespace meshhier::outline
