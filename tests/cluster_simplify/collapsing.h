// A tile whose edges collapse one by one, as tests choose, and what is measured meanwhile.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/deviation_meter.h"
#include "cluster_simplify/edge_star.h"
#include "cluster_simplify/local_frame.h"
#include "cluster_simplify/representatives.h"
#include "hierarchy/build_tile.h"

#include <cstdint>
#include <vector>

namespace meshhier::tests {

/// The edges between own vertices that have triangles.
inline std::vector<std::uint32_t> live_edges(const cluster_simplify::CollapseMesh& mesh) {
  std::vector<std::uint32_t> live;
  for (std::uint32_t e = 0; e < mesh.edges().size(); ++e) {
    if (mesh.edge(e).triangle_count > 0 && mesh.is_own_edge(e))
      live.push_back(e);
  }
  return live;
}

class Collapsing {
 public:
  explicit Collapsing(const BuildTile& tile)
      : joined_(tile.mesh),
        mesh_(joined_),
        frame_(cluster_simplify::surface_bounds(mesh_, tile.mesh.vertices.positions)),
        places_(frame_.to_local(tile.mesh.vertices.positions)),
        vertices_(tile.mesh.vertices),
        deviation_(mesh_, tile.history.weights) {}

  cluster_simplify::CollapseMesh& mesh() { return mesh_; }
  const cluster_simplify::DeviationMeter& deviation() const { return deviation_; }
  const cluster_simplify::LocalFrame& frame() const { return frame_; }
  const std::vector<Vec3f>& places() const { return places_; }  ///< in frame()

  /// `place`: in frame().
  void collapse(std::uint32_t from, std::uint32_t to, Vec3f place) {
    star_.gather(mesh_, from, to);
    if (star_.is_disc())
      star_.look_from(place, places_);
    deviation_.note(places_, star_, place);
    if (star_.is_disc())
      mesh_.collapse_disc(star_);
    else
      mesh_.collapse(from, to, star_.around_from(), star_.around_to(), [](std::uint32_t) {});
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
    return cluster_simplify::choose_representatives(
        {joined_, mesh_, vertices_, places_, frame_, deviation_}, target);
  }

 private:
  TileMesh joined_;
  cluster_simplify::CollapseMesh mesh_;
  cluster_simplify::LocalFrame frame_;
  std::vector<Vec3f> places_;
  VertexArray vertices_;
  cluster_simplify::DeviationMeter deviation_;
  cluster_simplify::EdgeStar star_;
};

}  // namespace meshhier::tests
