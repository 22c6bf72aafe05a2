#include "tests/support/sample_copies.h"

#include "base/bounds.h"
#include "hierarchy/drawing_rule.h"
#include "mesh_io/ply_writer.h"
#include "partition/compactness.h"
#include "storage/io/file.h"
#include "storage/io/file_checksum.h"
#include "verify/corner_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <utility>

namespace meshhier::tests {
namespace {

using verifying::CornerId;
using verifying::CornerTriangle;
using verifying::make_corner;

std::uint64_t scrambled(std::uint64_t x) {
  x *= 0x9E3779B97F4A7C15U;
  x ^= x >> 29;
  x *= 0xBF58476D1CE4E5B9U;
  return x ^ (x >> 32);
}

/// Alike in all tiles that have the triangle.
std::uint64_t hash_of(const CornerTriangle& t) {
  std::uint64_t hash = 0;
  for (const CornerId corner : canonical(t))
    hash = scrambled(hash + static_cast<std::uint64_t>(corner) + 1);
  return hash;
}

/// Which of the vertices at a corner's place a triangle takes, 0 to 2: a name, not a number yet.
std::uint32_t name_of(CornerId corner, const CornerTriangle& t) {
  return static_cast<std::uint32_t>(scrambled(hash_of(t) + static_cast<std::uint64_t>(corner)) % 3);
}

/// The tiles of one level, with what their places' vertices are called.
class Splitter {
 public:
  Splitter(const CopiesOptions& options, int channels) : options_(options), channels_(channels) {}

  /// Before split(), for all tiles of the level.
  void look_at(const PublishedTile& tile) {
    const TileMesh& mesh = tile.mesh;
    for (const auto* list : {&mesh.interior, &mesh.border}) {
      for (const TileTriangle& t : *list) {
        const CornerTriangle corners = corners_of(tile, t);
        for (std::size_t i = 0; i < 3; ++i)
          names_[corners[i]].insert(name_of(corners[i], corners));
      }
    }
  }

  void split(PublishedTile& tile, bool is_partition) const {
    Wedged interior = split_list(tile, tile.mesh.interior);
    Wedged border = split_list(tile, tile.mesh.border);
    if (is_partition && options_.flat)
      add_flat(tile, interior, border);
    add_vertices(tile, border);
    number(tile, interior, is_partition);
    number(tile, border, is_partition);
    tile.mesh.interior = std::move(interior.triangles);
    tile.mesh.interior_wedges = std::move(interior.wedges);
    tile.mesh.border = std::move(border.triangles);
    tile.mesh.border_wedges = std::move(border.wedges);
    if (!tile.mesh.copies.empty())
      return;
    tile.mesh.interior_wedges.clear();
    tile.mesh.border_wedges.clear();
  }

 private:
  struct Wedged {
    std::vector<TileTriangle> triangles;
    std::vector<CornerWedges> wedges;  ///< as the owners number them
  };

  static CornerId corner_of(const PublishedTile& tile, TileVertex v) {
    return tile.mesh.is_own(v) ? make_corner(tile.node.index, raw(v))
                               : make_corner(tile.mesh.ghost(v).tile, tile.mesh.ghost(v).index);
  }
  static CornerTriangle corners_of(const PublishedTile& tile, const TileTriangle& t) {
    return {corner_of(tile, t[0]), corner_of(tile, t[1]), corner_of(tile, t[2])};
  }

  std::set<std::uint32_t> names_at(CornerId corner) const {
    const auto found = names_.find(corner);
    return found == names_.end() ? std::set<std::uint32_t>{0} : found->second;
  }

  Wedged split_list(const PublishedTile& tile, const std::vector<TileTriangle>& list) const {
    Wedged result{list, {}};
    for (const TileTriangle& t : list) {
      const CornerTriangle corners = corners_of(tile, t);
      CornerWedges& wedges = result.wedges.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto names = names_at(corners[i]);
        wedges[i] = static_cast<std::uint32_t>(
            std::distance(names.begin(), names.find(name_of(corners[i], corners))));
      }
    }
    return result;
  }

  /// At an edge of every fourth triangle.
  void add_flat(const PublishedTile& tile, Wedged& interior, Wedged& border) const {
    for (const Wedged& list : {interior, border}) {
      for (const TileTriangle& t : list.triangles) {
        const CornerTriangle corners = corners_of(tile, t);
        const std::size_t a = smallest_corner(corners);
        const TileVertex p = t[a], q = t[(a + 1) % 3];
        if (hash_of(corners) % 4 != 0 || names_at(corners[a]).size() < 2)
          continue;
        if (!tile.mesh.is_own(p) && !tile.mesh.is_own(q))
          continue;
        Wedged& to = tile.mesh.is_own(p) && tile.mesh.is_own(q) ? interior : border;
        to.triangles.push_back({p, p, q});
        to.wedges.push_back({0, 1, 0});
      }
    }
  }

  void add_vertices(PublishedTile& tile, const Wedged& border) const {
    TileMesh& mesh = tile.mesh;
    std::map<std::uint32_t, std::set<std::uint32_t>> used;  // copies of ghosts only
    for (std::size_t t = 0; t < border.triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (!mesh.is_own(border.triangles[t][i]) && border.wedges[t][i] > 0)
          used[raw(border.triangles[t][i])].insert(border.wedges[t][i]);
      }
    }
    mesh.copies.vertices.channels = channels_;
    for (std::uint32_t place = 0; place < mesh.vertices.size(); ++place) {
      const auto names = names_at(corner_of(tile, static_cast<TileVertex>(place)));
      const std::vector<float> base(mesh.vertices.attributes_of(place).begin(),
                                    mesh.vertices.attributes_of(place).end());
      const std::vector<float> first = called(base, *names.begin());
      std::copy(first.begin(), first.end(),
                mesh.vertices.attributes.begin() + static_cast<std::ptrdiff_t>(place) * channels_);
      std::uint32_t wedge = 0;
      for (const std::uint32_t name : names) {
        const bool is_here = place < mesh.own_count || used[place].contains(wedge);
        if (wedge++ == 0 || !is_here)
          continue;
        mesh.copies.vertices.append(mesh.vertices.positions[place], called(base, name));
        mesh.copies.places.push_back(place);
        if (place >= mesh.own_count)
          mesh.ghost_wedges.push_back(wedge - 1);
      }
    }
  }

  std::vector<float> called(std::vector<float> attributes, std::uint32_t name) const {
    if (!attributes.empty() && !options_.equal)
      attributes[0] = std::fmod(attributes[0] + 60 * static_cast<float>(name), 256.0F);
    return attributes;
  }

  /// Wedges as the tile itself numbers them.
  static void number(const PublishedTile& tile, Wedged& list, bool is_partition) {
    const TileMesh& mesh = tile.mesh;
    const std::size_t own = mesh.copies.first_of(mesh.own_count);
    for (std::size_t t = 0; t < list.triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        std::uint32_t& wedge = list.wedges[t][i];
        const std::uint32_t place = raw(list.triangles[t][i]);
        if (wedge == 0 || place < mesh.own_count)
          continue;
        const auto first = mesh.ghost_wedges.begin() +
                           static_cast<std::ptrdiff_t>(mesh.copies.first_of(place) - own);
        wedge =
            static_cast<std::uint32_t>(std::find(first, mesh.ghost_wedges.end(), wedge) - first) +
            1;
      }
    }
    normalize_triangles(list.triangles, list.wedges, !is_partition);
  }

  CopiesOptions options_;
  int channels_;
  std::map<CornerId, std::set<std::uint32_t>> names_;
};

void renew_record(const Tree& tree, const PublishedTile& tile, TileRecord& record) {
  const TileMesh& mesh = tile.mesh;
  record.copy_count = static_cast<std::uint32_t>(mesh.copies.size());
  record.interior_count = static_cast<std::uint32_t>(mesh.interior.size());
  record.border_count = static_cast<std::uint32_t>(mesh.border.size());
  record.drawn_border_count = drawn_border_count(tree, tile.node, mesh);
  if (tree.is_partition(tile.node))
    record.compactness = partition::published_compactness(mesh);
}

/// Joins the partitions' own vertices and the triangles that they draw.
class Joined {
 public:
  explicit Joined(const Sample& sample) : sample_(sample) {}

  WedgedInput make() {
    for (const PublishedTile& tile : sample_.tiles) {
      if (sample_.tree.is_partition(tile.node))
        add_own(tile);
    }
    for (const PublishedTile& tile : sample_.tiles) {
      if (sample_.tree.is_partition(tile.node))
        add_triangles(tile);
    }
    return std::move(input_);
  }

 private:
  using Key = std::array<std::uint32_t, 3>;  ///< partition, place, wedge

  void add_own(const PublishedTile& tile) {
    const TileMesh& mesh = tile.mesh;
    std::uint32_t wedge = 0;
    for (std::uint32_t v = 0; v < mesh.own_count; ++v)
      add({tile.node.index, v, 0}, mesh.vertices, v);
    for (std::size_t i = 0; i < mesh.copies.size() && mesh.copies.places[i] < mesh.own_count; ++i) {
      wedge = i > 0 && mesh.copies.places[i] == mesh.copies.places[i - 1] ? wedge + 1 : 1;
      add({tile.node.index, mesh.copies.places[i], wedge}, mesh.copies.vertices, i);
    }
  }

  void add(const Key& key, const VertexArray& from, std::size_t vertex) {
    numbers_[key] = static_cast<std::uint32_t>(input_.mesh.positions.size());
    input_.mesh.positions.push_back(from.positions[vertex]);
    const auto attributes = from.attributes_of(vertex);
    input_.attributes.insert(input_.attributes.end(), attributes.begin(), attributes.end());
  }

  void add_triangles(const PublishedTile& tile) {
    const TileMesh& mesh = tile.mesh;
    const auto wedges_of = [](const std::vector<CornerWedges>& all, std::size_t i) {
      return all.empty() ? CornerWedges{} : all[i];
    };
    for (std::size_t i = 0; i < mesh.interior.size(); ++i)
      add_triangle(tile, mesh.interior[i], wedges_of(mesh.interior_wedges, i));
    for (std::size_t i = 0; i < mesh.border.size(); ++i) {
      const bool is_drawn = draws(mesh, mesh.border[i], [&](std::size_t ghost) {
        return mesh.ghosts[ghost].tile > tile.node.index;
      });
      if (is_drawn)
        add_triangle(tile, mesh.border[i], wedges_of(mesh.border_wedges, i));
    }
  }

  void add_triangle(const PublishedTile& tile, const TileTriangle& t, const CornerWedges& wedges) {
    const TileMesh& mesh = tile.mesh;
    MeshTriangle& corners = input_.mesh.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      Key key{tile.node.index, raw(t[i]), wedges[i]};
      if (!mesh.is_own(t[i])) {
        const GhostRef& ghost = mesh.ghost(t[i]);
        const std::size_t copy =
            mesh.copies.first_of(raw(t[i])) - mesh.copies.first_of(mesh.own_count);
        key = {ghost.tile, ghost.index,
               wedges[i] == 0 ? 0 : mesh.ghost_wedges[copy + wedges[i] - 1]};
      }
      corners[i] = numbers_.at(key);
    }
  }

  const Sample& sample_;
  WedgedInput input_;
  std::map<Key, std::uint32_t> numbers_;
};

}  // namespace

WedgedInput add_copies(Sample& sample, const CopiesOptions& options) {
  const Tree& tree = sample.tree;
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    Splitter splitter(options, sample.format.attributes.channels());
    for (const PublishedTile& tile : sample.tiles) {
      if (raw(tile.node.level) == level)
        splitter.look_at(tile);
    }
    for (PublishedTile& tile : sample.tiles) {
      if (raw(tile.node.level) != level)
        continue;
      splitter.split(tile, tree.is_partition(tile.node));
      renew_record(tree, tile, sample.record(tile.node));
    }
  }
  WedgedInput input = Joined(sample).make();
  SourceSummary& source = sample.manifest.source;
  source.vertices = input.mesh.positions.size();
  source.triangles = input.mesh.triangles.size();
  source.faces = source.triangles;
  return input;
}

void write_input(const WedgedInput& input, Sample& sample, const std::filesystem::path& path) {
  const auto files = storage::make_posix_file_system();
  const std::shared_ptr<storage::File> file = files->create(path);
  mesh_io::PlyContent content;
  content.attributes = sample.format.attributes;
  content.vertex_count = input.mesh.positions.size();
  content.triangle_count = input.mesh.triangles.size();
  mesh_io::PlyWriter writer(file, content);
  writer.write_vertices(input.mesh.positions, input.attributes);
  writer.write_triangles(input.mesh.triangles);
  writer.finish();
  sample.manifest.source.file_name = path.filename().string();
  sample.manifest.source.file_bytes = file->size();
  sample.manifest.source.checksum =
      storage::FileChecksum(file->size()).complete(*files->open(path), [] {});
}

}  // namespace meshhier::tests
