#include "storage/format/hierarchy_reader.h"

#include "base/bounds.h"
#include "base/error.h"
#include "gltf/sample_hierarchy.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/outline_glb.h"
#include "storage/io/file.h"
#include "storage/io/forwarding_files.h"
#include "storage/io/hash.h"

#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

namespace fs = std::filesystem;
using storage::HierarchyReader;
using storage::Manifest;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

class HierarchyReaderTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ =
        fs::path(testing::TempDir()) / fmt::format("meshhier_reader_{}", std::random_device{}());
    files_->make_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  void write(const SampleHierarchy& sample) {
    Manifest manifest;
    std::vector<TileRecord> records;
    manifest.first_view = outline_.first_view = Standpoint{30, 15};
    for (PublishedTile tile : sample.tiles) {
      if (tile.node == sample.tree.root())
        tile.first_view = manifest.first_view;
      records.push_back(write_tile(sample, tile));
    }
    for (const TileRecord& record : records)
      manifest.total_bytes += record.file_bytes;
    const Bytes index = storage::encode_index(records);
    const Bytes outline = storage::encode_outline(outline_, sample.format.frame);
    manifest.source.vertices = sample.tree.vertex_count();
    manifest.source.places = sample.tree.vertex_count();
    manifest.source.bounds = {{0, 0, 0}, {1, 1, 1}};
    manifest.source.attributes = sample.format.attributes;
    manifest.computed_normals = sample.format.computed_normals;
    manifest.origin = sample.format.frame.origin;
    manifest.partition_count = sample.tree.partition_count();
    manifest.config = nlohmann::ordered_json::object();
    manifest.levels = nlohmann::ordered_json::array();
    manifest.index_bytes = index.size();
    manifest.index_checksum = storage::checksum(index);
    manifest.outline_bytes = outline.size();
    manifest.outline_checksum = storage::checksum(outline);
    const std::string text = storage::to_json_text(manifest);
    storage::write_file(*files_, storage::index_path(directory_), index);
    storage::write_file(*files_, storage::outline_path(directory_), outline);
    storage::write_file(*files_, storage::manifest_path(directory_),
                        std::as_bytes(std::span(text)));
  }

  TileRecord write_tile(const SampleHierarchy& sample, const PublishedTile& tile) {
    const Bytes bytes = storage::encode_tile(tile, sample.tree, sample.format);
    fs::create_directories(storage::level_directory(directory_, tile.node.level));
    storage::write_file(*files_, storage::tile_path(directory_, tile.node), bytes);
    TileRecord record;
    record.node = tile.node;
    record.own_count = tile.mesh.own_count;
    record.boundary_count = tile.mesh.boundary_count;
    record.ghost_count = static_cast<std::uint32_t>(tile.mesh.ghosts.size());
    record.copy_count = static_cast<std::uint32_t>(tile.mesh.copies.size());
    record.split_count = static_cast<std::uint32_t>(tile.shading.split_of.size());
    record.interior_count = static_cast<std::uint32_t>(tile.mesh.interior.size());
    record.border_count = static_cast<std::uint32_t>(tile.mesh.border.size());
    record.bounds = bounds_of(tile.mesh.vertices.positions);
    record.file_bytes = bytes.size();
    record.checksum = storage::checksum(bytes);
    return record;
  }

  HierarchyReader reader() { return {*files_, directory_}; }

  /// Flips one bit in the middle of the file.
  void damage(const fs::path& path) {
    Bytes bytes = storage::read_file(*files_, path, 1 << 20);
    bytes[bytes.size() / 2] ^= std::byte{4};
    storage::write_file(*files_, path, bytes);
  }

  void cut(const fs::path& path) { fs::resize_file(path, fs::file_size(path) - 1); }

  template <class Action>
  void expect_failure(ErrorCode code, const fs::path& path, const char* what, Action&& action) {
    try {
      action();
      ADD_FAILURE() << "expected a failure: " << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  }

  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  fs::path directory_;
  Outline outline_{{{0, 0, 0}, {1, 2, 3}, {0, 0, 0}}, {0, 3}};
};

TEST_F(HierarchyReaderTest, GivesTheWholeHierarchyBack) {
  const AttributeLayout layout{.normals = true, .colour = ColourType::u8};
  for (const std::uint32_t partitions : {1U, 2U, 3U, 6U, 8U}) {
    const SampleHierarchy sample = make_sample(torus(300), partitions, {layout, {1, 2, 3}});
    write(sample);
    const HierarchyReader read = reader();
    EXPECT_EQ(read.tree().partition_count(), partitions);
    EXPECT_EQ(read.tile_format().attributes, layout);
    EXPECT_EQ(read.tile_format().frame.origin, (Vec3d{1, 2, 3}));
    ASSERT_EQ(read.records().size(), sample.tiles.size());
    for (const PublishedTile& tile : sample.tiles) {
      const PublishedTile back = read.read_tile(tile.node);
      EXPECT_EQ(back.mesh.vertices.positions, tile.mesh.vertices.positions);
      EXPECT_EQ(back.mesh.border, tile.mesh.border);
      EXPECT_EQ(back.chains, tile.chains);
      EXPECT_EQ(read.record(tile.node).node, tile.node);
    }
    EXPECT_EQ(read.read_outline().vertices, outline_.vertices);
    EXPECT_EQ(read.read_outline().starts, outline_.starts);
  }
}

TEST_F(HierarchyReaderTest, AnEarlyNodeIsItsPartition) {
  write(make_sample(torus(300), 3));
  const HierarchyReader read = reader();
  const NodeId early{Level{1}, 1};
  ASSERT_TRUE(read.tree().is_early(early));
  EXPECT_EQ(read.record(early).node, (NodeId{Level{2}, 2}));
  EXPECT_EQ(read.read_tile(early).node, (NodeId{Level{2}, 2}));
}

// A viewer's way: it only knows the files, and draws by the rule of docs/file_format.md.

using Cut = std::set<NodeId>;

Cut random_cut(const Tree& tree, std::mt19937& random, unsigned stop_in) {
  Cut cut;
  std::vector<NodeId> open{tree.root()};
  while (!open.empty()) {
    const NodeId node = open.back();
    open.pop_back();
    const auto children = tree.children(node);
    const bool stop = !tree.is_early(node) && random() % stop_in == 0;
    if (stop || children.count == 0) {
      cut.insert(node);
    } else {
      open.insert(open.end(), children.span().begin(), children.span().end());
    }
  }
  return cut;
}

/// The triangles that a cut shows, over (node, vertex) numbered as they appear.
class CutAssembler {
 public:
  CutAssembler(const HierarchyReader& reader, const Cut& cut) : reader_(reader), cut_(cut) {
    for (const NodeId node : cut)
      add(reader.read_tile(node));
  }
  const std::vector<MeshTriangle>& triangles() const { return triangles_; }

 private:
  struct Place {
    NodeId node;
    std::uint32_t vertex = 0;
    auto operator<=>(const Place&) const = default;
  };

  void add(const PublishedTile& tile) {
    const auto own = [&](TileVertex v) { return Place{tile.node, raw(v)}; };
    for (const TileTriangle& t : tile.mesh.interior)
      append({own(t[0]), own(t[1]), own(t[2])});
    for (const TileTriangle& t : tile.mesh.border) {
      std::array<Place, 3> places;
      bool drawn = true;
      for (std::size_t c = 0; c < 3; ++c) {
        places[c] = tile.mesh.is_own(t[c]) ? own(t[c]) : shown(tile, t[c], drawn);
      }
      if (drawn)
        append(places);
    }
  }

  /// Where a ghost is shown; `drawn` becomes false if the triangle is another tile's to draw.
  Place shown(const PublishedTile& tile, TileVertex v, bool& drawn) const {
    const std::size_t ghost = raw(v) - tile.mesh.own_count;
    const NodeId owner{tile.node.level, tile.mesh.ghosts[ghost].tile};
    if (cut_.contains(owner)) {
      drawn = drawn && tile.node.index < owner.index;
      return {owner, tile.chains[ghost][0]};
    }
    for (std::size_t k = 1; k < tile.chains[ghost].size(); ++k) {
      const auto level = static_cast<Level>(static_cast<std::size_t>(raw(owner.level)) - k);
      const NodeId ancestor = reader_.tree().ancestor(owner, level);
      if (cut_.contains(ancestor))
        return {ancestor, tile.chains[ghost][k]};
    }
    drawn = false;  // shown finer: its tiles draw this border
    return {};
  }

  void append(const std::array<Place, 3>& places) {
    if (places[0] == places[1] || places[1] == places[2] || places[2] == places[0])
      return;
    MeshTriangle triangle{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto number = static_cast<std::uint32_t>(numbers_.size());
      triangle[c] = numbers_.emplace(places[c], number).first->second;
    }
    triangles_.push_back(triangle);
  }

  const HierarchyReader& reader_;
  const Cut& cut_;
  std::map<Place, std::uint32_t> numbers_;
  std::vector<MeshTriangle> triangles_;
};

TEST_F(HierarchyReaderTest, AnyCutOfAClosedMeshIsClosed) {
  for (const std::uint32_t partitions : {2U, 5U, 11U, 16U}) {
    write(make_sample(torus(2000, 0.05F), partitions));
    const HierarchyReader read = reader();
    std::mt19937 random(partitions);
    for (int round = 0; round < 50; ++round) {
      const Cut cut = random_cut(read.tree(), random, 2 + static_cast<unsigned>(round) % 4);
      const CutAssembler assembled(read, cut);
      EXPECT_TRUE(is_closed(assembled.triangles())) << partitions << " " << round;
    }
    EXPECT_EQ(CutAssembler(read, random_cut(read.tree(), random, ~0U)).triangles().size(),
              torus(2000).triangles.size());
  }
}

TEST_F(HierarchyReaderTest, SANITIZED_DamagedFilesAreRefusedByName) {
  write(make_sample(torus(300), 4));
  const HierarchyReader read = reader();
  const NodeId node{Level{2}, 1};
  const fs::path tile = storage::tile_path(directory_, node);
  damage(tile);
  expect_failure(ErrorCode::corrupt, tile, "the file is damaged", [&] { read.read_tile(node); });
  cut(tile);
  expect_failure(ErrorCode::corrupt, tile, "the file is cut", [&] { read.read_tile(node); });
  fs::resize_file(tile, 1 << 20);
  expect_failure(ErrorCode::corrupt, tile, "at most", [&] { read.read_tile(node); });
  fs::remove(tile);
  expect_failure(ErrorCode::io, tile, "No such file", [&] { read.read_tile(node); });
  const fs::path outline = storage::outline_path(directory_);
  damage(outline);
  expect_failure(ErrorCode::corrupt, outline, "is damaged", [&] { read.read_outline(); });
}

/// Replaces files once, right after the manifest was opened.
class ReplacingFiles final : public storage::ForwardingFiles {
 public:
  ReplacingFiles(storage::FileSystem& others, std::function<void()> replace)
      : ForwardingFiles(others), replace_(std::move(replace)) {}
  std::unique_ptr<storage::File> open(const fs::path& path) override {
    auto file = ForwardingFiles::open(path);
    if (path.filename() != storage::manifest_path({}) || !replace_)
      return file;
    // As another build does: the file that is open stays what it was.
    auto held = storage::read_file(*file, 1 << 20);
    std::exchange(replace_, nullptr)();
    const fs::path copy = path.parent_path() / "held";
    storage::write_file(others(), copy, held);
    return ForwardingFiles::open(copy);
  }

 private:
  std::function<void()> replace_;
};

TEST_F(HierarchyReaderTest, TwoBuildsAreNeverMixed) {
  constexpr const char* kReplaced = "another hierarchy has taken its place";
  const SampleHierarchy first = make_sample(torus(300), 4);
  const SampleHierarchy second = make_sample(torus(300, 0.1F), 4);
  const NodeId node{Level{2}, 1};
  write(first);
  const HierarchyReader read = reader();
  outline_.vertices[1].x += 1;
  write(second);
  expect_failure(ErrorCode::io, directory_, kReplaced, [&] { read.read_tile(node); });
  expect_failure(ErrorCode::io, directory_, kReplaced, [&] { read.read_outline(); });
  EXPECT_EQ(reader().read_tile(node).mesh.vertices.positions,
            second.tile(node).mesh.vertices.positions);
  fs::remove_all(directory_);
  fs::create_directories(directory_);
  write(make_sample(torus(300), 2));
  expect_failure(ErrorCode::io, directory_, kReplaced, [&] { read.read_tile(node); });
}

TEST_F(HierarchyReaderTest, ABuildThatComesWhileAnotherIsOpenedIsTold) {
  write(make_sample(torus(300), 4));
  ReplacingFiles files(*files_, [&] { write(make_sample(torus(300, 0.1F), 4)); });
  expect_failure(ErrorCode::io, directory_, "another hierarchy has taken its place",
                 [&] { HierarchyReader(files, directory_); });
}

TEST_F(HierarchyReaderTest, SANITIZED_DamagedManifestsAndIndexesAreRefused) {
  const SampleHierarchy sample = make_sample(torus(300), 4);
  write(sample);
  damage(storage::index_path(directory_));
  expect_failure(ErrorCode::corrupt, storage::index_path(directory_), "is damaged",
                 [&] { reader(); });
  write(sample);
  damage(storage::manifest_path(directory_));
  expect_failure(ErrorCode::corrupt, storage::manifest_path(directory_), "", [&] { reader(); });
  fs::remove(storage::manifest_path(directory_));
  expect_failure(ErrorCode::io, directory_, "there is no hierarchy.json", [&] { reader(); });
}

TEST_F(HierarchyReaderTest, SANITIZED_ATileThatIsNotTheIndexedOneIsRefused) {
  const SampleHierarchy sample = with_copies(make_sample(torus(300), 4));
  const auto refuse_with = [&](std::uint32_t TileRecord::*count, const char* what) {
    write(shaded(sample));
    std::vector<TileRecord> changed = reader().records();
    const NodeId node = changed.back().node;
    changed.back().*count += 1;
    const Bytes index = storage::encode_index(changed);
    Manifest manifest = reader().manifest();
    manifest.index_checksum = storage::checksum(index);
    const std::string text = storage::to_json_text(manifest);
    storage::write_file(*files_, storage::index_path(directory_), index);
    storage::write_file(*files_, storage::manifest_path(directory_),
                        std::as_bytes(std::span(text)));
    const HierarchyReader read = reader();
    expect_failure(ErrorCode::corrupt, storage::tile_path(directory_, node), what,
                   [&] { read.read_tile(node); });
  };
  refuse_with(&TileRecord::interior_count, "interior triangles are not those of the index");
  refuse_with(&TileRecord::copy_count, "copies are not those of the index");
  refuse_with(&TileRecord::split_count, "splits are not those of the index");
}

TEST_F(HierarchyReaderTest, SANITIZED_SplitsWithoutComputedNormalsAreRefused) {
  write(shaded(make_sample(torus(300), 4)));
  Manifest manifest = reader().manifest();
  manifest.computed_normals = false;
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(*files_, storage::manifest_path(directory_), std::as_bytes(std::span(text)));
  expect_failure(ErrorCode::corrupt, storage::index_path(directory_),
                 "splits without computed normals", [&] { reader(); });
}

/// The text of a changed manifest, with its checksum.
std::string with_new_seal(nlohmann::ordered_json document) {
  document["checksum"] = std::string(16, '0');
  std::string text = document.dump(2) + "\n";
  const auto sum = storage::checksum(std::as_bytes(std::span(text)));
  return text.replace(text.size() - 20, 16, fmt::format("{:016x}", sum));
}

TEST_F(HierarchyReaderTest, SANITIZED_AHierarchyOfAnEarlierFormatIsRefusedWithWhatToDo) {
  write(make_sample(torus(300), 4));
  const fs::path path = storage::manifest_path(directory_);
  std::ifstream in(path);
  auto document = nlohmann::ordered_json::parse(in);
  document["format_version"] = 5;
  document["source"].erase("places");
  const std::string text = with_new_seal(document);
  storage::write_file(*files_, path, std::as_bytes(std::span(text)));
  expect_failure(
      ErrorCode::corrupt, path,
      "was made with format version 5, this program reads 6 to 14: build it again from the "
      "mesh",
      [&] { reader(); });
}

TEST_F(HierarchyReaderTest, TheTreeCountsPlaces) {
  const SampleHierarchy sample = make_sample(torus(300), 4);
  write(sample);
  const fs::path path = storage::manifest_path(directory_);
  std::ifstream in(path);
  auto document = nlohmann::ordered_json::parse(in);
  document["source"]["vertices"] = 1000;
  const std::string text = with_new_seal(document);
  storage::write_file(*files_, path, std::as_bytes(std::span(text)));
  EXPECT_EQ(reader().tree().vertex_count(), sample.tree.vertex_count());
  EXPECT_EQ(reader().manifest().source.vertices, 1000U);
}

}  // namespace
}  // namespace meshhier::tests
