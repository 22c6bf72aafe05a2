// shuffle(): the same mesh, its vertices and triangles in random order.
#include "bench/block_writer.h"
#include "bench/generator.h"
#include "bench/noise.h"

#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

/// Apart from each other: the vertices' and the triangles' random sequences.
constexpr std::uint64_t kVertexStream = 1;
constexpr std::uint64_t kTriangleStream = 2;

/// Fisher & Yates. The remainder's bias is below 2^-32: nothing a measurement could see.
std::vector<std::uint64_t> random_order(std::uint64_t count, std::uint64_t seed) {
  std::vector<std::uint64_t> order(count);
  std::iota(order.begin(), order.end(), std::uint64_t{0});
  for (std::uint64_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[random_at(seed, i) % i]);
  return order;
}

class Shuffled final : public GeneratedMesh {
 public:
  Shuffled(LoadedMesh mesh, std::uint64_t seed)
      : mesh_(std::move(mesh)),
        vertex_order_(random_order(mesh_.positions.size(), random_at(seed, kVertexStream))),
        triangle_order_(random_order(mesh_.triangles.size(), random_at(seed, kTriangleStream))),
        new_number_(mesh_.positions.size()) {
    for (std::size_t i = 0; i < vertex_order_.size(); ++i)
      new_number_[vertex_order_[i]] = static_cast<std::uint32_t>(i);
    content_.vertex_count = mesh_.positions.size();
    content_.triangle_count = mesh_.triangles.size();
    content_.attributes = mesh_.attributes;
    content_.double_coordinates = mesh_.double_coordinates;
    content_.comments = {fmt::format("meshgen shuffle: seed {}", seed)};
  }

  const mesh_io::PlyContent& content() const override { return content_; }

  void visit_vertices(std::size_t block_size, const VertexBlockVisitor& visit) const override {
    VertexCollector blocks(block_size, visit);
    const auto channels = static_cast<std::size_t>(mesh_.attributes.channels());
    const std::span<const float> all(mesh_.channels);
    for (const std::uint64_t v : vertex_order_)
      blocks.add(mesh_.positions[v], all.subspan(v * channels, channels));
    blocks.flush();
  }

  void visit_triangles(std::size_t block_size, const TriangleBlockVisitor& visit) const override {
    TriangleCollector blocks(block_size, visit);
    for (const std::uint64_t t : triangle_order_) {
      const auto [a, b, c] = mesh_.triangles[t];
      blocks.add({new_number_[a], new_number_[b], new_number_[c]});
    }
    blocks.flush();
  }

 private:
  LoadedMesh mesh_;
  std::vector<std::uint64_t> vertex_order_;    ///< input number, by output number
  std::vector<std::uint64_t> triangle_order_;  ///< likewise
  std::vector<std::uint32_t> new_number_;      ///< output number of a vertex, by input number
  mesh_io::PlyContent content_;
};

}  // namespace

std::unique_ptr<GeneratedMesh> shuffle(LoadedMesh mesh, std::uint64_t seed) {
  return std::make_unique<Shuffled>(std::move(mesh), seed);
}

}  // namespace meshhier::bench
