#include "mesh_io/ply_places.h"

#include <algorithm>
#include <memory>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint64_t kLeastRun = 128;
constexpr std::uint64_t kMostIndexed = std::uint64_t{1} << 16;

std::vector<Vec3d> places_of(const VertexBlock& block) {
  std::vector<Vec3d> places(block.exact.begin(), block.exact.end());
  for (const Vec3f& p : block.positions)
    places.push_back(to_double(p));
  return places;
}

}  // namespace

PlyPlaces::PlyPlaces(const InputFile& input, const PlyPlan& plan, const MeshDescription& mesh,
                     PlyPosition start)
    : input_{input.file, input.bytes},
      plan_(plan),
      mesh_(mesh),
      start_(start),
      is_fixed_(plan.elements[plan.vertex_element].stride.has_value()),
      run_vertices_(is_fixed_ ? kLeastRun
                              : std::max(kLeastRun, mesh.vertex_count / kMostIndexed + 1)) {}

Vec3d PlyPlaces::at(std::uint32_t vertex) {
  const std::uint64_t number = vertex / run_vertices_;
  Run& run = runs_[number % kRuns];
  if (run.places.empty() || run.first != number * run_vertices_)
    load(run, number * run_vertices_);
  return run.places[vertex - run.first];
}

/// Throws without a trace in the run: who reads on after an error finds none of it.
void PlyPlaces::load(Run& run, std::uint64_t first) {
  const auto count = static_cast<std::size_t>(std::min(run_vertices_, mesh_.vertex_count - first));
  run.places.clear();
  run.places = is_fixed_ ? fixed_places(first, count) : indexed_places(first, count);
  run.first = first;
}

std::vector<Vec3d> PlyPlaces::fixed_places(std::uint64_t first, std::size_t count) {
  const PlyVertexBlocks rows(plan_, mesh_, start_.offset);
  return places_of(rows.rows(input_, first, count, memory_));
}

std::vector<PlyPosition> PlyPlaces::make_index() const {
  std::vector<PlyPosition> index;
  const auto body = make_body(input_, plan_, start_);
  PlyElementPlan part = plan_.elements[plan_.vertex_element];
  for (std::uint64_t first = 0; first < mesh_.vertex_count; first += run_vertices_) {
    index.push_back(body->position());
    part.element.count = std::min(run_vertices_, mesh_.vertex_count - first);
    body->skip(part);
  }
  index.push_back(body->position());
  return index;
}

std::vector<Vec3d> PlyPlaces::indexed_places(std::uint64_t first, std::size_t count) {
  if (index_.empty())
    index_ = make_index();
  const std::uint64_t number = first / run_vertices_;
  const InputFile part_of_file{input_.file, index_[number + 1].offset};
  const auto body = make_body(part_of_file, plan_, index_[number]);
  PlyElementPlan part = plan_.elements[plan_.vertex_element];
  part.element.count = count;
  MeshDescription mesh = mesh_;
  mesh.vertex_count = count;
  std::vector<Vec3d> places;
  const VertexVisitor take = [&](const VertexBlock& block) {
    const std::vector<Vec3d> more = places_of(block);
    places.insert(places.end(), more.begin(), more.end());
  };
  VertexBlocks blocks(mesh, take);
  body->read_vertices(part, 0, blocks);
  blocks.finish();
  return places;
}

}  // namespace meshhier::mesh_io
