// A tile whose edges collapse one by one, as tests choose, and what is measured meanwhile.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/drift_meter.h"
#include "cluster_simplify/local_frame.h"
#include "cluster_simplify/representatives.h"
#include "hierarchy/build_tile.h"

#include <cstdint>
#include <vector>

namespace meshhier::tests {

class Collapsing {
 public:
  explicit Collapsing(const BuildTile& tile)
      : mesh_(tile.mesh),
        frame_(tile.mesh.vertices.positions),
        places_(frame_.to_local(tile.mesh.vertices.positions)),
        vertices_(tile.mesh.vertices),
        drift_(mesh_, tile.history.weights) {}

  cluster_simplify::CollapseMesh& mesh() { return mesh_; }
  const cluster_simplify::DriftMeter& drift() const { return drift_; }
  const cluster_simplify::LocalFrame& frame() const { return frame_; }
  const std::vector<Vec3f>& places() const { return places_; }  ///< in frame()

  /// `place`: in frame().
  void collapse(std::uint32_t from, std::uint32_t to, Vec3f place) {
    mesh_.gather(from, around_from_);
    mesh_.gather(to, around_to_);
    drift_.note(places_, {from, to, place, around_from_, around_to_});
    mesh_.collapse(from, to, around_from_, around_to_, [](std::uint32_t) {});
    places_[to] = place;
    vertices_.positions[to] = frame_.to_global(place);
  }
  /// A half-edge collapse: `to` stays where it is, bit for bit.
  void collapse(std::uint32_t from, std::uint32_t to) {
    const Vec3f stays = vertices_.positions[to];
    collapse(from, to, places_[to]);
    vertices_.positions[to] = stays;
  }

  cluster_simplify::Contraction choose(std::uint32_t target) {
    return cluster_simplify::choose_representatives({mesh_, vertices_, places_, frame_, drift_},
                                                    target);
  }

 private:
  cluster_simplify::CollapseMesh mesh_;
  cluster_simplify::LocalFrame frame_;
  std::vector<Vec3f> places_;
  VertexArray vertices_;
  cluster_simplify::DriftMeter drift_;
  std::vector<cluster_simplify::CollapseMesh::Fan> around_from_, around_to_;
};

}  // namespace meshhier::tests
