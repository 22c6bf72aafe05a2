#include "tests/support/sample_shading.h"

#include "hierarchy/vertex_numbers.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <utility>

namespace meshhier::tests {
namespace {

template <class T>
std::uint64_t hash_of(std::span<const T> values) {
  return storage::checksum(std::as_bytes(values));
}

class Shader {
 public:
  explicit Shader(const PublishedTile& tile)
      : tile_(tile),
        mesh_(tile.mesh),
        numbers_(static_cast<std::uint32_t>(mesh_.vertices.size()), mesh_.copies.places) {
    for (std::uint32_t v = 0; v < mesh_.vertices.size() + mesh_.copies.size(); ++v)
      names_.push_back(name_of(v));
  }

  Shading shading() {
    choose(mesh_.interior, mesh_.interior_wedges);
    choose(mesh_.border, mesh_.border_wedges);
    Shading shading;
    for (const std::uint64_t name : names_)
      shading.normals.push_back(normal_of(name, 0));
    for (const auto& [vertex, choice] : splits_) {
      shading.normals.push_back(normal_of(names_[vertex], choice));
      shading.split_of.push_back(vertex);
    }
    if (splits_.empty())
      return shading;
    shading.interior = with_splits(mesh_.interior, mesh_.interior_wedges);
    shading.border = with_splits(mesh_.border, mesh_.border_wedges);
    return shading;
  }

 private:
  /// Returns the name of a vertex, the same in every tile of the level.
  std::uint64_t name_of(std::uint32_t vertex) const {
    const Wedge at = numbers_[vertex];
    const auto place = static_cast<TileVertex>(at.place);
    const GhostRef owner =
        mesh_.is_own(place) ? GhostRef{tile_.node.index, at.place} : mesh_.ghost(place);
    const bool first = vertex < mesh_.vertices.size();
    const auto attributes =
        first ? mesh_.vertices.attributes_of(vertex)
              : mesh_.copies.vertices.attributes_of(vertex - mesh_.vertices.size());
    return hash_of<std::uint64_t>(std::array{std::uint64_t{raw(tile_.node.level)},
                                             std::uint64_t{owner.tile}, std::uint64_t{owner.index},
                                             attributes.empty() ? 0 : hash_of(attributes)});
  }

  static NormalCode normal_of(std::uint64_t name, std::uint64_t choice) {
    const auto part = [&](std::uint64_t axis) {
      const std::uint64_t bits = hash_of<std::uint64_t>(std::array{name, choice, axis});
      return static_cast<double>(bits >> 11) * 0x1p-52 - 1;
    };
    return normal_code({part(0), part(1), part(2)});
  }

  /// Returns for each corner which of its vertex's normals it has.
  std::array<std::uint32_t, 3> choices(const TileTriangle& t) const {
    std::uint64_t triangle = 0;  // however it is turned
    for (const TileVertex v : t)
      triangle += names_[raw(v)];
    std::array<std::uint32_t, 3> choices{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint64_t name = names_[raw(t[c])];
      choices[c] = static_cast<std::uint32_t>(hash_of<std::uint64_t>(std::array{triangle, name}) %
                                              (name % 3 + 1));
    }
    return choices;
  }

  void choose(const std::vector<TileTriangle>& triangles, const std::vector<CornerWedges>& wedges) {
    for (const TileTriangle& t : numbers_.numbered(triangles, wedges)) {
      const auto chosen = choices(t);
      for (std::size_t c = 0; c < 3; ++c) {
        if (chosen[c] > 0)
          splits_.insert({raw(t[c]), chosen[c]});
      }
    }
  }

  std::vector<TileTriangle> with_splits(const std::vector<TileTriangle>& triangles,
                                        const std::vector<CornerWedges>& wedges) const {
    std::vector<TileTriangle> split = numbers_.numbered(triangles, wedges);
    for (TileTriangle& t : split) {
      const auto chosen = choices(t);
      for (std::size_t c = 0; c < 3; ++c) {
        if (chosen[c] > 0)
          t[c] = static_cast<TileVertex>(number_of(raw(t[c]), chosen[c]));
      }
    }
    return split;
  }

  std::size_t number_of(std::uint32_t vertex, std::uint32_t choice) const {
    const auto found = splits_.find({vertex, choice});
    return names_.size() + static_cast<std::size_t>(std::distance(splits_.begin(), found));
  }

  const PublishedTile& tile_;
  const TileMesh& mesh_;
  const VertexNumbers numbers_;
  std::vector<std::uint64_t> names_;                          ///< names of vertices
  std::set<std::pair<std::uint32_t, std::uint32_t>> splits_;  ///< vertex, which of its normals
};

}  // namespace

Shading sample_shading(const PublishedTile& tile) {
  return Shader(tile).shading();
}

void add_shading(Sample& sample) {
  sample.format.computed_normals = sample.manifest.computed_normals = true;
  for (PublishedTile& tile : sample.tiles) {
    tile.shading = sample_shading(tile);
    sample.record(tile.node).split_count = static_cast<std::uint32_t>(tile.shading.split_of.size());
  }
}

}  // namespace meshhier::tests
