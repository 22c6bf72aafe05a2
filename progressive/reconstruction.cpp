#include "progressive/reconstruction.h"

#include "base/error.h"
#include "progressive/residual.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace meshhier::progressive {
namespace {

/// Marks a slot that nothing was put into, and a triangle that is not there.
constexpr std::uint32_t kNowhere = UINT32_MAX;
/// Vertices and triangles are handed out in blocks of so many.
constexpr std::size_t kBlock = 16384;

[[noreturn]] void fail(const char* what, std::uint64_t index, const char* flaw) {
  throw Error(ErrorCode::corrupt, std::string(what) + " " + std::to_string(index) + " " + flaw);
}

}  // namespace

Reconstruction::Reconstruction(const StreamSize& size, const AttributeLayout& layout)
    : size_(size),
      layout_(layout),
      width_(static_cast<std::size_t>(vertex_values(layout))),
      values_(size.vertices * width_),
      origins_(size.vertices, kNowhere),
      corners_(size.triangles, Triangle<std::uint32_t>{kNowhere, kNowhere, kNowhere}) {}

std::uint64_t Reconstruction::memory_bytes(const StreamSize& size, const AttributeLayout& layout) {
  const auto width = static_cast<std::uint64_t>(vertex_values(layout));
  return size.vertices * (width * sizeof(float) + sizeof(std::uint32_t)) +
         size.triangles * sizeof(Triangle<std::uint32_t>);
}

void Reconstruction::apply(const DetailRun& run) {
  std::visit([this](const auto& list) { apply(list); }, run);
}

void Reconstruction::apply(const VertexRun& run) {
  std::vector<float> before(width_);  // the run's last vertex
  std::vector<float> values(width_);
  for (std::size_t i = 0; i < run.indices.size(); ++i) {
    const std::uint32_t vertex = run.indices[i];
    if (vertex >= size_.vertices)
      fail("vertex", vertex, "is beyond the mesh");
    if (is_there(vertex) && vertex < size_.own_vertices)
      fail("vertex", vertex, "appears twice");
    const std::span<float> slot = values_of(vertex);
    const auto residuals = std::span(run.residuals).subspan(i * width_, width_);
    add_residuals(layout_, residuals, origins_[vertex] == kNowhere ? before : slot, values);
    if (!(std::isfinite(values[0]) && std::isfinite(values[1]) && std::isfinite(values[2])))
      fail("vertex", vertex, "has no finite place");
    std::copy(values.begin(), values.end(), slot.begin());
    before.swap(values);
    shown_vertices_ += is_there(vertex) ? 0 : 1;
    origins_[vertex] = vertex;
  }
}

void Reconstruction::apply(const TriangleRun& run) {
  for (std::size_t i = 0; i < run.indices.size(); ++i) {
    const std::uint64_t triangle = run.indices[i];
    if (triangle >= size_.triangles)
      fail("triangle", triangle, "is beyond the mesh");
    if (corners_[triangle][0] != kNowhere)
      fail("triangle", triangle, "appears twice");
    for (const std::uint32_t corner : run.corners[i]) {
      if (corner >= size_.vertices)
        fail("triangle", triangle, "has a corner beyond the mesh");
    }
    corners_[triangle] = run.corners[i];
  }
  shown_triangles_ += run.indices.size();
}

void Reconstruction::apply(const MergeRun& run) {
  for (std::size_t i = 0; i < run.indices.size(); ++i) {
    const std::uint32_t vertex = run.indices[i];
    const std::uint32_t target = run.targets[i];
    if (vertex >= size_.vertices || target >= size_.vertices)
      fail("merge of vertex", vertex, "is beyond the mesh");
    if (is_there(vertex))
      fail("merge of vertex", vertex, "comes after the vertex itself");
    if (origins_[target] == kNowhere)
      fail("merge of vertex", vertex, "is with a vertex that is nowhere");
    std::ranges::copy(values_of(target), values_of(vertex).begin());
    origins_[vertex] = origins_[target];
  }
}

void Reconstruction::hand_out(
    const std::function<void(std::span<const float>)>& vertices,
    const std::function<void(std::span<const Triangle<std::uint32_t>>)>& triangles) && {
  std::vector<float> block;
  std::uint32_t number = 0;
  for (std::uint32_t vertex = 0; vertex < size_.vertices; ++vertex) {
    if (!is_there(vertex))
      continue;
    const std::span<float> values = values_of(vertex);
    block.insert(block.end(), values.begin(), values.end());
    values[0] = std::bit_cast<float>(number++);
    if (block.size() == kBlock * width_) {
      vertices(block);
      block.clear();
    }
  }
  vertices(block);

  std::vector<Triangle<std::uint32_t>> shown;
  for (std::uint64_t triangle = 0; triangle < size_.triangles; ++triangle) {
    if (corners_[triangle][0] == kNowhere)
      continue;
    Triangle<std::uint32_t>& numbers = shown.emplace_back(corners_[triangle]);
    for (std::uint32_t& corner : numbers) {
      if (origins_[corner] == kNowhere)
        fail("triangle", triangle, "has a corner that is nowhere");
      corner = std::bit_cast<std::uint32_t>(values_of(origins_[corner])[0]);
    }
    if (shown.size() == kBlock) {
      triangles(shown);
      shown.clear();
    }
  }
  triangles(shown);
}

}  // namespace meshhier::progressive
