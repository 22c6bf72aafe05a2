// A hierarchy made in code, in memory, by the shortest way: what the published form means, written
// down once more and independently of the stages that build real ones.
//
// Vertices are ranked along x, simplification merges runs of the children's vertices. That makes
// poor meshes, but every promise about seams must hold for any merging.
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "storage/format/manifest.h"
#include "storage/format/tile_glb.h"
#include "storage/io/file.h"
#include "tests/support/meshes.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::tests {

constexpr NodeId node(int level, std::uint32_t index) {
  return {static_cast<Level>(level), index};
}

struct SampleOptions {
  std::uint32_t partitions = 7;
  std::uint32_t tile_vertices = 40;  ///< vertices of simplified tiles
  bool scatter = false;              ///< merge vertices far from each other
  bool colours = false;              ///< give every vertex an 8-bit colour
  Vec3d origin{};
};

struct Sample {
  Tree tree;
  storage::TileFormat format;
  std::vector<PublishedTile> tiles;  ///< ascending by node, like the records
  std::vector<TileRecord> records;   ///< file sizes and checksums are filled in by write_sample()
  storage::Manifest manifest;        ///< likewise
  TestMesh ranked;                   ///< the input, vertices by rank
  std::vector<float> attributes;     ///< the input's, by rank
  /// [level][rank]: vertex of the tile of the node of that level that holds the rank.
  std::vector<std::vector<std::uint32_t>> local;

  PublishedTile& tile(NodeId node);
  TileRecord& record(NodeId node);
};

/// Requires at least options.partitions vertices. `source`: the mesh file that manifest.source
/// names.
Sample make_sample(const TestMesh& mesh, const SampleOptions& options = {},
                   const std::filesystem::path& source = {});

/// Publishes the sample in a directory that is not there yet.
void write_sample(storage::FileSystem& files, const std::filesystem::path& directory,
                  Sample& sample);

/// A directory of its own for each test; removed at the end.
class TemporaryDirectory {
 public:
  enum class Place { disk, memory };
  explicit TemporaryDirectory(Place place = Place::disk);
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace meshhier::tests
