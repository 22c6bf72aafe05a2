#include "pipeline/ingest_stage.h"

#include "base/error.h"
#include "mesh_io/ply_writer.h"
#include "partition/top_tree.h"
#include "storage/io/file.h"
#include "storage/io/file_checksum.h"
#include "tests/support/interrupter.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/warnings.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iterator>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t kInFlight = 3;

using Triangles = std::vector<Triangle<VertexId>>;

struct AllTriangles {
  Triangles triangles;
  mesh_io::FaceCounts counts;
};

AllTriangles read_triangles(SourceMesh& mesh, std::size_t in_flight = kInFlight) {
  AllTriangles all;
  all.counts = mesh.read_triangles<Triangles>(
      in_flight, execution::CancelToken(),
      [](std::span<const Triangle<VertexId>> block, Triangles& slot) {
        slot.assign(block.begin(), block.end());
      },
      [&](const Triangles& slot) {
        all.triangles.insert(all.triangles.end(), slot.begin(), slot.end());
      });
  return all;
}

Triangles triangles_of(SourceMesh& mesh) {
  return read_triangles(mesh).triangles;
}

class SourceMeshTest : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name = "mesh.ply") const {
    return directory_.path() / name;
  }

  SourceMesh open(const std::filesystem::path& file) { return open(file, kInFlight, progress_); }
  SourceMesh open(const std::filesystem::path& file, std::size_t in_flight,
                  execution::Progress& progress) {
    BuildPlan plan{.tree = Tree(1, 1)};
    plan.memory.blocks_in_flight = in_flight;
    return ingest(mesh_io::open_mesh(*files_, file), file.filename().string(), scratch_,
                  {config_, plan, *files_, progress, cancel_});
  }

  /// A point cloud of double coordinates.
  SourceMesh open_points(const std::vector<Vec3d>& points) {
    mesh_io::PlyContent content;
    content.vertex_count = points.size();
    content.double_coordinates = true;
    mesh_io::PlyWriter writer(files_->create(path()), content);
    writer.write_vertices(points, {});
    writer.finish();
    return open(path());
  }

  SourceMesh open_text(const std::string& text) {
    std::ofstream(path(), std::ios::binary) << text;
    return open(path());
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  storage::ScratchFile scratch_{*files_, directory_.path() / "scratch", pool_};
  config::Config config_;
  execution::NoProgress progress_;
  execution::CancelToken cancel_;
};

struct Streamed {
  std::vector<Vec3f> positions;
  std::vector<float> attributes;
};

Streamed stream(const SourceMesh& mesh) {
  Streamed all;
  mesh_io::BlockMemory memory;
  for (std::uint64_t i = 0; i < mesh.vertex_blocks(); ++i) {
    const SourceVertices block = mesh.read_vertex_block(i, memory);
    EXPECT_EQ(block.first, all.positions.size());
    EXPECT_LE(block.positions.size(), mesh_io::MeshSource::kBlockSize);
    all.positions.insert(all.positions.end(), block.positions.begin(), block.positions.end());
    all.attributes.insert(all.attributes.end(), block.attributes.begin(), block.attributes.end());
  }
  return all;
}

std::string text_header(
    std::size_t vertices, std::size_t faces,
    const std::string& properties = "property float x\nproperty float y\nproperty float z\n") {
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << vertices << '\n'
       << properties << "element face " << faces
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  return text.str();
}

TEST_F(SourceMeshTest, WhichAttributesAreLabelsIsGuessedFromTheirValues) {
  constexpr int kRows = 6000;
  std::string text = text_header(kRows, 0,
                                 "property float x\nproperty float y\nproperty float z\n"
                                 "property ushort intensity\nproperty int object\n"
                                 "property float scalar_Classification\nproperty float quality\n");
  for (int i = 0; i < kRows; ++i)
    text +=
        fmt::format("{} 0 0 {} {} {} {}\n", i, i * 7 % 4096, i / 10, i % 3 == 0 ? 6 : 2, 0.5 * i);
  SourceMesh mesh = open_text(text);
  tests::Warnings progress;
  mesh.guess_labels([](const std::string&) { return false; }, progress);
  std::vector<std::string> labels;
  for (const ScalarAttribute& value : mesh.summary().attributes.values) {
    if (value.is_label)
      labels.push_back(value.name);
  }
  EXPECT_THAT(labels, ElementsAre("object"));
  EXPECT_THAT(progress.all,
              ElementsAre(HasSubstr(R"("labels": ["object", "intensity"] makes labels of them)"),
                          HasSubstr(R"("labels": ["object", "scalar_Classification"] in the)")));
  SourceMesh sure = open_text(text);
  sure.guess_labels([](const std::string& name) { return name == "intensity"; }, progress);
  EXPECT_TRUE(sure.summary().attributes.values[0].is_label) << "the input has names for them";
}

TEST_F(SourceMeshTest, FloatCoordinatesComeThroughAsTheyAre) {
  const tests::TestMesh sphere = tests::sphere(200'000, 0.01F);  // more than one block
  ASSERT_GT(sphere.positions.size(), mesh_io::MeshSource::kBlockSize);
  tests::write_ply(sphere, path());
  const SourceMesh mesh = open(path());
  EXPECT_TRUE(mesh.vertices_in_place());
  EXPECT_EQ(stream(mesh).positions, sphere.positions);
  EXPECT_EQ(mesh.origin(), Vec3d{});
  EXPECT_FALSE(mesh.summary().double_precision);
  EXPECT_EQ(mesh.summary().file_name, "mesh.ply");
  EXPECT_EQ(mesh.summary().file_bytes, std::filesystem::file_size(path()));
  BoundsD bounds;
  for (const Vec3f p : sphere.positions)
    bounds.add(to_double(p));
  EXPECT_EQ(mesh.summary().bounds, bounds);
}

TEST_F(SourceMeshTest, TextIsSpooledAndReadAgainFromThere) {
  const tests::TestMesh grid = tests::open_grid(299, 299, 0.25F);
  ASSERT_GT(grid.positions.size(), mesh_io::MeshSource::kBlockSize);
  std::ostringstream text;
  text.precision(9);
  text << text_header(grid.positions.size(), 0,
                      "property float x\nproperty float y\nproperty float z\n"
                      "property uchar red\nproperty uchar green\nproperty uchar blue\n");
  std::vector<float> colours;
  for (std::size_t v = 0; v < grid.positions.size(); ++v) {
    const Vec3f p = grid.positions[v];
    text << p.x << ' ' << p.y << ' ' << p.z << ' ' << v % 256 << " 7 " << v / 256 % 256 << '\n';
    colours.insert(colours.end(),
                   {static_cast<float>(v % 256), 7, static_cast<float>(v / 256 % 256)});
  }
  const SourceMesh mesh = open_text(text.str());
  EXPECT_FALSE(mesh.vertices_in_place());
  std::filesystem::remove(path());  // nothing is read from there again
  const Streamed all = stream(mesh);
  EXPECT_EQ(all.positions, grid.positions);
  EXPECT_EQ(all.attributes, colours);
}

TEST_F(SourceMeshTest, DoublesThatFitFloatNeedNoOrigin) {
  const SourceMesh mesh = open_points({{1000000, 0.5, -0.25}, {3, 2, 1}});
  EXPECT_FALSE(mesh.summary().double_precision);
  EXPECT_EQ(mesh.origin(), Vec3d{});
  EXPECT_THAT(stream(mesh).positions, ElementsAre(Vec3f{1000000, 0.5, -0.25}, Vec3f{3, 2, 1}));
}

TEST_F(SourceMeshTest, GeographicCoordinatesAreStoredRelativeToARoundOrigin) {
  std::vector<Vec3d> points;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    points.push_back({500123.4567 + 80 * double{tests::hash_noise(i, 1)},
                      5812345.6789 + 60 * double{tests::hash_noise(i, 2)},
                      112.3 + 10 * double{tests::hash_noise(i, 3)}});
  }
  const SourceMesh mesh = open_points(points);
  EXPECT_TRUE(mesh.summary().double_precision);
  const Vec3d origin = mesh.origin();
  EXPECT_NEAR(origin.x, 500123, 10);
  EXPECT_NEAR(origin.y, 5812345, 10);
  EXPECT_EQ(origin.x * 1024, std::round(origin.x * 1024));  // few digits
  const Streamed all = stream(mesh);
  ASSERT_EQ(all.positions.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(all.positions[i], to_float(points[i] - origin));
    // Within a few micrometres, where float alone would be off by a quarter of a metre.
    EXPECT_LT(length(to_double(all.positions[i]) + origin - points[i]), 1e-5);
  }
}

/// A grid of half metres in map coordinates that fit floats, and further vertices behind it.
std::string grid_on_the_map(const std::vector<Vec3d>& strays, const std::string& type,
                            const std::string& further_faces = "", int further_count = 0) {
  constexpr int kSide = 20;
  std::ostringstream text;
  text << std::fixed << std::setprecision(3);
  text << text_header(
      kSide * kSide + strays.size(),
      static_cast<std::size_t>((kSide - 1) * (kSide - 1) + further_count),
      "property " + type + " x\nproperty " + type + " y\nproperty " + type + " z\n");
  for (int i = 0; i < kSide * kSide; ++i)
    text << 447213 + i % kSide * 0.5 << ' ' << 5428731 + i / kSide * 0.5 << " 300\n";
  for (const Vec3d& p : strays)
    text << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (int i = 0; i < (kSide - 1) * (kSide - 1); ++i) {
    const int corner = i / (kSide - 1) * kSide + i % (kSide - 1);
    text << "3 " << corner << ' ' << corner + 1 << ' ' << corner + kSide << '\n';
  }
  text << further_faces;
  return text.str();
}

TEST_F(SourceMeshTest, CoordinatesThatAreLargeAgainstTheMeshGetAnOriginThoughTheyFitFloats) {
  const SourceMesh mesh = open_text(grid_on_the_map({}, "float"));
  EXPECT_FALSE(mesh.summary().double_precision);
  EXPECT_NEAR(mesh.origin().x, 447218, 1);
  EXPECT_NEAR(mesh.origin().y, 5428736, 1);
  const Streamed all = stream(mesh);
  for (std::size_t i = 0; i < all.positions.size(); ++i) {
    ASSERT_EQ(to_double(all.positions[i]) + mesh.origin(),
              (Vec3d{447213 + static_cast<double>(i % 20) * 0.5,
                     5428731 + static_cast<double>(i / 20) * 0.5, 300}));
  }
}

TEST_F(SourceMeshTest, VerticesThatNoTriangleUsesDoNotMoveTheOrigin) {
  const Vec3d origin = open_text(grid_on_the_map({}, "float")).origin();
  ASSERT_NE(origin, Vec3d{});
  const std::vector<std::vector<Vec3d>> strays = {
      {{0, 0, 0}},
      {{447220, 5428760, 300}},
      {{0.1, 0.1, 0.1}},
      {{-1e9, 1e9, 0}},
      {{0, 0, 0}, {1e6, 0, 0}, {0, 1e7, 0}},
      std::vector<Vec3d>(1000, Vec3d{}),
  };
  for (const std::vector<Vec3d>& stray : strays) {
    for (const char* type : {"float", "double"})
      EXPECT_EQ(open_text(grid_on_the_map(stray, type)).origin(), origin) << type << stray.size();
  }
}

TEST_F(SourceMeshTest, AFewTrianglesThatReachFarDoNotMoveItMuchAndAreNamed) {
  const SourceMesh without = open_text(grid_on_the_map({}, "double"));
  for (const Vec3d stray : {Vec3d{0, 0, 0}, Vec3d{447218, 0, 300}, Vec3d{447218, 5428736, 1e7}}) {
    tests::Warnings warnings;
    std::ofstream(path()) << grid_on_the_map({{1, 2, 3}, stray}, "double", "3 0 1 401\n", 1);
    const SourceMesh mesh = open(path(), kInFlight, warnings);
    EXPECT_LT(length(mesh.origin() - without.origin()), 2);
    EXPECT_THAT(warnings.all,
                ElementsAre(HasSubstr(fmt::format(
                    "far from nearly all of the mesh, to {} {} {}:", stray.x, stray.y, stray.z))));
  }
}

TEST_F(SourceMeshTest, DegreesBesideMetresAreTold) {
  const auto told = [&](double x, double step, double height) {
    tests::Warnings warnings;
    std::ofstream(path()) << std::setprecision(12)
                          << text_header(3, 1,
                                         "property double x\nproperty double y\n"
                                         "property double z\n")
                          << x << " 35.65 0\n"
                          << x + step << " 35.65 " << height << '\n'
                          << x << ' ' << 35.65 + step << " 0\n3 0 1 2\n";
    open(path(), kInFlight, warnings);
    return warnings.all;
  };
  EXPECT_THAT(told(139.7, 0.004, 60), ElementsAre(HasSubstr("longitude and latitude")));
  EXPECT_THAT(told(139.7, 0.4, 60), testing::IsEmpty()) << "a tower";
  EXPECT_THAT(told(639.7, 0.004, 60), testing::IsEmpty()) << "no longitude";
}

TEST_F(SourceMeshTest, WhatFloatsLoseOfAnEdgeIsTold) {
  const auto told = [&](const std::string& text) {
    tests::Warnings warnings;
    std::ofstream(path()) << text;
    open(path(), kInFlight, warnings);
    return warnings.all;
  };
  EXPECT_THAT(told(grid_on_the_map({}, "double")), testing::IsEmpty());
  // As many vertices around 0 hold no origin off.
  const auto two_places = [&](double far, double step) {
    std::ostringstream text;
    text << std::setprecision(17)
         << text_header(600, 200, "property double x\nproperty double y\nproperty double z\n");
    for (int i = 0; i < 600; ++i)
      text << (i % 2 == 0 ? 0.1 : far) + i * step << ' ' << i % 3 * step << " 0.3\n";
    for (int i = 0; i < 200; ++i)
      text << "3 " << i << ' ' << i + 2 << ' ' << i + 4 << '\n';
    return text.str();
  };
  EXPECT_THAT(told(two_places(1, 0.001)), testing::IsEmpty());
  EXPECT_THAT(told(two_places(1000, 0.001)),
              ElementsAre(AllOf(HasSubstr("% of the median edge of 0.00"), HasSubstr("round"))));
}

TEST_F(SourceMeshTest, BytesInAWiderTypeAreColoursOf8Bits) {
  struct Case {
    const char* type;
    const char* colours;  // colours of two vertices
    ColourType expected;
  };
  const std::vector<Case> cases{{"ushort", "200 180 40 0 0 255", ColourType::u8},
                                {"ushort", "200 180 40 0 0 256", ColourType::u16},
                                {"ushort", "65535 180 40 0 0 255", ColourType::u16},
                                {"ushort", "0 0 0 0 0 0", ColourType::u16},
                                {"float", "200 177.063 40 0 0 255", ColourType::u8},
                                {"float", "3 0 0 0 0 0", ColourType::u8},
                                {"float", "1 0.5 0.25 0 0 1", ColourType::f32},
                                {"float", "1.5 0.5 0.25 0 0 2", ColourType::f32},
                                {"float", "200 0 0 -1 0 0", ColourType::f32},
                                {"float", "200 0 0 256 0 0", ColourType::f32},
                                {"double", "200 0 0 255 0 0", ColourType::u8},
                                {"uchar", "1 2 3 4 5 6", ColourType::u8}};
  for (const Case& one : cases) {
    const std::string type = one.type;
    std::istringstream numbers(one.colours);
    std::vector<std::string> words{std::istream_iterator<std::string>(numbers), {}};
    std::ofstream(path()) << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                             "property float y\nproperty float z\nproperty "
                          << type << " red\nproperty " << type << " green\nproperty " << type
                          << " blue\nend_header\n0 0 0 " << words[0] << ' ' << words[1] << ' '
                          << words[2] << "\n1 0 0 " << words[3] << ' ' << words[4] << ' '
                          << words[5] << "\n";
    const SourceMesh mesh = open(path());
    const bool is_told = type != "uchar" && one.expected == ColourType::u8;
    EXPECT_EQ(mesh.summary().attributes.colour, one.expected) << type << ' ' << one.colours;
    EXPECT_EQ(mesh.summary().counts.size(), is_told ? 1U : 0U) << one.colours;
  }
}

TEST(ColourRangeTest, LightIsWhatItIs) {
  ColourRange range;
  const AttributeLayout light{.colour = ColourType::u16, .space = ColourSpace::linear};
  const std::vector<float> dark{1, 2, 255};
  range.add(dark, light);
  EXPECT_FALSE(range.are_bytes(light));
  EXPECT_TRUE(range.are_bytes({.colour = ColourType::u16}));
  ColourRange other;
  other.add(std::vector<float>{0, 0, 1, 256, 0, 0}, {.normals = true, .colour = ColourType::u16});
  range.add(other);
  EXPECT_FALSE(range.are_bytes({.colour = ColourType::u16}));
  EXPECT_FALSE(ColourRange().are_bytes({.colour = ColourType::u16})) << "of no vertices";
}

TEST_F(SourceMeshTest, TextDoublesEqualBinaryDoubles) {
  const std::vector<Vec3d> points = {{500123.25, 5812345.125, 0.1}, {500200.7, 5812300.3, 9}};
  const SourceMesh binary = open_points(points);
  std::ostringstream text;
  text.precision(17);
  text << text_header(2, 0, "property double x\nproperty double y\nproperty double z\n");
  for (const Vec3d p : points)
    text << p.x << ' ' << p.y << ' ' << p.z << '\n';
  std::ofstream(path("text.ply")) << text.str();
  const SourceMesh spooled = open(path("text.ply"));
  EXPECT_EQ(spooled.origin(), binary.origin());
  EXPECT_EQ(stream(spooled).positions, stream(binary).positions);
  EXPECT_EQ(spooled.summary().bounds, binary.summary().bounds);
}

TEST_F(SourceMeshTest, CoordinatesBeyondFloatAreRefused) {
  try {
    open_points({{1e39, 0, 0.1}, {-1e39, 1, 1}});
    FAIL() << "1e39 was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_THAT(error.what(), HasSubstr("mesh.ply"));
    EXPECT_THAT(error.what(), HasSubstr("in row 0 of 2 of element 'vertex'"));
  }
}

TEST_F(SourceMeshTest, TheSampleIsWhatItsIdsName) {
  const tests::TestMesh points = tests::points(3000);
  tests::write_ply(points, path());
  const std::vector<partition::IdPoint> sample = open(path()).take_sample({});
  const partition::SampleIds ids(3000);
  ASSERT_EQ(sample.size(), ids.count());
  for (std::size_t i = 0; i < sample.size(); ++i) {
    ASSERT_EQ(sample[i].id, ids[i]);
    ASSERT_EQ(sample[i].position, points.positions[sample[i].id]);
  }
}

TEST_F(SourceMeshTest, ASampleOfManyVerticesIsSpreadOverAll) {
  const std::size_t count = partition::kSampleVertices + 100'000;
  const tests::TestMesh points = tests::points(count);
  tests::write_ply(points, path());
  const std::vector<partition::IdPoint> sample = open(path()).take_sample({});
  ASSERT_EQ(sample.size(), partition::kSampleVertices);
  for (std::size_t i = 0; i < sample.size(); ++i) {
    ASSERT_EQ(sample[i].position, points.positions[sample[i].id]);
    ASSERT_LE(sample[i].id, (i + 1) * count / sample.size());
    ASSERT_GE(sample[i].id, i * count / sample.size());
  }
}

TEST_F(SourceMeshTest, ReadingTheTrianglesCountsThem) {
  SourceMesh mesh = open_text(text_header(5, 4) +
                              "0 0 0\n1 0 0\n1 1 0\n0 1 0\n9 9 9\n"
                              "4 0 1 2 3\n3 0 0 1\n3 0 1 2\n2 0 1\n");
  EXPECT_EQ(mesh.declared_faces(), 4U);
  const auto [triangles, counts] = read_triangles(mesh);
  const auto triangle = [](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return Triangle<VertexId>{VertexId{a}, VertexId{b}, VertexId{c}};
  };
  EXPECT_THAT(triangles, ElementsAre(triangle(0, 1, 2), triangle(0, 2, 3), triangle(0, 1, 2)));
  EXPECT_EQ(counts.faces, 4U);
  EXPECT_EQ(counts.triangles, 3U);
  EXPECT_EQ(counts.degenerate_triangles, 2U);
}

TEST_F(SourceMeshTest, TrianglesComeInFileOrderWhereverBlocksEnd) {
  const tests::TestMesh sphere = tests::sphere(300'000);  // several blocks of 40,000
  tests::write_ply(sphere, path());
  for (const std::size_t in_flight : {1U, 2U, 5U}) {
    SourceMesh mesh = open(path());
    const auto [triangles, counts] = read_triangles(mesh, in_flight);
    ASSERT_EQ(triangles.size(), sphere.triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (std::size_t corner = 0; corner < 3; ++corner)
        ASSERT_EQ(raw(triangles[i][corner]), sphere.triangles[i][corner]);
    }
    EXPECT_EQ(counts.triangles, sphere.triangles.size());
    EXPECT_EQ(counts.degenerate_triangles, 0U);
  }
}

/// Little endian: three points, then faces (lists of indices).
std::string binary_faces(const std::vector<std::vector<std::int32_t>>& faces) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face " +
      std::to_string(faces.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto put = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  for (const float coordinate : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F})
    put(&coordinate, sizeof coordinate);
  for (const auto& face : faces) {
    bytes += static_cast<char>(face.size());
    put(face.data(), face.size() * sizeof face[0]);
  }
  return bytes;
}

TEST_F(SourceMeshTest, APolygonAmongTrianglesEndsTheBlocksOnly) {
  for (const std::size_t polygon : {0U, 1U, 100'000U, 199'999U}) {
    std::vector<std::vector<std::int32_t>> faces(200'000, {0, 1, 2});
    faces[polygon] = {0, 1, 2, 1};
    faces[150'000] = {0, 0, 1};
    SourceMesh mesh = open_text(binary_faces(faces));
    const auto [triangles, counts] = read_triangles(mesh);
    EXPECT_EQ(triangles.size(), 200'000U) << polygon;
    EXPECT_EQ(counts.faces, 200'000U);
    EXPECT_EQ(counts.triangles, 200'000U);
    EXPECT_EQ(counts.degenerate_triangles, 1U);
  }
}

TEST_F(SourceMeshTest, OfSeveralBrokenFacesTheFirstIsNamed) {
  std::vector<std::vector<std::int32_t>> faces(300'000, {0, 1, 2});
  for (const std::size_t bad : {120'000U, 120'001U, 200'000U, 299'999U})
    faces[bad] = {0, 1, 3};
  const std::string bytes = binary_faces(faces);
  for (int round = 0; round < 5; ++round) {
    try {
      SourceMesh mesh = open_text(bytes);
      read_triangles(mesh, 8);
      FAIL() << "a vertex that is not there was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_THAT(error.what(), HasSubstr("row 120000 of 300000"));
    }
  }
}

TEST_F(SourceMeshTest, OfSeveralBrokenVerticesTheFirstIsNamed) {
  tests::TestMesh points = tests::points(400'000);
  for (const std::size_t bad : {150'000U, 150'001U, 250'000U, 399'999U})
    points.positions[bad].y = std::numeric_limits<float>::quiet_NaN();
  tests::write_ply(points, path());
  for (int round = 0; round < 5; ++round) {
    try {
      open(path(), 8, progress_);
      FAIL() << "a vertex that is not a number was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_THAT(error.what(), HasSubstr("row 150000 of 400000"));
    }
  }
}

TEST_F(SourceMeshTest, TheChecksumComesWithTheReading) {
  tests::write_ply(tests::sphere(300'000), path());
  const auto file = files_->open(path());
  const std::uint64_t expected = storage::FileChecksum(file->size()).complete(*file, [] {});
  SourceMesh mesh = open(path());
  triangles_of(mesh);
  const std::uint64_t before = files_->counters().bytes_read;
  EXPECT_EQ(mesh.checksum(cancel_), expected);
  EXPECT_EQ(files_->counters().bytes_read, before);  // nothing is read for its sake
}

TEST_F(SourceMeshTest, ABrokenVertexIsNamed) {
  try {
    open_text(text_header(2, 0) + "0 0 0\n0 nan 0\n");
    FAIL() << "a vertex that is not a number was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_THAT(error.what(), HasSubstr("mesh.ply"));
    EXPECT_THAT(error.what(), HasSubstr("line 11"));
  }
}

TEST_F(SourceMeshTest, ACancelledJobEndsWhileReading) {
  tests::write_ply(tests::points(200'000), path());
  tests::Interrupter progress(cancel_, 1);
  try {
    open(path(), kInFlight, progress);
    FAIL() << "read to the end";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
}

}  // namespace
}  // namespace meshhier::pipeline
