#include "pipeline/used_bounds.h"

#include "pipeline/ingest_stage.h"

#include <algorithm>
#include <span>
#include <vector>

namespace meshhier::pipeline {
namespace {

constexpr std::uint64_t kWindow = std::uint64_t{1} << 27;

/// A run of vertices, and which of them triangles use.
class UsedVertices {
 public:
  UsedVertices(std::uint64_t first, std::uint64_t count) : first_(first), used_(count) {}

  void add(std::span<const Triangle<VertexId>> triangles) {
    for (const Triangle<VertexId>& triangle : triangles) {
      for (int k = 0; k < 3; ++k) {
        if (const std::uint64_t i = raw(triangle[k]) - first_; i < used_.size())
          used_[i] = true;
      }
    }
  }

  bool has(std::uint64_t vertex) const { return used_[vertex - first_]; }
  std::uint64_t first() const { return first_; }
  std::uint64_t end() const { return first_ + used_.size(); }

 private:
  std::uint64_t first_;
  std::vector<bool> used_;
};

void read_faces(SourceMesh& mesh, UsedVertices& used, const StageContext& context) {
  using Triangles = std::vector<Triangle<VertexId>>;
  mesh.read_triangles<Triangles>(
      context.memory().blocks_in_flight, context.cancel,
      [](std::span<const Triangle<VertexId>> block, Triangles& slot) {
        slot.assign(block.begin(), block.end());
      },
      [&](const Triangles& slot) {
        context.progress.advance(slot.size());
        used.add(slot);
      });
}

BoundsD box_of(const UsedVertices& used, const SourceMesh& mesh, const StageContext& context) {
  constexpr std::uint64_t kSize = mesh_io::MeshSource::kBlockSize;
  struct Slot {
    mesh_io::BlockMemory memory;
    BoundsD box;
  };
  const std::uint64_t first = used.first() / kSize;
  const std::uint64_t end = std::min(mesh.vertex_blocks(), (used.end() + kSize - 1) / kSize);
  BoundsD box;
  execution::ordered_blocks<Slot>(
      end - first, context.memory().blocks_in_flight, context.cancel,
      [&](std::uint64_t i, Slot& slot) {
        slot.box = {};
        mesh.visit_input_block(first + i, slot.memory, [&](std::uint64_t vertex, Vec3d position) {
          if (vertex >= used.first() && vertex < used.end() && used.has(vertex))
            slot.box.add(position);
        });
      },
      [&](const Slot& slot) {
        box.add(slot.box);
        return true;
      });
  return box;
}

}  // namespace

BoundsD used_bounds(SourceMesh& mesh, const StageContext& context) {
  const std::uint64_t vertices = mesh.summary().vertices;
  BoundsD box;
  for (std::uint64_t first = 0; first < vertices; first += kWindow) {
    UsedVertices used(first, std::min(kWindow, vertices - first));
    context.progress.stage("ingest", mesh.declared_faces(), "triangles");
    read_faces(mesh, used, context);
    box.add(box_of(used, mesh, context));
  }
  return box;
}

std::uint64_t used_bounds_bytes(std::uint64_t vertex_count) {
  return std::min(kWindow, vertex_count) / 8;
}

}  // namespace meshhier::pipeline
