#include "pipeline/source_mesh.h"

#include "hierarchy/error.h"
#include "partition/top_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

constexpr std::size_t kBlock = mesh_io::MeshSource::kBlockSize;

bool fits_float(Vec3d p) {
  constexpr double kMost = std::numeric_limits<float>::max();
  const bool in_range = std::abs(p.x) <= kMost && std::abs(p.y) <= kMost && std::abs(p.z) <= kMost;
  return in_range && to_double(to_float(p)) == p;
}

/// The coordinate nearest to the middle that is a multiple of a power of two about a thousandth of
/// the extent: it has few digits, and what is left of the coordinates is small.
double round_origin(double low, double high) {
  const double extent = std::max(high - low, std::abs(high) * 1e-6);
  if (!(extent > 0) || !std::isfinite(extent))
    return 0;
  const double grid = std::exp2(std::ceil(std::log2(extent)) - 10);
  const double origin = std::round((low / 2 + high / 2) / grid) * grid;
  return std::isfinite(origin) ? origin : 0;
}

}  // namespace

SourceMesh::SourceMesh(std::unique_ptr<mesh_io::MeshSource> source, std::string file_name,
                       storage::ScratchFile& scratch, Progress& progress, const CancelToken& cancel)
    : source_(std::move(source)),
      spooled_positions_(scratch, 1 << 18),
      spooled_attributes_(scratch, 1 << 18) {
  const mesh_io::MeshDescription& description = source_->description();
  summary_.file_name = std::move(file_name);
  summary_.file_bytes = description.file_bytes;
  summary_.vertices = description.vertex_count;
  summary_.attributes = description.attributes;
  scan(progress, cancel);
  choose_origin();
}

void SourceMesh::scan(Progress& progress, const CancelToken& cancel) {
  progress.stage("ingest", summary_.vertices, "vertices");
  sample_positions_.reserve(partition::SampleIds(summary_.vertices).count());
  source_->read_vertices([&](const mesh_io::VertexBlock& block) {
    cancel.check();
    scan_block(block);
    progress.advance(std::max(block.positions.size(), block.exact.size()));
  });
}

void SourceMesh::scan_block(const mesh_io::VertexBlock& block) {
  const bool wide = !block.exact.empty();
  const std::size_t count = wide ? block.exact.size() : block.positions.size();
  const auto at = [&](std::size_t i) {
    return wide ? block.exact[i] : to_double(block.positions[i]);
  };
  for (std::size_t i = 0; i < count; ++i)
    summary_.bounds.add(at(i));
  if (wide)
    float_exact_ = float_exact_ && std::all_of(block.exact.begin(), block.exact.end(), fits_float);

  const partition::SampleIds ids(summary_.vertices);
  while (sample_positions_.size() < ids.count() &&
         ids[sample_positions_.size()] < block.first + count) {
    sample_positions_.push_back(at(ids[sample_positions_.size()] - block.first));
  }
  if (!vertices_in_place()) {
    spooled_positions_.append(wide ? std::as_bytes(block.exact) : std::as_bytes(block.positions));
    spooled_attributes_.append(std::as_bytes(block.attributes));
  }
}

void SourceMesh::choose_origin() {
  summary_.double_precision = !float_exact_;
  if (float_exact_)
    return;
  const BoundsD& b = summary_.bounds;
  origin_ = {round_origin(b.min.x, b.max.x), round_origin(b.min.y, b.max.y),
             round_origin(b.min.z, b.max.z)};
  for (const Vec3d corner : {b.min - origin_, b.max - origin_}) {
    const Vec3f stored = to_float(corner);
    if (!std::isfinite(stored.x) || !std::isfinite(stored.y) || !std::isfinite(stored.z)) {
      throw Error(ErrorCode::input,
                  fmt::format("{}: coordinates beyond the range of single precision (3.4e38)",
                              summary_.file_name));
    }
  }
}

std::vector<partition::IdPoint> SourceMesh::sample() const {
  const partition::SampleIds ids(summary_.vertices);
  std::vector<partition::IdPoint> sample(sample_positions_.size());
  for (std::size_t i = 0; i < sample.size(); ++i) {
    sample[i] = {to_float(sample_positions_[i] - origin_), static_cast<std::uint32_t>(ids[i])};
  }
  return sample;
}

void SourceMesh::read_vertices(const SourceBlockVisitor& visit) const {
  const bool wide = source_->description().wide_coordinates;
  std::vector<Vec3f> positions;
  const auto relative = [&](std::span<const Vec3d> exact) {
    positions.resize(exact.size());
    std::transform(exact.begin(), exact.end(), positions.begin(),
                   [&](Vec3d p) { return to_float(p - origin_); });
    return std::span<const Vec3f>(positions);
  };
  if (vertices_in_place()) {
    source_->read_vertices([&](const mesh_io::VertexBlock& block) {
      visit(block.first, wide ? relative(block.exact) : block.positions, block.attributes);
    });
    return;
  }
  std::vector<Vec3d> exact;
  std::vector<float> attributes;
  const auto channels = static_cast<std::size_t>(summary_.attributes.channels());
  for (std::uint64_t first = 0; first < summary_.vertices; first += kBlock) {
    const std::size_t count = std::min<std::uint64_t>(kBlock, summary_.vertices - first);
    attributes.resize(count * channels);
    spooled_attributes_.read(first * channels * sizeof(float),
                             std::as_writable_bytes(std::span(attributes)));
    if (wide) {
      exact.resize(count);
      spooled_positions_.read(first * sizeof(Vec3d), std::as_writable_bytes(std::span(exact)));
      relative(exact);
    } else {
      positions.resize(count);
      spooled_positions_.read(first * sizeof(Vec3f), std::as_writable_bytes(std::span(positions)));
    }
    visit(first, positions, attributes);
  }
}

void SourceMesh::read_triangles(const mesh_io::TriangleVisitor& visit) {
  const mesh_io::FaceCounts counts = source_->read_triangles(visit);
  summary_.faces = counts.faces;
  summary_.triangles = counts.triangles;
  summary_.degenerate_triangles = counts.degenerate_triangles;
}

}  // namespace meshhier::pipeline
