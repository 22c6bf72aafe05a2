#include "bench/relief_surface.h"

#include "base/error.h"
#include "bench/block_writer.h"
#include "bench/require_range.h"

#include <cmath>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

/// Cycles of the coarsest relief along half the shape's thickness: a few large forms, as a statue
/// has.
constexpr double kFirstFrequency = 1.5;
/// More octaves than the step of 2^32 vertices can show.
constexpr int kMaxOctaves = 20;
/// Apart from the random sequence of the relief.
constexpr std::uint64_t kNoiseStream = 0x6e6f697365;
const SurfaceOptions& checked(const SurfaceOptions& options) {
  require_range("height", options.height, 0, 0.9);
  require_range("roughness", options.roughness, 0, 0.9);
  require_range("noise", options.noise, 0, 1);
  for (const double part : {options.offset.x, options.offset.y, options.offset.z})
    require_range("offset", part, -1e12, 1e12);
  return options;
}

/// The least n with 2 n^2 patches >= triangles.
std::uint32_t cells_for(std::uint64_t triangles, std::size_t patches) {
  // A closed surface has about half as many vertices as triangles: 2^33 of them always suffice.
  constexpr std::uint64_t kMostTriangles = std::uint64_t{1} << 33;
  if (triangles < 1 || triangles > kMostTriangles) {
    throw Error(ErrorCode::usage,
                fmt::format("triangles must be from 1 to {}, found {}", kMostTriangles, triangles));
  }
  std::uint32_t cells = 1;
  for (std::uint32_t step = 1u << 16; step > 0; step /= 2) {
    const std::uint64_t tried = std::uint64_t{cells} + step;
    if (2 * (tried - 1) * (tried - 1) * patches < triangles)
      cells += step;
  }
  return cells;
}

FractalOptions relief_options(const SurfaceOptions& options, double thickness, double step) {
  FractalOptions relief;
  relief.seed = options.seed;
  relief.gain = options.roughness;
  // The octaves' heights are a geometric series that sums up to the whole.
  relief.height = options.height * thickness * (1 - options.roughness);
  relief.frequency = kFirstFrequency / thickness;
  // The finest wave is at least two steps long; shorter ones the grid cannot show.
  relief.octaves = 0;
  for (double wave = 1 / relief.frequency; wave >= 2 * step && relief.octaves < kMaxOctaves;
       wave /= 2)
    ++relief.octaves;
  return relief;
}

}  // namespace

CellTriangles triangles_of(PatchPoint cell) {
  const PatchPoint right{cell.patch, cell.column + 1, cell.row};
  const PatchPoint above{cell.patch, cell.column, cell.row + 1};
  const PatchPoint across{cell.patch, cell.column + 1, cell.row + 1};
  if (is_cut_upwards(cell))
    return {{{cell, right, across}, {cell, across, above}}};
  return {{{cell, right, above}, {right, across, above}}};
}

std::string description_of(const SurfaceOptions& options) {
  return fmt::format("{}, seed {}, height {}, roughness {}, noise {}", name_of(options.shape),
                     options.seed, options.height, options.roughness, options.noise);
}

ReliefSurface::ReliefSurface(const SurfaceOptions& options)
    : options_(checked(options)),
      base_(options.shape),
      grid_(base_.patches(), cells_for(options.triangles, base_.patches().faces.size())),
      step_(base_.patch_size() / grid_.cells()),
      relief_(relief_options(options, base_.thickness(), step_)) {
  if (grid_.vertex_count() > 0xffffffffu) {
    throw Error(ErrorCode::usage,
                fmt::format("triangles: {} need {} vertices, more than 2^32 - 1; ask for fewer",
                            grid_.triangle_count(), grid_.vertex_count()));
  }
}

ReliefVertex ReliefSurface::vertex(PatchPoint at, std::uint64_t index) const {
  const double cells = grid_.cells();
  const SurfacePoint base = base_.at(at.patch, at.column / cells, at.row / cells);
  const NoiseSample relief = relief_.at(base.position);
  const double noise =
      options_.noise * step_ * signed_unit(random_at(options_.seed ^ kNoiseStream, index));
  return {base, relief.gradient, base.position + base.normal * (relief.value + noise)};
}

Vec3d ReliefSurface::stored(const ReliefVertex& vertex) const {
  const Vec3d placed = vertex.moved + options_.offset;
  return options_.double_coordinates ? placed : rounded_to_float(placed);
}

void ReliefSurface::visit_vertices(const std::function<void(const ReliefVertex&)>& visit) const {
  std::uint64_t index = 0;
  for (std::uint32_t patch = 0; patch < grid_.patch_count(); ++patch) {
    for (std::uint32_t row = 0; row <= grid_.cells(); ++row) {
      for (std::uint32_t column = 0; column <= grid_.cells(); ++column) {
        if (grid_.is_owned({patch, column, row}))
          visit(vertex({patch, column, row}, index++));
      }
    }
  }
}

}  // namespace meshhier::bench
