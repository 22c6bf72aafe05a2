// The promise of progressive streams: with each file a client shows a level of the hierarchy, with
// the last one the original mesh, bit for bit.
#include "progressive/stream.h"

#include "base/error.h"
#include "export/export.h"
#include "hierarchy/detail.h"
#include "mesh_io/mesh_source.h"
#include "progressive/reconstruct.h"
#include "progressive/stream_index.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "tests/support/half_edge_hierarchy.h"
#include "tests/support/memory_files.h"
#include "tests/support/sample_copies.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sizes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using progressive::ProgressiveIndex;
using tests::AttributedMesh;
using tests::kGiB;
using tests::kMiB;
using tests::MemoryFiles;
using tests::node;

/// Corners' places; the least of the three first.
using Place = std::array<double, 3>;
using PlaceTriangle = std::array<Place, 3>;
using PlaceSet = std::set<PlaceTriangle>;

/// Degenerate triangles aside: of no area, as two corners are at one place.
void insert(PlaceSet& set, PlaceTriangle triangle) {
  if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
    return;
  std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
  set.insert(triangle);
}

struct Shown {
  std::vector<Place> vertices;
  std::vector<float> attributes;
  std::vector<Triangle<std::uint32_t>> triangles;

  PlaceSet set() const {
    PlaceSet set;
    for (const auto& t : triangles)
      insert(set, {vertices.at(t[0]), vertices.at(t[1]), vertices.at(t[2])});
    return set;
  }
};

/// All ways of half_edge through the whole of it, with the files in memory.
class ProgressiveTest : public testing::Test {
 protected:
  static constexpr const char* kStream = "/models/mesh.prog";

  void build(const AttributedMesh& mesh, std::uint32_t partitions, std::uint32_t tile_vertices) {
    build(mesh, tests::half_edge_config("/models", partitions, tile_vertices));
  }
  void build(const AttributedMesh& mesh, const config::Config& config) {
    tests::build_half_edge(files_, mesh, config);
    hierarchy_ = config.output;
  }

  storage::HierarchyReader reader() { return {files_, hierarchy_}; }

  ProgressiveIndex stream(std::optional<NodeId> part = {}, std::optional<std::uint32_t> steps = {},
                          std::uint64_t budget = kGiB) {
    progressive::ProgressiveOptions options{part, steps, kStream, true, budget};
    progressive::write_progressive(files_, hierarchy_, options, progress_, cancel_);
    return progressive::read_progressive_index(files_, kStream);
  }

  void reconstruct(std::optional<std::uint32_t> details) {
    progressive::reconstruct(files_, kStream,
                             {.details = details, .output = "/models/out.ply", .replace = true},
                             progress_, cancel_);
  }
  Shown shown(std::optional<std::uint32_t> details) {
    reconstruct(details);
    return load("/models/out.ply");
  }

  Shown exported(const exporting::ExportSelection& selection) {
    exporting::export_mesh(files_, hierarchy_,
                           {.selection = selection, .output = "/models/level.ply", .replace = true},
                           progress_, cancel_);
    return load("/models/level.ply");
  }

  Shown load(const fs::path& path) {
    Shown mesh;
    const auto source = mesh_io::open_mesh(files_, path);
    source->read_vertices([&](const mesh_io::VertexBlock& block) {
      for (const Vec3f& p : block.positions)
        mesh.vertices.push_back({double{p.x}, double{p.y}, double{p.z}});
      for (const Vec3d& p : block.exact)
        mesh.vertices.push_back({p.x, p.y, p.z});
      mesh.attributes.insert(mesh.attributes.end(), block.attributes.begin(),
                             block.attributes.end());
    });
    source->read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
      for (const auto& t : triangles)
        mesh.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
    });
    return mesh;
  }

  /// Without the line that tells who wrote it.
  std::string without_comment(const fs::path& path) {
    std::string text = files_.content(path);
    const std::size_t place = text.find("comment ");
    return text.erase(place, text.find('\n', place) + 1 - place);
  }

  /// Checks the promises of each file of the stream.
  void expect_levels(const ProgressiveIndex& index) {
    for (std::uint32_t details = 0; details < index.files.size(); ++details) {
      SCOPED_TRACE("after " + std::to_string(details) + " details");
      const progressive::ProgressiveFile& file = index.files[details];
      const Shown ours = shown(details);
      const Shown theirs = exported(file.level);
      EXPECT_EQ(ours.set(), theirs.set());
      EXPECT_EQ(ours.vertices.size(), theirs.vertices.size());
      EXPECT_EQ(file.shown_vertices, ours.vertices.size());
      EXPECT_EQ(file.shown_triangles, ours.triangles.size());
    }
    EXPECT_EQ(index.files.back().level, reader().tree().depth());
    expect_original();
  }

  void expect_original() {
    reconstruct(std::nullopt);
    exporting::export_mesh(
        files_, hierarchy_,
        {.selection = reader().tree().depth(), .output = "/models/level.ply", .replace = true},
        progress_, cancel_);
    EXPECT_TRUE(without_comment("/models/out.ply") == without_comment("/models/level.ply"));
  }

  void expect_all_steps() {
    const auto levels = static_cast<std::uint32_t>(raw(reader().tree().depth()));
    expect_levels(stream());
    for (std::uint32_t steps = 1; steps <= levels; ++steps) {
      SCOPED_TRACE("--steps " + std::to_string(steps));
      const ProgressiveIndex index = stream({}, steps);
      EXPECT_EQ(index.files.size(), steps + 1);
      expect_levels(index);
    }
  }

  /// Vertices of a level's export that are the sector's, whose tiles come one after another.
  std::pair<std::uint64_t, std::uint64_t> vertices_of(NodeId sector, Level level) {
    const storage::HierarchyReader from = reader();
    const Tree& tree = from.tree();
    const PartitionRange whole = tree.partitions(sector);
    std::uint64_t begin = 0, end = 0;
    for (std::uint32_t partition = 0; partition < whole.end;) {
      const NodeId tile = tree.ancestor({tree.depth(), partition}, level);
      (partition < whole.begin ? begin : end) += from.record(tile).own_count;
      partition = tree.partitions(tile).end;
    }
    return {begin, begin + end};
  }

  /// Returns a level's triangles that touch the sector.
  PlaceSet touching(NodeId sector, Level level) {
    const Shown whole = exported(level);
    const auto [begin, end] = vertices_of(sector, level);
    PlaceSet set;
    for (const auto& t : whole.triangles) {
      if (std::ranges::any_of(t, [&](std::uint32_t v) { return v >= begin && v < end; }))
        insert(set, {whole.vertices[t[0]], whole.vertices[t[1]], whole.vertices[t[2]]});
    }
    return set;
  }

  /// Returns the triangles that the tiles of a level show together, border triangles and all.
  /// Requires that none is early.
  PlaceSet tiles_below(NodeId sector, Level level) {
    const int below = raw(level) - raw(sector.level);
    PlaceSet set;
    for (std::uint32_t i = sector.index << below; i < (sector.index + 1) << below; ++i)
      set.merge(exported(NodeId{level, i}).set());
    return set;
  }

  /// A sector on its own.
  void expect_sector(NodeId sector) {
    SCOPED_TRACE(std::to_string(raw(sector.level)) + "/" + std::to_string(sector.index));
    const ProgressiveIndex index = stream(sector);
    const Tree tree = reader().tree();
    EXPECT_EQ(index.node, tree.tile_node(sector));
    EXPECT_EQ(index.own_vertices, tree.ranks(sector).size());
    EXPECT_EQ(shown(0).set(), exported(sector).set());
    for (std::uint32_t details = 0; details < index.files.size(); ++details) {
      SCOPED_TRACE("after " + std::to_string(details) + " details");
      const progressive::ProgressiveFile& file = index.files[details];
      const Shown ours = shown(details);
      EXPECT_EQ(ours.set(), touching(sector, file.level));
      EXPECT_EQ(file.shown_vertices, ours.vertices.size());
      EXPECT_EQ(file.shown_triangles, ours.triangles.size());
    }
    expect_own_vertices_first(sector, index);
  }

  /// The original's vertices of the sector, by rank, with all that they carry.
  void expect_own_vertices_first(NodeId sector, const ProgressiveIndex& index) {
    const Shown ours = shown(std::nullopt);
    const Shown whole = exported(reader().tree().depth());
    const auto first = static_cast<std::size_t>(reader().tree().ranks(sector).begin);
    const auto channels = static_cast<std::size_t>(index.source.attributes.channels());
    ASSERT_EQ(ours.vertices.size(), index.vertices);
    for (std::size_t v = 0; v < index.own_vertices; ++v) {
      ASSERT_EQ(ours.vertices[v], whole.vertices[first + v]);
      for (std::size_t c = 0; c < channels; ++c) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(ours.attributes[v * channels + c]),
                  std::bit_cast<std::uint32_t>(whole.attributes[(first + v) * channels + c]));
      }
    }
  }

  void expect_sectors() {
    const Tree tree = reader().tree();
    for (int level = 0; level <= raw(tree.depth()); ++level) {
      const std::uint32_t nodes = tree.node_count(static_cast<Level>(level));
      for (std::uint32_t i = 0; i < nodes; i += 1 + nodes / 5)
        expect_sector(node(level, i));
    }
  }

  /// Every early node, of which there must be some.
  void expect_early_sectors() {
    const Tree tree = reader().tree();
    const Level above = coarser(tree.depth());
    int count = 0;
    for (std::uint32_t i = 0; i < tree.node_count(above); ++i) {
      if (tree.is_early({above, i})) {
        expect_sector({above, i});
        ++count;
      }
    }
    EXPECT_GT(count, 0);
  }

  std::vector<std::string> contents() {
    std::vector<std::string> all;
    for (const fs::path& path : files_.list(kStream))
      all.push_back(path.filename().string() + files_.content(path));
    return all;
  }

  MemoryFiles files_;
  execution::NoProgress progress_;
  execution::CancelToken cancel_;
  fs::path hierarchy_;
};

AttributedMesh plain(tests::TestMesh shape) {
  return {std::move(shape), {}, {}, {}};
}

tests::TestMesh joined(tests::TestMesh a, const tests::TestMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles)
    a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return a;
}

/// Many vertices at few places, and triangles without area.
tests::TestMesh snapped(tests::TestMesh mesh) {
  for (Vec3f& p : mesh.positions)
    p = {std::round(p.x * 6) / 6, std::round(p.y * 6) / 6, std::round(p.z * 6) / 6};
  return mesh;
}

struct Shape {
  const char* name;
  std::function<tests::TestMesh()> make;
};

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all = {
      {"closed", [] { return tests::torus(1200, 0.02F); }},
      {"shuffled", [] { return tests::shuffled(tests::sphere(900, 0.02F), 3); }},
      {"bordered", [] { return tests::open_grid(24, 20, 0.3F); }},
      {"moebius", [] { return tests::moebius(900); }},
      {"non-manifold", [] { return tests::non_manifold(900); }},
      {"duplicates", [] { return tests::duplicates(900); }},
      {"degenerate", [] { return snapped(tests::torus(1200)); }},
      {"degenerate duplicates", [] { return snapped(tests::duplicates(900)); }},
      {"soup", [] { return tests::soup(150); }},
      {"isolated vertices", [] { return joined(tests::sphere(600), tests::points(200)); }},
      {"points", [] { return tests::points(300); }}};
  return all;
}

TEST_F(ProgressiveTest, EveryDetailShowsItsLevelOfAnyMesh) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    for (const std::uint32_t partitions : {4U, 11U}) {
      SCOPED_TRACE(partitions);
      build(plain(shape.make()), partitions, 30);
      expect_levels(stream());
    }
  }
}

TEST_F(ProgressiveTest, AnyNumberOfStepsShowsTheLevelsItNames) {
  build(plain(tests::torus(1500, 0.02F)), 20, 25);
  expect_all_steps();
  build(plain(snapped(tests::duplicates(900))), 13, 25);
  expect_all_steps();
}

TEST_F(ProgressiveTest, AnyNumberOfPartitionsIsStreamed) {
  for (const std::uint32_t partitions : {1U, 2U, 3U, 5U, 6U, 7U, 17U, 33U, 100U}) {
    SCOPED_TRACE(partitions);
    build(plain(tests::sphere(800, 0.02F)), partitions, 12);
    expect_levels(stream());
  }
}

TEST_F(ProgressiveTest, APartitionAloneIsABaseWithoutDetails) {
  build(plain(tests::sphere(300)), 1, 30);
  const ProgressiveIndex index = stream();
  EXPECT_EQ(index.files.size(), 1U);
  expect_original();
  build(plain({{{1, 2, 3}}, {}}), 1, 4);
  EXPECT_EQ(stream().vertices, 1U);
  expect_original();
}

TEST_F(ProgressiveTest, ListsOfSeveralRunsAreStreamed) {
  build(tests::attributed(tests::sphere(300'000, 0.001F), {false, ColourType::u8, false, false}), 8,
        10'000);
  const ProgressiveIndex index = stream({}, 1);
  EXPECT_GT(index.files[1].vertices, 2 * kRunEntries);
  EXPECT_GT(index.files[1].triangles, 4 * kRunEntries);
  EXPECT_EQ(shown(0).set(), exported(Level{0}).set());
  expect_original();
}

TEST_F(ProgressiveTest, BothCostsMakeStreams) {
  for (const auto& cost : config::kHalfEdgeCosts) {
    SCOPED_TRACE(cost.name);
    config::Config config = tests::half_edge_config("/models", 9, 40);
    config.simplify.cost = cost.value;
    for (const auto& mesh : {tests::torus(1500, 0.03F), tests::duplicates(900)}) {
      build(plain(mesh), config);
      expect_levels(stream());
    }
  }
}

TEST_F(ProgressiveTest, AttributesOfEveryKindComeBackBitForBit) {
  const std::vector<AttributeLayout> layouts = {
      {true, ColourType::none, false, false}, {false, ColourType::u8, false, false},
      {true, ColourType::u8, true, true},     {false, ColourType::u16, true, false},
      {true, ColourType::f32, true, true},    {false, ColourType::none, false, true}};
  for (std::size_t i = 0; i < layouts.size(); ++i) {
    SCOPED_TRACE(i);
    build(tests::attributed(tests::duplicates(900, 0.01F), layouts[i]), 6, 40);
    expect_levels(stream());
    expect_sector(node(1, 1));
  }
}

TEST_F(ProgressiveTest, DoubleCoordinatesKeepTheirOrigin) {
  build(tests::far_away(tests::torus(1200, 0.02F)), 7, 40);
  const ProgressiveIndex index = stream();
  EXPECT_NE(index.origin, Vec3d{});
  expect_levels(index);
}

TEST_F(ProgressiveTest, RoundedPositionsAreStreamedAsTheyAre) {
  for (const std::uint32_t bits : {8U, 14U}) {
    for (const bool packed : {false, true}) {
      config::Config config = tests::half_edge_config("/models", 6, 50);
      config.storage.position_bits = bits;
      config.storage.compression =
          packed ? storage::Compression::meshopt_zlib : storage::Compression::none;
      build(plain(tests::torus(1200, 0.02F)), config);
      expect_levels(stream());
    }
  }
}

// ---- sectors ---------------------------------------------------------------------------------

TEST_F(ProgressiveTest, ASectorShowsItsTilesAndTheirBorders) {
  build(plain(tests::torus(1200, 0.02F)), 16, 25);
  expect_sectors();
}

TEST_F(ProgressiveTest, ASectorOfAnyMeshStandsAlone) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    build(plain(shape.make()), 11, 25);
    expect_sector(node(1, 0));
    expect_sector(node(2, 2));
    expect_sector(node(4, 7));
    expect_early_sectors();
  }
}

TEST_F(ProgressiveTest, ASectorInFewerStepsShowsTheLevelsItNames) {
  build(plain(tests::sphere(1500, 0.02F)), 21, 25);
  for (const std::uint32_t steps : {1U, 2U, 3U, 4U}) {
    const ProgressiveIndex index = stream(node(1, 1), steps);
    ASSERT_EQ(index.files.size(), steps + 1);
    for (std::uint32_t details = 0; details <= steps; ++details)
      EXPECT_EQ(shown(details).set(), touching(node(1, 1), index.files[details].level));
  }
}

TEST_F(ProgressiveTest, ASectorIsWhatItsTilesShowTogether) {
  build(plain(tests::open_grid(30, 30, 0.3F)), 16, 25);
  for (const NodeId sector : {node(0, 0), node(1, 1), node(2, 1)}) {
    const ProgressiveIndex index = stream(sector);
    for (std::uint32_t details = 0; details < index.files.size(); ++details)
      EXPECT_EQ(shown(details).set(), tiles_below(sector, index.files[details].level));
  }
}

// ---- the same bytes --------------------------------------------------------------------------

TEST_F(ProgressiveTest, SeveralVerticesAtAPlaceAreRefusedBeforeAnyWork) {
  tests::Sample sample = tests::make_sample(tests::sphere(900), {4, 30, false, true, {}});
  tests::add_copies(sample);
  sample.manifest.config["simplify"]["method"] = "half_edge";
  hierarchy_ = "/models/copies.hier";
  tests::write_sample(files_, hierarchy_, sample);
  const std::uint64_t written = files_.counters().bytes_written;
  try {
    stream();
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(),
                testing::StartsWith("/models/copies.hier has several vertices at one place"));
    EXPECT_THAT(error.what(), testing::HasSubstr("\"topology\": \"index\""));
  }
  EXPECT_EQ(files_.counters().bytes_written, written);
  EXPECT_FALSE(files_.exists(kStream));
}

TEST_F(ProgressiveTest, ThreadsAndMemoryDoNotMatter) {
  build(tests::attributed(tests::torus(2500, 0.02F), {true, ColourType::u8, false, false}), 40, 50);
  for (const std::optional<NodeId> part : {std::optional<NodeId>(), std::optional(node(1, 1))}) {
    std::uint64_t refused = 0, accepted = kGiB;
    while (accepted - refused > 1) {
      const std::uint64_t middle = (refused + accepted) / 2;
      bool enough = true;
      try {
        stream(part, {}, middle);
      } catch (const Error& error) {
        ASSERT_EQ(error.code(), ErrorCode::budget) << error.what();
        enough = false;
      }
      (enough ? accepted : refused) = middle;
    }
    stream(part);
    const std::vector<std::string> expected = contents();
    for (const std::uint64_t budget : {accepted, 64 * kMiB, kGiB}) {
      for (const int threads : {1, 4}) {
        const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
        tbb::task_arena arena(threads);
        arena.execute([&] { stream(part, {}, budget); });
        EXPECT_TRUE(contents() == expected) << budget << " bytes, " << threads << " threads";
      }
    }
  }
}

}  // namespace
}  // namespace meshhier::pipeline
