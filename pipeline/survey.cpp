#include "pipeline/survey.h"

#include "partition/top_tree.h"
#include "pipeline/ingest_stage.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::pipeline {
namespace {

constexpr std::uint64_t kWindow = std::uint64_t{1} << 27;
constexpr std::uint64_t kMostSample = 65536;
/// So many triangles give a median that is off by a fiftieth at most.
constexpr std::uint64_t kEdgeTriangles = 4096;
/// The most, as faces with many corners are many triangles.
constexpr std::uint64_t kMostEdgeTriangles = 4 * kEdgeTriangles;

using SourceTriangle = Triangle<VertexId>;
using SourceTriangles = std::span<const SourceTriangle>;

/// A run of vertices, and which of them triangles use.
class UsedVertices {
 public:
  UsedVertices(std::uint64_t first, std::uint64_t count) : first_(first), used_(count) {}

  void add(SourceTriangles triangles) {
    for (const SourceTriangle& triangle : triangles) {
      for (int k = 0; k < 3; ++k) {
        if (const std::uint64_t i = raw(triangle[k]) - first_; i < used_.size())
          used_[i] = true;
      }
    }
  }

  bool has(std::uint64_t vertex) const {
    return vertex >= first_ && vertex < end() && used_[vertex - first_];
  }
  std::uint64_t first() const { return first_; }
  std::uint64_t end() const { return first_ + used_.size(); }

 private:
  std::uint64_t first_;
  std::vector<bool> used_;
};

/// Takes some triangles from all over the file, by their number alone, and finds where their
/// corners are.
class EdgeSample {
 public:
  explicit EdgeSample(std::uint64_t faces)
      : stride_(std::max<std::uint64_t>(faces / kEdgeTriangles, 1)) {}

  /// Takes all triangles, in the order of the file, call by call.
  void add(SourceTriangles triangles) {
    const std::uint64_t end = first_ + triangles.size();
    while (corners_.size() < kMostEdgeTriangles && next() < end)
      corners_.push_back(triangles[next() - first_]);
    first_ = end;
  }

  /// Ends the triangles; from() may follow.
  void sort() {
    for (const SourceTriangle& t : corners_)
      vertices_.insert(vertices_.end(), t.begin(), t.end());
    std::ranges::sort(vertices_);
    vertices_.erase(std::ranges::unique(vertices_).begin(), vertices_.end());
    positions_.resize(vertices_.size());
  }

  /// Returns the corners from a vertex on, and room for their positions. Thread-safe.
  std::pair<std::span<const VertexId>, std::span<Vec3d>> from(std::uint64_t vertex) {
    const auto at = std::ranges::lower_bound(vertices_, vertex, {},
                                             [](VertexId v) { return std::uint64_t{raw(v)}; });
    const auto i = static_cast<std::size_t>(at - vertices_.begin());
    return {std::span(vertices_).subspan(i), std::span(positions_).subspan(i)};
  }

  double median() const {
    std::vector<double> lengths;
    for (const SourceTriangle& t : corners_) {
      for (std::size_t k = 0; k < 3; ++k)
        lengths.push_back(length(place(t[k]) - place(t[(k + 1) % 3])));
    }
    if (lengths.empty())
      return 0;
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    return *middle;
  }

 private:
  /// Returns the next triangle to take: one of each stride, not always the same.
  std::uint64_t next() const {
    constexpr std::uint64_t kGoldenRatio = 0x9e3779b97f4a7c15;  // Fibonacci hashing, Knuth 6.4
    const std::uint64_t stride = corners_.size();
    return stride * stride_ + (stride * kGoldenRatio >> 32) % stride_;
  }
  Vec3d place(VertexId vertex) const {
    const auto at = std::ranges::lower_bound(vertices_, vertex);
    return positions_[static_cast<std::size_t>(at - vertices_.begin())];
  }

  std::uint64_t stride_;
  std::uint64_t first_ = 0;  ///< number of the triangle that comes next
  std::vector<SourceTriangle> corners_;
  std::vector<VertexId> vertices_;  ///< the corners' vertices, ascending
  std::vector<Vec3d> positions_;    ///< these vertices' positions
};

void read_faces(SourceMesh& mesh, const std::function<void(SourceTriangles)>& visit,
                const StageContext& context) {
  using Triangles = std::vector<SourceTriangle>;
  context.progress.stage("ingest", mesh.declared_faces(), "triangles");
  mesh.read_triangles<Triangles>(
      context.memory().blocks_in_flight, context.cancel,
      [](SourceTriangles block, Triangles& slot) { slot.assign(block.begin(), block.end()); },
      [&](const Triangles& slot) {
        context.progress.advance(slot.size());
        visit(slot);
      });
}

/// Looks at blocks of vertices in parallel, then sinks what is found in their order. `look` is
/// given a block's number, and a Slot with memory for it.
template <class Slot, class Look, class Sink>
void read_vertices(const UsedVertices& used, const SourceMesh& mesh, const Look& look,
                   const Sink& sink, const StageContext& context) {
  constexpr std::uint64_t kSize = mesh_io::MeshSource::kBlockSize;
  const std::uint64_t first = used.first() / kSize;
  const std::uint64_t end = std::min(mesh.vertex_blocks(), (used.end() + kSize - 1) / kSize);
  execution::ordered_blocks<Slot>(
      end - first, context.memory().blocks_in_flight, context.cancel,
      [&](std::uint64_t i, Slot& slot) { look(first + i, slot); },
      [&](const Slot& slot) {
        sink(slot);
        return true;
      });
}

/// Calls visit(used) for one window of vertices after the other; `see` is given all triangles for
/// each.
template <class Visit>
void for_each_window(SourceMesh& mesh, const std::function<void(SourceTriangles)>& see,
                     const Visit& visit, const StageContext& context) {
  const std::uint64_t vertices = mesh.summary().vertices;
  for (std::uint64_t first = 0; first < vertices; first += kWindow) {
    UsedVertices used(first, std::min(kWindow, vertices - first));
    const auto take = [&](SourceTriangles triangles) {
      used.add(triangles);
      see(triangles);
    };
    read_faces(mesh, take, context);
    visit(std::as_const(used));
  }
}

/// Returns the box of a window's vertices, and fills in the positions of corners.
BoundsD box_of(const UsedVertices& used, EdgeSample& edges, const SourceMesh& mesh,
               const StageContext& context) {
  struct Slot {
    mesh_io::BlockMemory memory;
    BoundsD box;
  };
  BoundsD box;
  const auto look = [&](std::uint64_t block, Slot& slot) {
    slot.box = {};
    auto [corners, places] = edges.from(block * mesh_io::MeshSource::kBlockSize);
    std::size_t next = 0;
    mesh.visit_input_block(block, slot.memory, [&](std::uint64_t vertex, Vec3d position) {
      if (used.has(vertex))
        slot.box.add(position);
      if (next < corners.size() && raw(corners[next]) == vertex)
        places[next++] = position;
    });
  };
  read_vertices<Slot>(
      used, mesh, look, [&](const Slot& slot) { box.add(slot.box); }, context);
  return box;
}

}  // namespace

Survey survey(SourceMesh& mesh, std::span<const Vec3d> sample, const StageContext& context) {
  Survey found;
  EdgeSample edges(mesh.declared_faces());
  bool is_first = true;
  const auto see = [&](SourceTriangles triangles) {
    if (is_first)
      edges.add(triangles);
  };
  const partition::SampleIds ids(mesh.summary().vertices);
  const std::uint64_t step = (sample.size() + kMostSample - 1) / kMostSample;
  const auto look = [&](const UsedVertices& used) {
    if (std::exchange(is_first, false))
      edges.sort();
    found.bounds.add(box_of(used, edges, mesh, context));
    for (std::uint64_t i = 0; i < sample.size(); i += step) {
      if (used.has(ids[i]))
        found.sample.push_back(sample[i]);
    }
  };
  for_each_window(mesh, see, look, context);
  found.median_edge = edges.median();
  return found;
}

FarVertices used_outside(SourceMesh& mesh, const BoundsD& box, const StageContext& context) {
  struct Slot {
    mesh_io::BlockMemory memory;
    FarVertices far;
  };
  FarVertices all;
  const auto is_outside = [&](Vec3d p) {
    return p.x < box.min.x || p.y < box.min.y || p.z < box.min.z || p.x > box.max.x ||
           p.y > box.max.y || p.z > box.max.z;
  };
  const auto look_at = [&](const UsedVertices& used) {
    const auto look = [&](std::uint64_t block, Slot& slot) {
      slot.far = {};
      mesh.visit_input_block(block, slot.memory, [&](std::uint64_t vertex, Vec3d position) {
        if (used.has(vertex) && is_outside(position) && slot.far.count++ == 0)
          slot.far.first = position;
      });
    };
    const auto sink = [&](const Slot& slot) {
      if (all.count == 0)
        all.first = slot.far.first;
      all.count += slot.far.count;
    };
    read_vertices<Slot>(used, mesh, look, sink, context);
  };
  for_each_window(
      mesh, [](SourceTriangles) {}, look_at, context);
  return all;
}

std::uint64_t survey_bytes(std::uint64_t vertex_count) {
  constexpr std::uint64_t kCorner = sizeof(VertexId) + sizeof(Vec3d);
  return std::min(kWindow, vertex_count) / 8 + std::min(kMostSample, vertex_count) * sizeof(Vec3d) +
         3 * kMostEdgeTriangles * (sizeof(VertexId) + kCorner + sizeof(double));
}

}  // namespace meshhier::pipeline
