// Kernels one by one, in triangles, vertices or questions a second of CPU time: what a hierarchy's
// tiles cost.
#include "base/angle.h"
#include "bench/sample_tiles.h"
#include "cluster_simplify/contraction.h"
#include "cluster_simplify/quadric.h"
#include "compare/triangle_search.h"
#include "partition/top_tree.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

namespace meshhier::bench {
namespace {

using cluster_simplify::ContractionOptions;
using cluster_simplify::HalfEdgeCost;
using cluster_simplify::Method;
using cluster_simplify::Representative;

/// The default of the config: two such partitions make the joined tile of 16,384 vertices.
constexpr std::uint32_t kPartitionVertices = 8192;

struct NamedContraction {
  const char* name;
  ContractionOptions options;
};

/// Every method is measured that stands here.
constexpr std::array kContractions = {
    NamedContraction{"contract/cluster/mean",
                     {.method = Method::cluster, .representative = Representative::mean}},
    NamedContraction{"contract/cluster/quadric",
                     {.method = Method::cluster, .representative = Representative::quadric}},
    NamedContraction{"contract/cluster/vertex",
                     {.method = Method::cluster, .representative = Representative::vertex}},
    NamedContraction{"contract/edge_collapse", {.method = Method::edge_collapse}},
    NamedContraction{"contract/half_edge/quadric",
                     {.method = Method::half_edge, .cost = HalfEdgeCost::quadric}},
    NamedContraction{"contract/half_edge/melax",
                     {.method = Method::half_edge, .cost = HalfEdgeCost::melax}},
};

/// A torus with relief and, as scans have it, noise. Its vertices are half as many as its
/// triangles: just as many as a chunk may have, so that a split is measured at full size.
std::unique_ptr<GeneratedMesh> noisy_torus() {
  SurfaceOptions options;
  options.shape = BaseShape::torus;
  options.triangles = 2 * partition::kChunkVertices;
  options.noise = 0.2;
  return make_surface(options);
}

/// The chunk of 16 partitions whose tiles are used.
const SampleChunk& sample_chunk() {
  static const SampleChunk chunk(*noisy_torus(), kPartitionVertices);
  return chunk;
}

const SampleTiles& sample_tiles() {
  static const SampleTiles tiles(sample_chunk(), partition::Axis::compactness);
  return tiles;
}

const BuildTile& joined_tile() {
  static const BuildTile tile = joined_pair(sample_tiles(), 0);
  return tile;
}

std::int64_t triangle_count(const BuildTile& tile) {
  return static_cast<std::int64_t>(tile.mesh.interior.size() + tile.mesh.border.size());
}

void count_triangles(benchmark::State& state, std::int64_t triangles) {
  state.SetItemsProcessed(state.iterations() * triangles);
}

void contract(benchmark::State& state, const ContractionOptions& options) {
  const BuildTile& joined = joined_tile();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        cluster_simplify::contract(joined, joined.mesh.own_count / 2, {}, options));
  }
  count_triangles(state, triangle_count(joined));
  state.counters["vertices"] = joined.mesh.own_count;
}

void apply(benchmark::State& state) {
  const BuildTile& joined = joined_tile();
  const cluster_simplify::Contraction contraction =
      cluster_simplify::contract(joined, joined.mesh.own_count / 2, {}, {});
  for (auto _ : state) {
    state.PauseTiming();
    cluster_simplify::Contraction copy = contraction;
    state.ResumeTiming();
    benchmark::DoNotOptimize(cluster_simplify::apply(joined, std::move(copy)));
  }
  count_triangles(state, triangle_count(joined));
}
BENCHMARK(apply);

void join(benchmark::State& state) {
  const BuildTile first = sample_tiles().resolved(0);
  const BuildTile second = sample_tiles().resolved(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(cluster_simplify::join(first, 0, second, 1));
  count_triangles(state, triangle_count(first) + triangle_count(second));
}
BENCHMARK(join);

void resolve(benchmark::State& state) {
  const LeafTile& work = sample_tiles().work(0);
  const std::vector<GhostRef> mapped = sample_tiles().mapped(0);
  for (auto _ : state) {
    state.PauseTiming();
    LeafTile copy = work;
    state.ResumeTiming();
    benchmark::DoNotOptimize(cluster_simplify::resolve(std::move(copy), mapped, true, 0));
  }
  count_triangles(state, static_cast<std::int64_t>(work.interior.size() + work.border.size()));
}
BENCHMARK(resolve);

void split_chunk(benchmark::State& state, partition::Axis axis) {
  const SampleChunk& sample = sample_chunk();
  for (auto _ : state)
    benchmark::DoNotOptimize(partition::split_chunk(sample.chunk, sample.tree, axis));
  count_triangles(state, static_cast<std::int64_t>(sample.chunk.triangles.size()));
  state.counters["vertices"] = static_cast<double>(sample.chunk.vertices.size());
}
BENCHMARK_CAPTURE(split_chunk, longest, partition::Axis::longest)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(split_chunk, compactness, partition::Axis::compactness)
    ->Unit(benchmark::kMillisecond);

/// Makes one quadric a vertex, from all triangles around it.
void build_quadrics(benchmark::State& state) {
  const TileMesh& mesh = joined_tile().mesh;
  std::vector<cluster_simplify::Quadric> quadrics;
  for (auto _ : state) {
    quadrics.assign(mesh.own_count, {});
    for (const TileTriangle& t : mesh.interior) {
      std::array<Vec3d, 3> corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = to_double(mesh.vertices.positions[raw(t[k])]);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d origin = corners[k];
        quadrics[raw(t[k])].add_triangle(corners[0] - origin, corners[1] - origin,
                                         corners[2] - origin);
      }
    }
    benchmark::DoNotOptimize(quadrics.data());
    benchmark::ClobberMemory();
  }
  count_triangles(state, static_cast<std::int64_t>(mesh.interior.size()));
}
BENCHMARK(build_quadrics);

std::vector<SurfaceTriangle> sample_triangles() {
  const TileMesh& mesh = joined_tile().mesh;
  std::vector<SurfaceTriangle> triangles;
  for (const TileTriangle& t : mesh.interior) {
    const auto at = [&](std::size_t k) { return mesh.vertices.positions[raw(t[k])]; };
    triangles.push_back({at(0), at(1), at(2)});
  }
  return triangles;
}

/// Makes the tree that points and rays are looked up in.
void search_build(benchmark::State& state) {
  const std::vector<SurfaceTriangle> triangles = sample_triangles();
  for (auto _ : state)
    benchmark::DoNotOptimize(comparing::TriangleSearch(triangles));
  count_triangles(state, static_cast<std::int64_t>(triangles.size()));
}
BENCHMARK(search_build)->Name("search/build")->Unit(benchmark::kMillisecond);

/// Asks about all triangles: ask(search, middle of the triangle, a vector of unit length).
template <class Ask>
void search_triangles(benchmark::State& state, const Ask& ask) {
  const std::vector<SurfaceTriangle> triangles = sample_triangles();
  const comparing::TriangleSearch search(triangles);
  for (auto _ : state) {
    double angle = 0;
    for (const auto& [a, b, c] : triangles) {
      angle += 1;  // radian: all around
      if (angle > 2 * std::numbers::pi)
        angle -= 2 * std::numbers::pi;
      const UnitTurn way = turn_by(angle);
      ask(search, to_double(a + b + c) * (1.0 / 3), {way.cosine, 0, way.sine});
    }
  }
  count_triangles(state, static_cast<std::int64_t>(triangles.size()));
}

void search_points(benchmark::State& state) {
  search_triangles(state, [](const auto& search, Vec3d middle, Vec3d way) {
    benchmark::DoNotOptimize(
        search.first_nearest(middle + way * 0.01, std::numeric_limits<double>::infinity(), 0));
  });
}
BENCHMARK(search_points)->Name("search/points")->Unit(benchmark::kMillisecond);

void search_rays(benchmark::State& state) {
  search_triangles(state, [](const auto& search, Vec3d middle, Vec3d way) {
    benchmark::DoNotOptimize(search.first_hit(Ray(middle - way * 3, way), comparing::kBehindAll));
  });
}
BENCHMARK(search_rays)->Name("search/rays")->Unit(benchmark::kMillisecond);

void register_contractions() {
  for (const NamedContraction& contraction : kContractions)
    benchmark::RegisterBenchmark(contraction.name, contract, contraction.options);
}

}  // namespace
}  // namespace meshhier::bench

int main(int argc, char** argv) {
  meshhier::bench::register_contractions();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
    return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
