#include "outline/line_selection.h"

#include <algorithm>
#include <numeric>

namespace meshhier::outline {
namespace {

/// Counts of chosen lines, which tell their size in a file.
struct Taken {
  std::size_t vertices = 0, lines = 0;

  bool fits(const OutlineOptions& options, std::size_t max_bytes) const {
    return !options.file_bytes || options.file_bytes(vertices, vertices - lines) <= max_bytes;
  }
};

/// Adds lines of `order` to `taken` with a tolerance in input units, as long as all fits. Returns
/// how many.
std::size_t take(Lines& lines, std::span<const std::uint32_t> order, const OutlineOptions& options,
                 double tolerance, std::size_t max_bytes, Taken& taken) {
  for (std::size_t count = 0; count < order.size(); ++count) {
    const Taken more{taken.vertices + lines.vertex_count(order[count], tolerance), taken.lines + 1};
    if (!more.fits(options, max_bytes))
      return count;
    taken = more;
  }
  return order.size();
}

}  // namespace

Lines::Lines(Network& network, double least, double shortest)
    : positions_(network.positions()),
      chains_(trace_chains(network.count(), network.take_segments())),
      form_begin_(chains_.size()),
      least_(least) {
  add_forms(trace_chains(network.count(), network.take_forms()), shortest);
  lengths_.reserve(chains_.size());
  for (std::size_t chain = 0; chain < chains_.size(); ++chain)
    lengths_.push_back(length_of(points_of(chains_[chain])));
}

const std::vector<double>& Lines::significance_of(std::size_t chain) {
  const auto [found, is_new] = significance_.try_emplace(chain);
  if (is_new) {
    const std::span<const std::uint32_t> nodes = chains_[chain];
    found->second = significance(points_of(nodes), nodes.front() == nodes.back(), least_);
  }
  return found->second;
}

std::size_t Lines::vertex_count(std::size_t chain, double tolerance) {
  return static_cast<std::size_t>(std::ranges::count_if(
      significance_of(chain), [&](double value) { return value > tolerance; }));
}

void Lines::append_to(Outline& outline, std::size_t chain, double tolerance) {
  const std::vector<double>& values = significance_of(chain);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] > tolerance)
      outline.vertices.push_back(positions_[chains_[chain][i]]);
  }
  outline.starts.push_back(static_cast<std::uint32_t>(outline.vertices.size()));
}

std::vector<std::uint32_t> Lines::by_length() const {
  std::vector<std::uint32_t> order(size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
    return lengths_[a] != lengths_[b] ? lengths_[a] > lengths_[b] : a < b;
  });
  return order;
}

std::vector<Vec3f> Lines::points_of(std::span<const std::uint32_t> nodes) const {
  std::vector<Vec3f> points;
  points.reserve(nodes.size());
  for (const std::uint32_t node : nodes)
    points.push_back(positions_[node]);
  return points;
}

void Lines::add_forms(const Chains& forms, double shortest) {
  for (std::size_t chain = 0; chain < forms.size(); ++chain) {
    if (length_of(points_of(forms[chain])) < shortest)
      continue;
    chains_.nodes.insert(chains_.nodes.end(), forms[chain].begin(), forms[chain].end());
    chains_.starts.push_back(static_cast<std::uint32_t>(chains_.nodes.size()));
  }
}

Selection select(Lines& lines, const OutlineOptions& options) {
  std::vector<std::uint32_t> order = lines.by_length();
  const auto others_begin = std::stable_partition(
      order.begin(), order.end(), [&](std::uint32_t chain) { return lines.is_form(chain); });
  const std::span<const std::uint32_t> forms(order.begin(), others_begin);
  const std::span<const std::uint32_t> others(others_begin, order.end());
  Selection result;
  Taken by_forms;
  const std::size_t form_count = take(lines, forms, options, options.tolerance * options.diagonal,
                                      options.max_bytes / 2, by_forms);
  result.chains.assign(forms.begin(), forms.begin() + static_cast<std::ptrdiff_t>(form_count));
  for (double tolerance = options.tolerance;;
       tolerance = std::min(2 * tolerance, kCoarsestTolerance)) {
    const double distance = tolerance * options.diagonal;
    Taken taken = by_forms;
    const std::size_t count = take(lines, others, options, distance, options.max_bytes, taken);
    const bool only_specks_left =
        count == others.size() || lines.length(others[count]) < kSpeckLength * distance;
    if (!only_specks_left && tolerance < kCoarsestTolerance)
      continue;
    result.chains.insert(result.chains.end(), others.begin(),
                         others.begin() + static_cast<std::ptrdiff_t>(count));
    std::sort(result.chains.begin(), result.chains.end());
    result.tolerance = tolerance;
    return result;
  }
}

}  // namespace meshhier::outline
