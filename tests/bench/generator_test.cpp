// Shuffled meshes, and meshes on their way to and from files.
#include "bench/generator.h"

#include "base/error.h"
#include "tests/bench/collected.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::bench {
namespace {

/// Each triangle as its corners' coordinates and colours, smallest corner first.
std::vector<std::vector<float>> described_triangles(const Collected& mesh, std::size_t channels) {
  std::vector<std::vector<float>> all;
  for (const MeshTriangle& t : mesh.triangles) {
    std::array<std::vector<float>, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f p = to_float(mesh.positions[t[c]]);
      corners[c] = {p.x, p.y, p.z};
      for (std::size_t i = 0; i < channels; ++i)
        corners[c].push_back(mesh.attributes[t[c] * channels + i]);
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    auto& text = all.emplace_back();
    for (const auto& corner : corners)
      text.insert(text.end(), corner.begin(), corner.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Shuffle, is_the_same_mesh_in_another_order) {
  LoadedMesh input = loaded(tests::torus(3000, 0.01f));
  input.attributes.colour = ColourType::u8;
  for (std::size_t v = 0; v < input.positions.size() * 3; ++v)
    input.channels.push_back(static_cast<float>(v % 256));
  const Collected before = collect(*amplify(input, {.times = 0}));
  const Collected after = collect(*shuffle(input, 1));
  EXPECT_EQ(described_triangles(before, 3), described_triangles(after, 3));
  std::size_t vertices_at_home = 0;
  for (std::size_t v = 0; v < before.positions.size(); ++v)
    vertices_at_home += before.positions[v] == after.positions[v] ? 1 : 0;
  EXPECT_LT(vertices_at_home, 10u);  // One is expected of a random order.
  std::size_t neighbours = 0;
  for (std::size_t t = 1; t < after.triangles.size(); ++t) {
    const MeshTriangle& a = after.triangles[t - 1];
    const MeshTriangle& b = after.triangles[t];
    neighbours += std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end() ? 1 : 0;
  }
  EXPECT_LT(neighbours, after.triangles.size() / 20);
}

TEST(Shuffle, depends_on_the_seed_alone) {
  const LoadedMesh input = loaded(tests::torus(300));
  EXPECT_EQ(collect(*shuffle(input, 4), 1), collect(*shuffle(input, 4), 1000));
  EXPECT_NE(collect(*shuffle(input, 4)).positions, collect(*shuffle(input, 5)).positions);
  EXPECT_NE(collect(*shuffle(input, 4)).triangles, collect(*shuffle(input, 5)).triangles);
}

TEST(Shuffle, keeps_unreferenced_vertices_and_empty_meshes) {
  const Collected points = collect(*shuffle(loaded(tests::points(50)), 1));
  const std::set<std::tuple<double, double, double>> found = [&] {
    std::set<std::tuple<double, double, double>> keys;
    for (const Vec3d p : points.positions)
      keys.insert(key(p));
    return keys;
  }();
  for (const Vec3f p : tests::points(50).positions)
    EXPECT_TRUE(found.count(key(to_double(p))));
  EXPECT_EQ(collect(*shuffle({}, 1)), Collected{});
}

class GeneratorFiles : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::temp_directory_path() /
                 ("meshhier_generator_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::filesystem::path path(const char* name) const { return directory_ / name; }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(directory_), {}));
  }

  std::filesystem::path directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(GeneratorFiles, what_is_written_is_what_is_read) {
  for (const bool wide : {false, true}) {
    const auto mesh = make_surface({.shape = BaseShape::torus,
                                    .triangles = 200'000,
                                    .normals = true,
                                    .colours = true,
                                    .alpha = true,
                                    .double_coordinates = wide});
    write_ply(*files_, {path("mesh.ply"), true}, *mesh);
    EXPECT_EQ(entries(), 1u) << "a temporary file stayed";
    const LoadedMesh read = load_mesh(*mesh_io::open_mesh(*files_, path("mesh.ply")));
    EXPECT_EQ(read.attributes, mesh->content().attributes);
    EXPECT_EQ(read.double_coordinates, wide);
    const Collected made = collect(*mesh);
    EXPECT_EQ(read.positions, made.positions);
    EXPECT_EQ(read.channels, made.attributes);
    EXPECT_EQ(read.triangles, made.triangles);
  }
}

TEST_F(GeneratorFiles, an_earlier_file_is_replaced_only_by_a_whole_one) {
  class FailingMesh final : public GeneratedMesh {
   public:
    explicit FailingMesh(std::unique_ptr<GeneratedMesh> mesh) : mesh_(std::move(mesh)) {}
    const mesh_io::PlyContent& content() const override { return mesh_->content(); }
    void visit_vertices(std::size_t block_size, const VertexBlockVisitor& visit) const override {
      mesh_->visit_vertices(block_size, visit);
    }
    void visit_triangles(std::size_t, const TriangleBlockVisitor&) const override {
      throw Error(ErrorCode::io, "no more triangles");
    }

   private:
    std::unique_ptr<GeneratedMesh> mesh_;
  };
  write_ply(*files_, {path("mesh.ply"), true}, *make_surface({.triangles = 100}));
  const auto size = std::filesystem::file_size(path("mesh.ply"));
  const FailingMesh failing(make_surface({.triangles = 100'000}));
  EXPECT_THROW(write_ply(*files_, {path("mesh.ply"), true}, failing), Error);
  EXPECT_EQ(std::filesystem::file_size(path("mesh.ply")), size);
  EXPECT_EQ(entries(), 1u);
}

TEST_F(GeneratorFiles, a_missing_directory_is_an_error_of_io) {
  try {
    write_ply(*files_, {path("nowhere") / "mesh.ply"}, *make_surface({.triangles = 100}));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
  }
}

#ifdef MESHHIER_MODELS_DIR
TEST_F(GeneratorFiles, a_real_scan_amplified_keeps_its_borders) {
  const std::filesystem::path scan = std::filesystem::path(MESHHIER_MODELS_DIR) / "laurana_50k.ply";
  if (!std::filesystem::exists(scan))
    GTEST_SKIP() << scan << " is not there";
  const LoadedMesh input = load_mesh(*mesh_io::open_mesh(*files_, scan));
  const Collected result = collect(*amplify(input, {.times = 2}));
  EXPECT_EQ(result.triangles.size(), input.triangles.size() * 16);
  EXPECT_EQ(tests::boundary_edges(result.triangles).size(),
            tests::boundary_edges(input.triangles).size() * 4);
  for (std::size_t v = 0; v < input.positions.size(); ++v)
    ASSERT_EQ(result.positions[v], input.positions[v]);
}
#endif

}  // namespace
}  // namespace meshhier::bench
