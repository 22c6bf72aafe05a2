#include "tests/support/sample_hierarchy.h"

#include "base/bounds.h"
#include "hierarchy/cut.h"
#include "partition/compactness.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "storage/format/outline_glb.h"
#include "storage/format/tileset.h"
#include "storage/io/file_checksum.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include <unistd.h>

namespace meshhier::tests {
namespace {

namespace fs = std::filesystem;

/// One level of the whole mesh; vertices are numbered node by node.
struct LevelMesh {
  VertexArray vertices;
  std::vector<std::uint32_t> first;     ///< first one of every node; then the count
  std::vector<MeshTriangle> triangles;  ///< smallest corner first
  std::vector<std::uint32_t> of_rank;   ///< vertex that stands for a rank
  std::vector<std::uint32_t> above;     ///< vertex of the level above that stands for a vertex
  std::vector<std::uint32_t> local;     ///< number in its tile

  std::uint32_t node_of(std::uint32_t vertex) const {
    return static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), vertex) -
                                      first.begin() - 1);
  }
};

MeshTriangle smallest_first(MeshTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

TestMesh rank_along_x(const TestMesh& mesh, std::vector<std::uint32_t>& order) {
  order.resize(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mesh.positions[a].x < mesh.positions[b].x;
  });
  std::vector<std::uint32_t> rank(order.size());
  TestMesh ranked;
  for (std::uint32_t r = 0; r < order.size(); ++r) {
    rank[order[r]] = r;
    ranked.positions.push_back(mesh.positions[order[r]]);
  }
  for (const MeshTriangle& t : mesh.triangles) {
    ranked.triangles.push_back(smallest_first({rank[t[0]], rank[t[1]], rank[t[2]]}));
  }
  return ranked;
}

LevelMesh last_level(const Tree& tree, const TestMesh& ranked, std::vector<float> attributes,
                     int channels) {
  LevelMesh level;
  level.vertices.positions = ranked.positions;
  level.vertices.attributes = std::move(attributes);
  level.vertices.channels = channels;
  for (std::uint32_t p = 0; p < tree.partition_count(); ++p) {
    level.first.push_back(static_cast<std::uint32_t>(tree.ranks(NodeId{tree.depth(), p}).begin));
  }
  level.first.push_back(static_cast<std::uint32_t>(ranked.positions.size()));
  level.triangles = ranked.triangles;
  std::sort(level.triangles.begin(), level.triangles.end());
  level.of_rank.resize(ranked.positions.size());
  std::iota(level.of_rank.begin(), level.of_rank.end(), 0U);
  return level;
}

/// Appends the vertices of one node of the level above `fine`, made of [begin, end) there.
void contract(LevelMesh& fine, LevelMesh& coarse, std::uint32_t begin, std::uint32_t end,
              std::uint32_t target, bool scatter) {
  const std::uint32_t count = end - begin;
  const auto base = static_cast<std::uint32_t>(coarse.vertices.size());
  if (target == count) {  // a copy, bit for bit
    for (std::uint32_t k = 0; k < count; ++k)
      fine.above[begin + k] = base + k;
    return coarse.vertices.append(fine.vertices, begin, end);
  }
  const auto channels = static_cast<std::size_t>(fine.vertices.channels);
  std::vector<Vec3d> sums(target);
  std::vector<double> attributes(target * channels), weights(target);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t vertex = begin + k;
    const std::uint32_t group =
        scatter ? k % target : static_cast<std::uint32_t>(std::uint64_t{k} * target / count);
    fine.above[vertex] = base + group;
    sums[group] = sums[group] + to_double(fine.vertices.positions[vertex]);
    weights[group] += 1;
    for (std::size_t c = 0; c < channels; ++c) {
      attributes[group * channels + c] += double{fine.vertices.attributes_of(vertex)[c]};
    }
  }
  for (std::uint32_t g = 0; g < target; ++g) {
    std::vector<float> mean;
    for (std::size_t c = 0; c < channels; ++c) {
      mean.push_back(std::round(static_cast<float>(attributes[g * channels + c] / weights[g])));
    }
    coarse.vertices.append(to_float(sums[g] * (1 / weights[g])), mean);
  }
}

LevelMesh level_above(const Tree& tree, Level level, LevelMesh& fine,
                      const SampleOptions& options) {
  LevelMesh coarse;
  coarse.vertices.channels = fine.vertices.channels;
  fine.above.resize(fine.vertices.size());
  for (std::uint32_t i = 0; i < tree.node_count(level); ++i) {
    const auto children = tree.children({level, i});
    const std::uint32_t begin = fine.first[children.nodes[0].index];
    const std::uint32_t end = fine.first[children.span().back().index + 1];
    coarse.first.push_back(static_cast<std::uint32_t>(coarse.vertices.size()));
    const bool early = tree.is_early({level, i});
    const std::uint32_t target = early ? end - begin : std::min(end - begin, options.tile_vertices);
    contract(fine, coarse, begin, end, target, options.scatter && !early);
  }
  coarse.first.push_back(static_cast<std::uint32_t>(coarse.vertices.size()));
  for (const MeshTriangle& t : fine.triangles) {
    const MeshTriangle image = {fine.above[t[0]], fine.above[t[1]], fine.above[t[2]]};
    if (image[0] == image[1] || image[1] == image[2] || image[2] == image[0])
      continue;
    coarse.triangles.push_back(smallest_first(image));
  }
  std::sort(coarse.triangles.begin(), coarse.triangles.end());
  coarse.triangles.erase(std::unique(coarse.triangles.begin(), coarse.triangles.end()),
                         coarse.triangles.end());
  for (std::uint32_t vertex : fine.of_rank)
    coarse.of_rank.push_back(fine.above[vertex]);
  return coarse;
}

/// Numbers the vertices within their tiles: those of border triangles first.
void number_locally(LevelMesh& level) {
  std::vector<bool> boundary(level.vertices.size());
  for (const MeshTriangle& t : level.triangles) {
    const std::uint32_t a = level.node_of(t[0]), b = level.node_of(t[1]), c = level.node_of(t[2]);
    if (a == b && b == c)
      continue;
    for (std::uint32_t v : t)
      boundary[v] = true;
  }
  level.local.resize(level.vertices.size());
  for (std::size_t node = 0; node + 1 < level.first.size(); ++node) {
    std::uint32_t next = 0;
    for (bool wanted : {true, false}) {
      for (std::uint32_t v = level.first[node]; v < level.first[node + 1]; ++v) {
        if (boundary[v] == wanted)
          level.local[v] = next++;
      }
    }
  }
}

/// An early node's vertices are its partition's, in that order.
void number_early(const Tree& tree, const LevelMesh& last, LevelMesh& above) {
  const Level level = coarser(tree.depth());
  for (std::uint32_t i = 0; i < tree.node_count(level); ++i) {
    if (!tree.is_early({level, i}))
      continue;
    const std::uint32_t partition = tree.partitions({level, i}).begin;
    for (std::uint32_t v = above.first[i]; v < above.first[i + 1]; ++v) {
      above.local[v] = last.local[last.first[partition] + (v - above.first[i])];
    }
  }
}

/// Makes tiles from all levels.
class TileMaker {
 public:
  TileMaker(const Tree& tree, const std::vector<LevelMesh>& levels)
      : tree_(tree), levels_(levels) {}

  PublishedTile make(NodeId node) const {
    const LevelMesh& level = levels_[raw(node.level)];
    PublishedTile tile;
    tile.node = node;
    tile.mesh.own_count = level.first[node.index + 1] - level.first[node.index];
    tile.mesh.vertices.channels = level.vertices.channels;
    add_own(level, tile);
    const auto ghosts = add_ghosts(level, tile);
    add_triangles(level, ghosts, tile);
    return tile;
  }

 private:
  bool is_own(const LevelMesh& level, NodeId node, std::uint32_t v) const {
    return v >= level.first[node.index] && v < level.first[node.index + 1];
  }
  bool is_border(const LevelMesh& level, NodeId node, const MeshTriangle& t) const {
    const auto own =
        std::count_if(t.begin(), t.end(), [&](std::uint32_t v) { return is_own(level, node, v); });
    return own == 1 || own == 2;
  }

  void add_own(const LevelMesh& level, PublishedTile& tile) const {
    std::vector<std::uint32_t> by_local(tile.mesh.own_count);
    const std::uint32_t first = level.first[tile.node.index];
    for (std::uint32_t v = first; v < first + tile.mesh.own_count; ++v)
      by_local[level.local[v]] = v;
    for (std::uint32_t v : by_local) {
      tile.mesh.vertices.append(level.vertices, v, v + 1);
      if (raw(tile.node.level) == 0)
        continue;
      const bool early = tree_.is_early(tree_.parent(tile.node));
      const std::uint32_t parent =
          early ? levels_[raw(tile.node.level) - 1U].above[level.above[v]] : level.above[v];
      const LevelMesh& above = levels_[raw(tile.node.level) - (early ? 2U : 1U)];
      tile.parent_map.push_back(static_cast<std::uint16_t>(above.local[parent]));
    }
  }

  std::vector<std::uint16_t> chain(NodeId node, NodeId neighbour, std::uint32_t vertex) const {
    std::vector<std::uint16_t> chain;
    for (int step = 0; step < tree_.chain_length(node, neighbour); ++step) {
      const LevelMesh& level = levels_[static_cast<std::size_t>(raw(node.level) - step)];
      chain.push_back(static_cast<std::uint16_t>(level.local[vertex]));
      if (raw(node.level) > step)
        vertex = level.above[vertex];
    }
    return chain;
  }

  /// The foreign vertices in the order of their references.
  std::vector<std::pair<GhostRef, std::uint32_t>> add_ghosts(const LevelMesh& level,
                                                             PublishedTile& tile) const {
    std::set<std::pair<GhostRef, std::uint32_t>> ghosts;
    std::set<std::uint32_t> boundary;
    for (const MeshTriangle& t : level.triangles) {
      if (!is_border(level, tile.node, t))
        continue;
      for (std::uint32_t v : t) {
        if (is_own(level, tile.node, v)) {
          boundary.insert(v);
        } else {
          ghosts.insert({{level.node_of(v), level.local[v]}, v});
        }
      }
    }
    tile.mesh.boundary_count = static_cast<std::uint32_t>(boundary.size());
    for (const auto& [reference, vertex] : ghosts) {
      tile.mesh.ghosts.push_back(reference);
      tile.mesh.vertices.append(level.vertices, vertex, vertex + 1);
      tile.chains.add(chain(tile.node, {tile.node.level, reference.tile}, vertex));
    }
    return {ghosts.begin(), ghosts.end()};
  }

  void add_triangles(const LevelMesh& level,
                     const std::vector<std::pair<GhostRef, std::uint32_t>>& ghosts,
                     PublishedTile& tile) const {
    const auto number = [&](std::uint32_t v) {
      if (is_own(level, tile.node, v))
        return static_cast<TileVertex>(level.local[v]);
      const std::pair<GhostRef, std::uint32_t> key{{level.node_of(v), level.local[v]}, v};
      const auto found = std::lower_bound(ghosts.begin(), ghosts.end(), key);
      return static_cast<TileVertex>(tile.mesh.own_count + (found - ghosts.begin()));
    };
    for (const MeshTriangle& t : level.triangles) {
      const TileTriangle triangle = {number(t[0]), number(t[1]), number(t[2])};
      if (is_border(level, tile.node, t)) {
        tile.mesh.border.push_back(triangle);
      } else if (is_own(level, tile.node, t[0])) {
        tile.mesh.interior.push_back(triangle);
      }
    }
    normalize_triangles(tile.mesh.interior, false);
    normalize_triangles(tile.mesh.border, false);
  }

  const Tree& tree_;
  const std::vector<LevelMesh>& levels_;
};

std::uint32_t drawn_count(const Tree& tree, const PublishedTile& tile) {
  std::uint32_t drawn = 0;
  for (const TileTriangle& t : tile.mesh.border) {
    bool ours = true;
    for (TileVertex v : t) {
      if (tile.mesh.is_own(v))
        continue;
      const NodeId other{tile.node.level, tile.mesh.ghost(v).tile};
      ours = ours && tile.node.index < other.index && !tree.is_early(other);
    }
    if (ours)
      ++drawn;
  }
  return drawn;
}

TileRecord make_record(const Tree& tree, const PublishedTile& tile, const SampleOptions& options) {
  TileRecord record;
  record.node = tile.node;
  record.own_count = tile.mesh.own_count;
  record.boundary_count = tile.mesh.boundary_count;
  record.ghost_count = static_cast<std::uint32_t>(tile.mesh.ghosts.size());
  record.copy_count = static_cast<std::uint32_t>(tile.mesh.copies.size());
  record.split_count = static_cast<std::uint32_t>(tile.shading.split_of.size());
  record.interior_count = static_cast<std::uint32_t>(tile.mesh.interior.size());
  record.border_count = static_cast<std::uint32_t>(tile.mesh.border.size());
  record.drawn_border_count = drawn_count(tree, tile);
  const bool partition = tree.is_partition(tile.node);
  record.target_count = partition ? tile.mesh.own_count : options.tile_vertices;
  record.bounds = bounds_of(tile.mesh.vertices.positions);
  const int height = raw(tree.depth()) - raw(tile.node.level);
  record.error = static_cast<float>(height) * 0.25F;
  record.bound = static_cast<float>(height) * 0.5F;
  if (partition)
    record.compactness = partition::published_compactness(tile.mesh);
  return record;
}

std::vector<float> colours_of(const std::vector<std::uint32_t>& order) {
  std::vector<float> colours;
  for (std::uint32_t vertex : order) {
    for (std::uint64_t c = 0; c < 3; ++c) {
      colours.push_back(std::floor(std::abs(hash_noise(vertex, c)) * 255));
    }
  }
  return colours;
}

constexpr Standpoint kFirstView{30, 15};

storage::Manifest make_manifest(const Sample& sample, const fs::path& source) {
  storage::Manifest manifest;
  manifest.generator = "sample";
  manifest.source.file_name = source.filename().string();
  if (!source.empty()) {
    std::ifstream in(source, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    manifest.source.file_bytes = bytes.size();
    storage::FileChecksum checksum(bytes.size());
    checksum.add(0, std::as_bytes(std::span(bytes)));
    const auto file = storage::make_posix_file_system()->open(source);
    manifest.source.checksum = checksum.complete(*file, [] {});
  }
  manifest.source.vertices = sample.ranked.positions.size();
  manifest.source.places = manifest.source.vertices;
  manifest.source.triangles = sample.ranked.triangles.size();
  manifest.source.faces = sample.ranked.triangles.size();
  manifest.source.attributes = sample.format.attributes;
  std::set<std::uint32_t> used;
  for (const MeshTriangle& t : sample.ranked.triangles)
    used.insert(t.begin(), t.end());
  manifest.source.unreferenced_vertices = manifest.source.vertices - used.size();
  for (Vec3f p : sample.ranked.positions) {
    manifest.source.bounds.add(to_double(p) + sample.format.frame.origin);
  }
  manifest.origin = sample.format.frame.origin;
  manifest.up = sample.format.frame.up;
  manifest.first_view = kFirstView;
  manifest.partition_count = sample.tree.partition_count();
  manifest.config = {{"partition", {{"count", sample.tree.partition_count()}}}};
  manifest.levels = nlohmann::ordered_json::array();
  return manifest;
}

Outline square() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {2, 2, 2}, {3, 2, 2}}, {0, 5, 7}};
}

template <class Items>
auto& at_node(Items& items, NodeId node) {
  return *std::find_if(items.begin(), items.end(), [&](const auto& i) { return i.node == node; });
}

}  // namespace

PublishedTile& Sample::tile(NodeId node) {
  return at_node(tiles, node);
}
TileRecord& Sample::record(NodeId node) {
  return at_node(records, node);
}

Sample make_sample(const TestMesh& mesh, const SampleOptions& options, const fs::path& source) {
  std::vector<std::uint32_t> order;
  const TestMesh ranked = rank_along_x(mesh, order);
  const Tree tree(ranked.positions.size(), options.partitions);
  Sample sample{.tree = tree,
                .format = {},
                .tiles = {},
                .records = {},
                .manifest = {},
                .ranked = ranked,
                .attributes = {},
                .local = {}};
  sample.format.frame.origin = options.origin;
  if (options.colours) {
    sample.format.attributes.colour = ColourType::u8;
    sample.attributes = colours_of(order);
  }
  const std::size_t depth = raw(tree.depth());
  std::vector<LevelMesh> levels(depth + 1);
  levels[depth] = last_level(tree, ranked, sample.attributes, sample.format.attributes.channels());
  for (std::size_t l = depth; l-- > 0;) {
    levels[l] = level_above(tree, static_cast<Level>(l), levels[l + 1], options);
  }
  for (LevelMesh& level : levels)
    number_locally(level);
  if (depth > 0)
    number_early(tree, levels[depth], levels[depth - 1]);

  for (std::size_t l = 0; l <= depth; ++l) {
    auto& local = sample.local.emplace_back();
    for (std::uint32_t vertex : levels[l].of_rank)
      local.push_back(levels[l].local[vertex]);
    for (std::uint32_t i = 0; i < tree.node_count(static_cast<Level>(l)); ++i) {
      const NodeId node{static_cast<Level>(l), i};
      if (tree.is_early(node))
        continue;
      sample.tiles.push_back(TileMaker(tree, levels).make(node));
      sample.records.push_back(make_record(tree, sample.tiles.back(), options));
    }
  }
  sample.tile({}).first_view = kFirstView;
  sample.manifest = make_manifest(sample, source);
  return sample;
}

void write_sample(storage::FileSystem& files, const fs::path& directory, Sample& sample) {
  storage::Manifest& manifest = sample.manifest;
  manifest.total_bytes = 0;
  for (std::size_t i = 0; i < sample.tiles.size(); ++i) {
    const PublishedTile& tile = sample.tiles[i];
    const auto bytes = storage::encode_tile(tile, sample.tree, sample.format);
    sample.records[i].file_bytes = bytes.size();
    sample.records[i].checksum = storage::checksum(bytes);
    files.make_directories(storage::level_directory(directory, tile.node.level));
    storage::write_file(files, storage::tile_path(directory, tile.node), bytes);
    manifest.total_bytes += bytes.size();
  }
  const auto index = storage::encode_index(sample.records);
  storage::write_file(files, storage::index_path(directory), index);
  Outline lines = square();
  lines.first_view = manifest.first_view;
  const auto outline = storage::encode_outline(lines, sample.format.frame);
  storage::write_file(files, storage::outline_path(directory), outline);
  manifest.index_bytes = index.size();
  manifest.index_checksum = storage::checksum(index);
  manifest.outline_bytes = outline.size();
  manifest.outline_checksum = storage::checksum(outline);
  manifest.outline.polylines_found = 2;
  manifest.total_bytes += index.size() + outline.size();
  manifest.outline.sector_count = 1;
  manifest.levels = nlohmann::ordered_json::array();
  for (const storage::LevelSummary& level : storage::summarize_levels(sample.tree, sample.records))
    manifest.levels.push_back(storage::to_json(level));
  manifest.tileset_files = manifest.tileset_bytes = 0;
  storage::write_tilesets(files, directory, sample.tree, sample.records, manifest);
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(files, storage::manifest_path(directory), std::as_bytes(std::span(text)));
}

namespace {

/// A file system in memory, where there is one: thousands of small files wait for no disk.
fs::path memory_directory() {
  const fs::path memory = "/dev/shm";
  std::error_code ignored;
  const bool is_free = fs::is_directory(memory, ignored) && ::access(memory.c_str(), W_OK) == 0;
  return is_free ? memory : fs::temp_directory_path();
}

}  // namespace

TemporaryDirectory::TemporaryDirectory(Place place) {
  const fs::path parent = place == Place::memory ? memory_directory() : fs::temp_directory_path();
  std::random_device chance;
  do {
    path_ = parent / ("meshhier-test-" + std::to_string(chance()));
  } while (!fs::create_directory(path_));
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace meshhier::tests
