// Input of every format: what it becomes, and that the whole way through a build holds for it.
#include "import/import_input.h"

#include "base/error.h"
#include "mesh_io/ply_writer.h"
#include "pipeline/build.h"
#include "pipeline/estimate.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "tests/support/gzip.h"
#include "tests/support/interrupter.h"
#include "tests/support/memory_files.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "verify/verify.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::MeshTriangle;
using tests::TestMesh;

/// Three vertices of its own for every triangle.
TestMesh as_soup(const TestMesh& mesh) {
  TestMesh soup;
  for (const MeshTriangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t corner : t)
      soup.positions.push_back(mesh.positions[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

std::string point_text(Vec3f p) {
  return fmt::format("{} {} {}", p.x, p.y, p.z);
}

std::string obj_text(const TestMesh& mesh) {
  std::string text = "# test\n";
  for (const Vec3f& p : mesh.positions)
    text += "v " + point_text(p) + '\n';
  for (const MeshTriangle& t : mesh.triangles)
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string ply_text(const TestMesh& mesh) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.positions.size(), mesh.triangles.size());
  for (const Vec3f& p : mesh.positions)
    text += point_text(p) + '\n';
  for (const MeshTriangle& t : mesh.triangles)
    text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string off_text(const TestMesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.positions.size(), mesh.triangles.size());
  for (const Vec3f& p : mesh.positions)
    text += point_text(p) + '\n';
  for (const MeshTriangle& t : mesh.triangles)
    text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string stl_text(const TestMesh& mesh) {
  std::string text = "solid test\n";
  for (const MeshTriangle& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t corner : t)
      text += "vertex " + point_text(mesh.positions[corner]) + '\n';
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

std::string stl_bytes(const TestMesh& mesh) {
  std::string bytes = "solid although it is binary";
  bytes.resize(80, ' ');
  const auto put = [&](const auto& value) {
    std::array<char, sizeof value> raw_bytes;
    std::memcpy(raw_bytes.data(), &value, sizeof value);
    bytes.append(raw_bytes.data(), raw_bytes.size());
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const MeshTriangle& t : mesh.triangles) {
    put(Vec3f{});
    for (const std::uint32_t corner : t)
      put(mesh.positions[corner]);
    put(std::uint16_t{0});
  }
  return bytes;
}

/// Files have a time, which a test may change.
class TimedFiles final : public tests::MemoryFiles {
 public:
  storage::FileIdentity identity(const fs::path& path) override {
    return {MemoryFiles::identity(path).bytes, modified_ns};
  }
  std::int64_t modified_ns = 1;
};

class ImportTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& content) {
    files_.put(fs::path("w/in") / name, content);
  }
  void put_ply(const std::string& name, const TestMesh& mesh, AttributeLayout layout = {},
               std::vector<float> attributes = {}) {
    mesh_io::PlyContent content;
    content.vertex_count = mesh.positions.size();
    content.triangle_count = mesh.triangles.size();
    content.attributes = layout;
    mesh_io::PlyWriter writer(files_.create(fs::path("w/in") / name), content);
    writer.write_vertices(mesh.positions, attributes);
    writer.write_triangles(mesh.triangles);
    writer.finish();
  }
  std::string content(const std::string& name) { return files_.content(fs::path("w/in") / name); }

  static mesh_io::InputPaths inputs(const std::vector<std::string>& names) {
    mesh_io::InputPaths paths;
    for (const std::string& name : names)
      paths.push_back(fs::path("w/in") / name);
    return paths;
  }
  static config::Config config(const std::vector<std::string>& names, bool weld = false) {
    config::Config config = tests::smooth_config();
    config.input = inputs(names);
    config.output = "w/out/a.hier";
    config.weld = weld;
    config.threads = 2;
    config.partition.vertices = 300;
    return config;
  }

  pipeline::BuildReport build(const config::Config& config) {
    execution::NoProgress progress;
    return build(config, progress, execution::CancelToken());
  }
  pipeline::BuildReport build(const config::Config& config, execution::Progress& progress,
                              const execution::CancelToken& cancel) {
    return pipeline::build_hierarchy(config, {.force = true}, {files_, progress, cancel});
  }

  /// All files of the hierarchy but those that say what it was made of.
  std::map<fs::path, std::string> made(const config::Config& config) {
    build(config);
    std::map<fs::path, std::string> all;
    for (const fs::path& file : files_.list(config.output)) {
      if (file != storage::manifest_path(config.output) &&
          file != storage::tileset_path(config.output))
        all[file] = files_.content(file);
    }
    return all;
  }

  SourceSummary source(const config::Config& config) {
    return storage::HierarchyReader(files_, config.output).manifest().source;
  }
  std::uint64_t count_of(const config::Config& config, const std::string& name) {
    return source(config).count_of(name);
  }

  std::vector<std::string> problems(const config::Config& config, const mesh_io::InputPaths& with) {
    execution::NoProgress progress;
    return verifying::verify_hierarchy(files_, config.output, {.input = with, .cuts = 3}, progress,
                                       execution::CancelToken())
        .problems;
  }

  /// The failure of a build that must fail; nothing may be left of it.
  Error failure(const config::Config& config) {
    const std::vector<fs::path> before = files_.list("w");
    try {
      build(config);
    } catch (const Error& error) {
      EXPECT_EQ(files_.list("w"), before) << "something was left behind";
      return error;
    }
    ADD_FAILURE() << "the build did not fail";
    return {ErrorCode::internal, ""};
  }

  /// The PLY that files become.
  std::string imported(const std::vector<std::string>& names, bool weld, ImportMemory memory) {
    storage::MemoryPool pool(memory.pool_bytes);
    storage::ScratchFile scratch(files_, "w/scratch", pool);
    TemporaryFile ply(files_, "w/imported.ply", pool.scratch_use());
    execution::NoProgress progress;
    const execution::CancelToken cancel;
    InputFiles input(files_, inputs(names), {.weld = weld});
    import_input(input, ply, {files_, scratch, memory.sort_bytes, progress, cancel, "w/objects"});
    return files_.content("w/imported.ply");
  }

  TimedFiles files_;
};

constexpr ImportMemory kRoomy{64 << 20, 64 << 20};
constexpr ImportMemory kTight{0, 1};  // all is spooled and merged in many runs

// ---- formats -------------------------------------------------------------------------------

TEST_F(ImportTest, SLOW_EveryFormatOfAMeshGivesTheSameTiles) {
  const TestMesh mesh = tests::by_first_appearance(tests::torus(5000, 0.01F));
  put_ply("mesh.ply", mesh);
  put("mesh.obj", obj_text(mesh));
  put("mesh.off", off_text(mesh));
  put("text.stl", stl_text(mesh));
  put("binary.stl", stl_bytes(mesh));
  const std::vector<std::string> names{"mesh.ply", "mesh.obj", "mesh.off", "text.stl",
                                       "binary.stl"};
  const auto expected = made(config({"mesh.ply"}));
  EXPECT_THAT(source(config({"mesh.ply"})).files, IsEmpty()) << "read in place";
  for (const std::string& name : names) {
    put(name + ".gz", tests::gzip(content(name)));
    for (const std::string& given : {name, name + ".gz"}) {
      const config::Config with = config({given});
      EXPECT_EQ(made(with), expected) << given;
      EXPECT_THAT(problems(with, with.input), IsEmpty()) << given;
      const SourceSummary summary = source(with);
      EXPECT_EQ(summary.file_name, given);
      EXPECT_EQ(summary.file_bytes, content(given).size());
      EXPECT_EQ(summary.triangles, mesh.triangles.size());
      EXPECT_EQ(summary.faces, mesh.triangles.size());
    }
  }
}

// Once read in place, once imported.
TEST_F(ImportTest, NormalsThatAreNoNumbersAreZeroAndCounted) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0 0 1\n1 0 0 nan nan nan\n1 1 0 0 0 1\n0 1 0 0 0 -nan(ind)\n3 0 1 2\n3 0 2 3\n";
  put("mesh.ply", ply);
  put("mesh.ply.gz", tests::gzip(content("mesh.ply")));
  for (const char* name : {"mesh.ply", "mesh.ply.gz"}) {
    const config::Config with = config({name});
    const pipeline::BuildReport report = build(with);
    EXPECT_THAT(report.text, HasSubstr("warning: 2 normals of the mesh became 0")) << name;
    EXPECT_EQ(count_of(with, "normals_made_zero"), 2U) << name;
    EXPECT_THAT(problems(with, with.input), IsEmpty()) << name;
  }
  EXPECT_EQ(made(config({"mesh.ply"})), made(config({"mesh.ply.gz"})));
}

TEST_F(ImportTest, TheNameSaysNothing) {
  put("mesh.ply", obj_text(tests::sphere(500)));
  build(config({"mesh.ply"}));
  ASSERT_EQ(source(config({})).files.size(), 1U);
  EXPECT_EQ(source(config({})).files[0].format, "OBJ");
}

TEST_F(ImportTest, ResultsDoNotDependOnTheMemory) {
  const TestMesh mesh = tests::torus(30'000, 0.01F);
  put("mesh.stl", stl_bytes(mesh));
  std::string obj = obj_text({mesh.positions, {}});
  for (std::size_t i = 0; i < 5000; ++i)
    obj += fmt::format("vt {} {}\nvn {} 0 1\n", 0.001 * static_cast<double>(i), i, i);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const MeshTriangle& t = mesh.triangles[i];
    obj += fmt::format("f {}/{}/{} {}/{}/{} {}/{}\n", t[0] + 1, t[0] % 5000 + 1, i % 7 + 1,
                       t[1] + 1, t[1] % 4999 + 1, i % 5 + 1, t[2] + 1, i % 5000 + 1);
  }
  put("mesh.obj", obj);
  for (const char* name : {"mesh.stl", "mesh.obj"})
    EXPECT_EQ(imported({name}, false, kTight), imported({name}, false, kRoomy)) << name;
}

TEST_F(ImportTest, CoordinatesThatNeedDoublesGetThem) {
  put("a.obj",
      "v 400123.123 5800456.789 1\nv 400124.5 5800456.789 2\nv 400123.123 5800458.1 3\n"
      "f 1 2 3\n");
  const config::Config with = config({"a.obj"});
  build(with);
  EXPECT_TRUE(source(with).double_precision);
  EXPECT_EQ(source(with).bounds.min.x, 400123.123);
  EXPECT_THAT(problems(with, with.input), IsEmpty());
}

TEST_F(ImportTest, UnreferencedVerticesStay) {
  put("a.obj", "v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 3/1 4/1\n");
  const config::Config with = config({"a.obj"});
  build(with);
  EXPECT_EQ(source(with).vertices, 4U);
  EXPECT_EQ(source(with).unreferenced_vertices, 1U);
  EXPECT_EQ(count_of(with, "vertices_without_texcoord"), 1U);
}

// As grids of scanners have them, where they saw nothing.
TestMesh with_unplaced(const TestMesh& mesh) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  const float far = std::numeric_limits<float>::infinity();
  TestMesh more;
  std::vector<std::uint32_t> numbers;
  for (const Vec3f& p : mesh.positions) {
    if (numbers.size() % 5 == 0)
      more.positions.push_back({none, none, none});
    if (numbers.size() % 7 == 0)
      more.positions.push_back({p.x, -far, p.z});
    numbers.push_back(static_cast<std::uint32_t>(more.positions.size()));
    more.positions.push_back(p);
  }
  for (const MeshTriangle& t : mesh.triangles)
    more.triangles.push_back({numbers[t[0]], numbers[t[1]], numbers[t[2]]});
  return more;
}

TEST_F(ImportTest, VerticesWithoutAPlaceThatNoFaceUsesGo) {
  const TestMesh mesh = tests::by_first_appearance(tests::torus(5000, 0.01F));
  const TestMesh more = with_unplaced(mesh);
  put_ply("good.ply", mesh);
  put_ply("mesh.ply", more);
  put("text.ply", ply_text(more));
  put("mesh.obj", obj_text(more));
  put("mesh.off", off_text(more));
  put("packed.ply.gz", tests::gzip(content("mesh.ply")));
  const auto expected = made(config({"good.ply"}));
  for (const char* name : {"mesh.ply", "text.ply", "mesh.obj", "mesh.off", "packed.ply.gz"}) {
    for (const bool weld : {false, true}) {
      config::Config with = config({name});
      with.weld = weld;
      EXPECT_EQ(made(with), expected) << name;
      EXPECT_THAT(problems(with, with.input), IsEmpty()) << name;
      EXPECT_EQ(count_of(with, "dropped_unplaced_vertices"),
                more.positions.size() - mesh.positions.size())
          << name;
    }
    EXPECT_EQ(imported({name}, true, kTight), imported({name}, true, kRoomy)) << name;
  }
  const config::Config joined = config({"good.ply", "mesh.ply"});
  build(joined);
  EXPECT_EQ(source(joined).vertices, 2 * mesh.positions.size());
  EXPECT_THAT(problems(joined, joined.input), IsEmpty());
}

TEST_F(ImportTest, TrianglesOfVerticesWithoutAPlaceGo) {
  TestMesh mesh = with_unplaced(tests::sphere(500));
  put_ply("good.ply", mesh);
  const auto expected = made(config({"good.ply"}));
  mesh.triangles.insert(mesh.triangles.begin() + 7, {2, 3, 0});
  put_ply("mesh.ply", mesh);
  put("text.ply", ply_text(mesh));
  put("mesh.obj", obj_text(mesh));
  put("mesh.off", off_text(mesh));
  for (const char* name : {"mesh.ply", "text.ply", "mesh.obj", "mesh.off"}) {
    const config::Config with = config({name});
    EXPECT_EQ(made(with), expected) << name;
    EXPECT_EQ(count_of(with, "dropped_unplaced_triangles"), 1U) << name;
    EXPECT_THAT(problems(with, with.input), IsEmpty()) << name;
  }
}

TEST_F(ImportTest, MeshesOfWhichMostTrianglesHaveNoPlaceAreRefused) {
  TestMesh mesh = with_unplaced(tests::sphere(500));
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i <= count; ++i)
    mesh.triangles.push_back({2, 3, 0});
  put_ply("mesh.ply", mesh);
  put("mesh.obj", obj_text(mesh));
  put("mesh.off", off_text(mesh));
  constexpr const char* kWhy = "; most triangles use such vertices, so the mesh cannot be built";
  EXPECT_EQ(failure(config({"mesh.ply"})).what(),
            std::string("w/in/mesh.ply: vertex 0 has the coordinates nan nan nan, which are not "
                        "finite") +
                kWhy);
  EXPECT_EQ(failure(config({"mesh.obj"})).what(),
            std::string("w/in/mesh.obj: line 2: expected a finite number for a coordinate, found "
                        "'nan'") +
                kWhy);
  EXPECT_THAT(failure(config({"mesh.off"})).what(), HasSubstr(kWhy));
}

TEST_F(ImportTest, WithoutALookForCopiesAVertexWithoutAPlaceIsRefused) {
  put_ply("mesh.ply", with_unplaced(tests::sphere(500)));
  config::Config with = config({"mesh.ply"});
  with.topology = Topology::index;
  EXPECT_THAT(failure(with).what(), HasSubstr("\"topology\": \"place\" leaves them out"));
}

// ---- corners and attributes ----------------------------------------------------------------

/// Positions and attributes of the only partition, sorted texts.
std::vector<std::string> vertices_of_root(storage::FileSystem& files, const fs::path& hierarchy) {
  const storage::HierarchyReader reader(files, hierarchy);
  const TileMesh mesh = reader.read_tile({Level{0}, 0}).mesh;
  std::vector<std::string> all;
  for (const VertexArray* vertices : {&mesh.vertices, &mesh.copies.vertices}) {
    for (std::size_t v = 0; v < vertices->size(); ++v) {
      all.push_back(point_text(vertices->positions[v]));
      for (const float value : vertices->attributes_of(v))
        all.back() += fmt::format(" {}", value);
    }
  }
  std::ranges::sort(all);
  return all;
}

TEST_F(ImportTest, CornersOfOtherAttributesAreOtherVertices) {
  put("a.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\n"
      "f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/2 4/1/1\n");
  const config::Config with = config({"a.obj"});
  build(with);
  EXPECT_EQ(count_of(with, "split_vertices"), 1U);
  EXPECT_THAT(vertices_of_root(files_, with.output),
              testing::ElementsAre("0 0 0 0 0 1 0 0", "0 1 0 0 0 1 0 0", "1 0 0 0 0 1 1 0",
                                   "1 1 0 0 0 1 1 1", "1 1 0 0 1 0 1 1"));
  EXPECT_THAT(problems(with, with.input), IsEmpty());
}

TEST_F(ImportTest, VertexColoursComeThrough) {
  const config::Config with = config({"a"});
  put("a", "v 0 0 0 0.5 0.25 1\nv 1 0 0\nv 1 1 0 0 0 0\nf 1 2 3\n");
  build(with);
  EXPECT_EQ(source(with).attributes.colour, ColourType::f32);
  EXPECT_EQ(count_of(with, "vertices_made_white"), 1U);
  EXPECT_THAT(vertices_of_root(files_, with.output),
              testing::ElementsAre("0 0 0 0.5 0.25 1", "1 0 0 1 1 1", "1 1 0 0 0 0"));
  put("a", "COFF\n3 1 0\n0 0 0 255 0 7 9\n1 0 0 1 2 3 4\n0 1 0 5 6 7 8\n3 0 1 2\n");
  build(with);
  EXPECT_EQ(source(with).attributes.colour, ColourType::u8);
  EXPECT_TRUE(source(with).attributes.alpha);
  EXPECT_THAT(vertices_of_root(files_, with.output),
              testing::ElementsAre("0 0 0 255 0 7 9", "0 1 0 5 6 7 8", "1 0 0 1 2 3 4"));
}

TEST_F(ImportTest, WhatAnObjHoldsBesidesIsCounted) {
  put("a.obj",
      "mtllib m\no a\ng b\ng c\nusemtl d\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n"
      "l 1 2\ns 1\n");
  const config::Config with = config({"a.obj"});
  const pipeline::BuildReport report = build(with);
  for (const char* text :
       {"imported a.obj: OBJ", "2 groups", "1 object", "1 material use", "1 material library",
        "1 ignored point and line", "1 ignored statement", "dropped 1 degenerate"})
    EXPECT_THAT(report.text + report.account, HasSubstr(text));
  EXPECT_EQ(source(with).faces, 2U);
  EXPECT_EQ(source(with).degenerate_triangles, 1U);
}

// ---- welding -------------------------------------------------------------------------------

TEST_F(ImportTest, SLOW_AWeldedSoupIsTheMeshItWasMadeOf) {
  const TestMesh mesh = tests::by_first_appearance(tests::torus(5000, 0.01F));
  put_ply("mesh.ply", mesh);
  put_ply("soup.ply", as_soup(mesh));
  const auto expected = made(config({"mesh.ply"}));
  const config::Config with = config({"soup.ply"}, true);
  EXPECT_EQ(made(with), expected);
  EXPECT_EQ(count_of(with, "welded_vertices"), 3 * mesh.triangles.size() - mesh.positions.size());
  EXPECT_THAT(problems(with, with.input), IsEmpty());
}

TEST_F(ImportTest, SLOW_AWeldedSoupDoesNotDependOnTheMemory) {
  const TestMesh mesh = tests::torus(30'000, 0.01F);
  put_ply("soup.ply", as_soup(mesh));
  put("tight.ply", imported({"soup.ply"}, true, kTight));
  put("roomy.ply", imported({"soup.ply"}, true, kRoomy));
  EXPECT_EQ(made(config({"tight.ply"})), made(config({"roomy.ply"})));
  EXPECT_EQ(source(config({})).vertices, mesh.positions.size());
}

TEST_F(ImportTest, OnlyVerticesThatAreEqualInAllAreWelded) {
  AttributeLayout layout;
  layout.colour = ColourType::u8;
  const TestMesh mesh{{{0, 0, 0}, {-0.0F, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 1e-30F}},
                      {{0, 2, 4}, {1, 3, 5}, {0, 1, 2}}};
  put_ply("a.ply", mesh, layout, {1, 2, 3, 1, 2, 3, 4, 5, 6, 4, 5, 7, 0, 0, 0, 0, 0, 0});
  const config::Config with = config({"a.ply"}, true);
  build(with);
  EXPECT_EQ(source(with).vertices, 5U) << "0 and -0 are one, another colour or position is not";
  EXPECT_EQ(count_of(with, "welded_vertices"), 1U);
  EXPECT_EQ(count_of(with, "triangles_lost_by_welding"), 1U);
  EXPECT_EQ(source(with).triangles, 2U);
  EXPECT_EQ(source(with).degenerate_triangles, 1U);
  EXPECT_THAT(problems(with, with.input), IsEmpty());
}

TEST_F(ImportTest, FacetsThatVanishInAnStlAreCounted) {
  TestMesh mesh = tests::sphere(500);
  const std::size_t sound = mesh.triangles.size();
  mesh.triangles.push_back({0, 0, 1});
  put("a.stl", stl_bytes(mesh));
  const config::Config with = config({"a.stl"});
  build(with);
  EXPECT_EQ(source(with).faces, sound + 1);
  EXPECT_EQ(source(with).triangles, sound);
  EXPECT_EQ(source(with).degenerate_triangles, 1U);
  EXPECT_EQ(count_of(with, "ignored_facet_normals"), sound + 1);
  EXPECT_EQ(count_of(with, "welded_corners"), 3 * (sound + 1) - mesh.positions.size());
}

// ---- several files -------------------------------------------------------------------------

TEST_F(ImportTest, SLOW_SeveralFilesAreOneMesh) {
  const TestMesh one = tests::by_first_appearance(tests::sphere(2000));
  TestMesh other = tests::by_first_appearance(tests::torus(2000));
  for (Vec3f& p : other.positions)
    p.x += 3;
  TestMesh both = one;
  both.positions.insert(both.positions.end(), other.positions.begin(), other.positions.end());
  for (MeshTriangle t : other.triangles) {
    for (std::uint32_t& corner : t)
      corner += static_cast<std::uint32_t>(one.positions.size());
    both.triangles.push_back(t);
  }
  put_ply("both.ply", both);
  put_ply("one.ply", one);
  put("one.off", off_text(one));
  put("other.obj.gz", tests::gzip(obj_text(other)));
  put("other.stl", stl_bytes(other));
  put_ply("plain.ply", other);
  put("other.ply.gz", tests::gzip(content("plain.ply")));
  const auto expected = made(config({"both.ply"}));
  for (const char* first : {"one.ply", "one.off"}) {
    for (const char* second : {"other.obj.gz", "other.stl", "other.ply.gz"}) {
      const config::Config with = config({first, second});
      EXPECT_EQ(made(with), expected) << first << " " << second;
      EXPECT_EQ(source(with).file_name, std::string(first) + ", " + second);
      EXPECT_EQ(source(with).file_bytes, content(first).size() + content(second).size());
      EXPECT_THAT(problems(with, with.input), IsEmpty());
      EXPECT_THAT(problems(with, inputs({second, first})), Contains(HasSubstr("checksum")))
          << "in another order";
    }
  }
}

TEST_F(ImportTest, FilesAreWeldedTogether) {
  put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("b.off", "OFF\n3 1 0\n1 0 0\n0 1 0\n1 1 0\n3 0 2 1\n");
  const config::Config with = config({"a.obj", "b.off"}, true);
  build(with);
  EXPECT_EQ(source(with).vertices, 4U);
  EXPECT_EQ(source(with).triangles, 2U);
  EXPECT_THAT(problems(with, with.input), IsEmpty());
}

TEST_F(ImportTest, NormalsThatOnlySomeFilesHaveAreDropped) {
  put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  put("b.off", "OFF\n3 1 0\n1 0 0\n0 1 0\n1 1 0\n3 0 2 1\n");
  for (const std::vector<std::string>& order :
       {std::vector<std::string>{"a.obj", "b.off"}, {"b.off", "a.obj"}}) {
    const config::Config with = config(order);
    build(with);
    EXPECT_FALSE(source(with).attributes.normals);
    EXPECT_EQ(source(with).vertices, 6U);
    EXPECT_THAT(source(with).counts, Contains(AllOf(Field(&SourceCount::name, "dropped_normals"),
                                                    Field(&SourceCount::count, 3U))));
    EXPECT_THAT(problems(with, with.input), IsEmpty());
    std::filesystem::remove_all(with.output);
  }
}

// ---- what goes wrong, and going on ---------------------------------------------------------

TEST_F(ImportTest, BrokenInputLeavesNothingBehind) {
  const std::string good = obj_text(tests::sphere(500));
  put("a.obj", good + "f 1 2 100000\n");
  EXPECT_EQ(failure(config({"a.obj"})).code(), ErrorCode::input);
  const std::string packed = tests::gzip(good);
  put("a.obj", packed.substr(0, packed.size() - 1));
  EXPECT_THAT(failure(config({"a.obj"})).what(), HasSubstr("w/in/a.obj: byte"));
  put_ply("a.ply", tests::sphere(500));
  const std::string ply = content("a.ply");
  put("a.ply", tests::gzip(ply.substr(0, ply.size() - 1)));
  EXPECT_EQ(failure(config({"a.ply"})).code(), ErrorCode::input);
  EXPECT_THAT(failure(config({"a.ply"}, true)).what(), HasSubstr("w/in/a.ply (unpacked)"));
  for (const bool weld : {false, true})
    EXPECT_THAT(failure(config({"a.ply"}, weld)).what(),
                AllOf(HasSubstr("w/in/a.ply (unpacked): byte"), Not(HasSubstr("import.ply"))));
  put("a.obj", "# nothing\no x\n");
  EXPECT_THAT(failure(config({"a.obj"})).what(), HasSubstr("no vertices"));
}

TEST_F(ImportTest, CanBeInterrupted) {
  put("a.obj", obj_text(tests::sphere(20'000)));
  execution::CancelToken cancel;
  tests::Interrupter interrupter(cancel, 1);
  try {
    build(config({"a.obj"}), interrupter, cancel);
    ADD_FAILURE() << "was not interrupted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
  EXPECT_THAT(interrupter.stages(), testing::ElementsAre("import"));
  EXPECT_THAT(files_.list("w"), testing::SizeIs(1)) << "the input";
}

class ImportResumeTest : public ImportTest {
 protected:
  void SetUp() override {
    put("a.stl", stl_bytes(tests::torus(5000, 0.01F)));
    expect_now();
  }
  void expect_now() {
    expected_ = made(with_);
    const fs::path manifest = storage::manifest_path(with_.output);
    expected_[manifest] = files_.content(manifest);
    files_.remove_all(with_.output);
  }
  /// Stops a build in the stage after distributing.
  void stop_in_leaves() {
    execution::CancelToken cancel;
    struct InLeaves final : execution::Progress {
      explicit InLeaves(execution::CancelToken& token) : cancel(token) {}
      void stage(std::string_view name, std::uint64_t, std::string_view) override {
        if (name == "leaves")
          cancel.cancel();
      }
      void advance(std::uint64_t) override {}
      void finish(std::string_view) override {}
      execution::CancelToken& cancel;
    } in_leaves(cancel);
    EXPECT_THROW(build(with_, in_leaves, cancel), Error);
    ASSERT_TRUE(files_.exists(work() / "journal"));
    EXPECT_FALSE(files_.exists(storage::imported_path(work()))) << "is not needed any more";
  }
  /// The stages of a build that goes on, which must come to what it always does.
  std::set<std::string> stages_of_rest() {
    execution::CancelToken cancel;
    tests::Interrupter progress(cancel, UINT64_MAX);
    build(with_, progress, cancel);
    for (const auto& [file, bytes] : expected_)
      EXPECT_EQ(files_.content(file), bytes) << file;
    EXPECT_THAT(problems(with_, with_.input), IsEmpty());
    EXPECT_FALSE(files_.exists(work()));
    return progress.stages();
  }
  fs::path work() const { return storage::work_path(with_.output); }

  config::Config with_ = config({"a.stl"});
  std::map<fs::path, std::string> expected_;
};

TEST_F(ImportResumeTest, GoesOnWithoutImportingAgain) {
  stop_in_leaves();
  const std::set<std::string> stages = stages_of_rest();
  EXPECT_THAT(stages, Contains("resume"));
  EXPECT_THAT(stages, Not(Contains("import")));
}

TEST_F(ImportResumeTest, APlyWithVerticesWithoutAPlaceGoesOnToo) {
  put_ply("a.ply", with_unplaced(tests::torus(5000, 0.01F)));
  with_ = config({"a.ply"});
  expect_now();
  stop_in_leaves();
  EXPECT_THAT(stages_of_rest(), Not(Contains("import")));
  files_.remove_all(with_.output);
  stop_in_leaves();
  files_.put(work() / "mesh", std::string(files_.content(work() / "mesh").size(), 'x'));
  EXPECT_THAT(stages_of_rest(), Contains("import"));
}

TEST_F(ImportResumeTest, AnInputThatWasTouchedIsTheSame) {
  stop_in_leaves();
  ++files_.modified_ns;
  EXPECT_THAT(stages_of_rest(), Not(Contains("import")));
}

TEST_F(ImportResumeTest, WorkThatWasDamagedMeansImportingAgain) {
  stop_in_leaves();
  files_.put(work() / "mesh", std::string(files_.content(work() / "mesh").size(), 'x'));
  EXPECT_THAT(stages_of_rest(), Contains("import"));
}

TEST_F(ImportResumeTest, AChangedInputIsImportedAndTheBuildBeginsAnew) {
  stop_in_leaves();
  TestMesh changed = tests::torus(5000, 0.01F);
  changed.positions[17].x += 0.25F;
  put("a.stl", stl_bytes(changed));
  ++files_.modified_ns;
  EXPECT_THAT(build(with_).text, HasSubstr("the input was changed"));
  EXPECT_THAT(problems(with_, with_.input), IsEmpty());
}

TEST_F(ImportResumeTest, AnInputThatIsNoMeshAnyMoreLeavesTheWorkAsItIs) {
  stop_in_leaves();
  const std::string good = content("a.stl");
  std::string bad = good;
  for (std::size_t facet = 84; facet + 50 <= bad.size(); facet += 50)
    bad.replace(facet + 12, 4, "\xff\xff\xff\xff");  // no number
  put("a.stl", bad);
  ++files_.modified_ns;
  EXPECT_EQ(failure(with_).code(), ErrorCode::input);
  put("a.stl", good);
  EXPECT_THAT(stages_of_rest(), Not(Contains("import")));
}

TEST_F(ImportResumeTest, OtherWorkIsNotThrownAway) {
  stop_in_leaves();
  with_.weld = true;
  try {
    build(with_);
    ADD_FAILURE() << "was not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::other_work);
    EXPECT_THAT(error.what(), HasSubstr("config.weld was false and is true"));
  }
  with_.weld = false;
  EXPECT_THAT(stages_of_rest(), Not(Contains("import")));
}

// ---- verify and dry run --------------------------------------------------------------------

TEST_F(ImportTest, VerifyFindsAnInputThatIsAnother) {
  TestMesh mesh = tests::sphere(2000);
  put("a.obj", obj_text(mesh));
  const config::Config with = config({"a.obj"});
  build(with);
  mesh.positions[7].y += 0.125F;
  put("b.obj", obj_text(mesh));
  EXPECT_THAT(problems(with, inputs({"b.obj"})), Contains(HasSubstr("some are not the same")));
  put("c.obj.gz", tests::gzip(content("a.obj")));
  EXPECT_THAT(problems(with, inputs({"c.obj.gz"})),
              testing::Each(testing::AnyOf(HasSubstr("bytes"), HasSubstr("checksum"))))
      << "the mesh is the same, the file is not";
  for (const fs::path& file : files_.list("w"))
    EXPECT_THAT(file.string(), Not(HasSubstr("meshhier-verify"))) << "left behind";
}

TEST_F(ImportTest, ADryRunCountsAndLeavesNothing) {
  const TestMesh mesh = tests::torus(5000);
  put("a.stl", stl_bytes(mesh));
  const std::vector<fs::path> before = files_.list("w");
  const pipeline::BuildEstimate estimate =
      pipeline::estimate_build(config({"a.stl"}), false, files_);
  EXPECT_EQ(estimate.mesh.vertex_count, mesh.positions.size());
  EXPECT_EQ(estimate.mesh.file_bytes, content("a.stl").size());
  EXPECT_THAT(pipeline::estimate_text(estimate), HasSubstr("binary STL (imported to count it)"));
  EXPECT_EQ(files_.list("w"), before);
  const pipeline::BuildReport report = build(config({"a.stl"}));
  EXPECT_EQ(report.stats.predicted_temporary_bytes, estimate.plan.disk.temporary_bytes);
  EXPECT_EQ(report.stats.predicted_output_bytes, estimate.plan.disk.output_bytes);
}

TEST_F(ImportTest, TheStatsTellOfTheImport) {
  put("a.obj", obj_text(tests::sphere(5000)));
  const pipeline::BuildStats stats = build(config({"a.obj"})).stats;
  ASSERT_FALSE(stats.stages.empty());
  EXPECT_EQ(stats.stages[0].name, "import");
  EXPECT_GT(stats.stages[0].bytes.temporary_written, 0U);
  EXPECT_EQ(stats.input_bytes, content("a.obj").size());
}

}  // namespace
}  // namespace meshhier::importing
