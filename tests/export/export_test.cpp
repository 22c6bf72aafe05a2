#include "export/export.h"

#include "base/error.h"
#include "export/clip_part.h"
#include "export/cut_mesh.h"
#include "export/geojson.h"
#include "hierarchy/cut.h"
#include "mesh_io/mesh_source.h"
#include "storage/format/layout.h"
#include "tests/support/error_message.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_copies.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::node;

/// The content of a mesh file; coordinates as doubles, exact for both widths.
struct Loaded {
  std::vector<Vec3d> positions;
  std::vector<float> attributes;
  std::vector<tests::MeshTriangle> triangles;
  bool wide = false;
};

Loaded load(storage::FileSystem& files, const fs::path& path) {
  Loaded mesh;
  const auto source = mesh_io::open_mesh(files, path);
  mesh.wide = source->description().wide_coordinates;
  source->read_vertices([&](const mesh_io::VertexBlock& block) {
    for (Vec3f p : block.positions)
      mesh.positions.push_back(to_double(p));
    mesh.positions.insert(mesh.positions.end(), block.exact.begin(), block.exact.end());
    mesh.attributes.insert(mesh.attributes.end(), block.attributes.begin(), block.attributes.end());
  });
  source->read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
    for (const auto& t : triangles)
      mesh.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
  });
  return mesh;
}

/// A mesh as a multiset of triangles, each a list of coordinates that starts with its least corner.
std::vector<std::vector<double>> surface(const Loaded& mesh, std::size_t channels = 0) {
  std::vector<std::vector<double>> triangles;
  for (const auto& t : mesh.triangles) {
    std::array<std::vector<double>, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d p = mesh.positions[t[i]];
      corners[i] = {p.x, p.y, p.z};
      for (std::size_t c = 0; c < channels; ++c) {
        corners[i].push_back(double{mesh.attributes[t[i] * channels + c]});
      }
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::vector<double>& flat = triangles.emplace_back();
    for (const auto& corner : corners)
      flat.insert(flat.end(), corner.begin(), corner.end());
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

class ExportTest : public testing::Test {
 protected:
  fs::path hierarchy() const { return directory_.path() / "a.hier"; }
  fs::path output() const { return directory_.path() / "out.ply"; }

  tests::Sample publish(const tests::TestMesh& mesh, const tests::SampleOptions& options = {}) {
    tests::Sample sample = tests::make_sample(mesh, options);
    tests::write_sample(*files_, hierarchy(), sample);
    return sample;
  }
  std::string run(ExportSelection selection, std::uint64_t budget = 1 << 30) {
    return run_on(*files_, std::move(selection), budget);
  }
  std::string run_on(storage::FileSystem& files, ExportSelection selection, std::uint64_t budget) {
    return run_all(files, {std::move(selection), output(), budget, true});
  }
  std::string run_all(storage::FileSystem& files, const ExportOptions& options) {
    execution::NoProgress progress;
    return export_mesh(files, hierarchy(), options, progress, execution::CancelToken());
  }
  Error error_of(ExportSelection selection) {
    try {
      run(std::move(selection));
    } catch (const Error& error) {
      return error;
    }
    return {ErrorCode::internal, "no error"};
  }
  fs::path write_cut(const std::string& text) {
    std::ofstream(directory_.path() / "cut.txt") << text;
    return directory_.path() / "cut.txt";
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory_.path())) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  static std::string bytes_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(ExportTest, TheLastLevelIsTheInputWithAttributesAndCopies) {
  for (const auto& mesh : {tests::sphere(900), tests::duplicates(700), tests::soup(90)}) {
    const tests::Sample sample = publish(mesh, {7, 30, false, true, {}});
    run(sample.tree.depth());
    const Loaded exported = load(*files_, output());
    Loaded input;
    for (Vec3f p : sample.ranked.positions)
      input.positions.push_back(to_double(p));
    input.attributes = sample.attributes;
    input.triangles = sample.ranked.triangles;
    EXPECT_EQ(exported.positions.size(), mesh.positions.size());
    EXPECT_EQ(surface(exported, 3), surface(input, 3));
    EXPECT_FALSE(exported.wide);
  }
}

TEST_F(ExportTest, EveryLevelOfAClosedSurfaceIsClosed) {
  const tests::Sample sample = publish(tests::torus(3000), {13, 60, true, false, {}});
  for (int level = 0; level <= raw(sample.tree.depth()); ++level) {
    run(static_cast<Level>(level));
    const Loaded mesh = load(*files_, output());
    EXPECT_FALSE(mesh.triangles.empty()) << level;
    EXPECT_TRUE(tests::boundary_edges(mesh.triangles).empty()) << level;
  }
}

TEST_F(ExportTest, ACutOfMixedLevelsSharesItsVertices) {
  const tests::Sample sample = publish(tests::torus(3000), {6, 60, false, false, {}});
  const std::string line = run(write_cut("1/0  # left\n2/2\n3/5\n"));
  const Loaded mesh = load(*files_, output());
  EXPECT_TRUE(tests::boundary_edges(mesh.triangles).empty());
  EXPECT_EQ(mesh.positions.size(), 60 + 60 + sample.tree.ranks(node(3, 5)).size());
  EXPECT_THAT(line, HasSubstr("cut: 3 tiles"));
  const std::string bytes = bytes_of(output());
  run(write_cut(R"(["3/5", "1/0", "2/2"])"));
  EXPECT_EQ(bytes_of(output()), bytes);
}

TEST_F(ExportTest, SLOW_ResultDoesNotDependOnTheBudget) {
  const tests::Sample sample = publish(tests::sphere(300000), {40, 2000, false, false, {}});
  run(sample.tree.depth());
  const std::string bytes = bytes_of(output());
  run(sample.tree.depth(), 0);
  EXPECT_EQ(bytes_of(output()), bytes);
  EXPECT_THAT(names(), testing::ElementsAre("a.hier", "out.ply"));
}

TEST_F(ExportTest, ANodesTileComesWithItsGhosts) {
  const tests::Sample sample = publish(tests::sphere(900), {6, 50, false, false, {}});
  for (NodeId wanted : {node(0, 0), node(1, 1), node(2, 0), node(3, 2)}) {
    run(wanted);
    const Loaded mesh = load(*files_, output());
    const auto& tile = const_cast<tests::Sample&>(sample).tile(wanted).mesh;
    EXPECT_EQ(mesh.positions.size(), tile.vertices.size());
    EXPECT_EQ(mesh.triangles.size(), tile.interior.size() + tile.border.size());
  }
  run(node(3, 2));
  const std::string bytes = bytes_of(output());
  run(node(2, 1));  // early: its partition stands for it
  EXPECT_EQ(bytes_of(output()), bytes);
}

TEST_F(ExportTest, AnOriginIsAddedInDoubles) {
  const Vec3d origin{500000.125, 5000000.5, -70.25};
  const tests::Sample sample = publish(tests::sphere(900), {6, 50, false, false, origin});
  run(sample.tree.depth());
  const Loaded mesh = load(*files_, output());
  EXPECT_TRUE(mesh.wide);
  BoundsD found, expected;
  for (Vec3d p : mesh.positions)
    found.add(p);
  for (Vec3f p : sample.ranked.positions)
    expected.add(to_double(p) + origin);
  EXPECT_EQ(found, expected);
}

TEST_F(ExportTest, TheOutlineIsVerticesAndEdges) {
  publish(tests::sphere(900));
  EXPECT_THAT(run(OutlineSelection{}), HasSubstr("2 lines, 7 vertices, 5 edges"));
  const std::string bytes = bytes_of(output());
  EXPECT_THAT(bytes, HasSubstr("element vertex 7"));
  EXPECT_THAT(bytes, HasSubstr("element edge 5"));
  const std::array<std::int32_t, 2> last{5, 6};
  EXPECT_EQ(std::memcmp(bytes.data() + bytes.size() - 8, last.data(), 8), 0);
}

TEST_F(ExportTest, AnErrorIsTheCutOfTheCoarsestTilesThatAllowIt) {
  const tests::Sample sample = publish(tests::sphere(900), {7, 30, false, true, {}});
  run(LargestError{0});
  const Loaded finest = load(*files_, output());
  run(sample.tree.depth());
  EXPECT_EQ(surface(finest), surface(load(*files_, output())));
  run(LargestError{1e9});
  const Loaded coarsest = load(*files_, output());
  run(Level{0});
  EXPECT_EQ(surface(coarsest), surface(load(*files_, output())));
}

/// Returns the area of the part of a triangle that lies in a box, by its own way: the polygon's
/// corners, one side after the other.
double area_in(std::vector<Vec3d> polygon, const BoundsD& box) {
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1 : -1;
    const double limit = sign * (side % 2 == 0 ? box.max : box.min)[axis];
    std::vector<Vec3d> next;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const double x = sign * a[axis] - limit, y = sign * b[axis] - limit;
      if (x <= 0)
        next.push_back(a);
      if (x * y < 0)
        next.push_back(a + (b - a) * (x / (x - y)));
    }
    polygon = next;
  }
  double twice = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    twice += length(cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]));
  return polygon.size() < 3 ? -1 : twice / 2;
}

std::vector<Vec3d> corners_of(const Loaded& mesh, const tests::MeshTriangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

double area(const Loaded& mesh) {
  double area = 0;
  for (const tests::MeshTriangle& t : mesh.triangles) {
    const auto c = corners_of(mesh, t);
    area += length(cross(c[1] - c[0], c[2] - c[0])) / 2;
  }
  return area;
}

/// Edges of one triangle alone whose middle is well within the region, seen from above: gaps.
std::size_t open_edges_within(const Loaded& mesh, const RegionRequest& request) {
  const auto files = storage::make_posix_file_system();
  const PlanRegion region(read_polygons(*files, request.polygon), UpAxis::y);
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const tests::MeshTriangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    if (count != 1)
      continue;
    const Vec3d middle = (mesh.positions[edge[0]] + mesh.positions[edge[1]]) * 0.5;
    constexpr double kWell = 1e-5;
    bool is_within = true;
    for (const Vec3d step :
         {Vec3d{kWell, 0, 0}, Vec3d{-kWell, 0, 0}, Vec3d{0, 0, kWell}, Vec3d{0, 0, -kWell}})
      is_within = is_within && region.contains(middle + step);
    open += is_within ? 1 : 0;
  }
  return open;
}

const BoundsD kSomeBox{{-0.4, -2, -0.9}, {0.7, 0.3, 0.45}};

class ExportBoxTest : public ExportTest {
 protected:
  Loaded piece(const ExportSelection& selection, const BoundsD& box, bool clip,
               std::uint64_t budget = 1 << 30) {
    run_all(*files_, {selection, output(), budget, true, {.box = box}, clip});
    return load(*files_, output());
  }
  Loaded all(const ExportSelection& selection) {
    run(selection);
    return load(*files_, output());
  }
};

TEST_F(ExportBoxTest, WholeTrianglesAreThoseThatTouchIt) {
  publish(tests::sphere(900), {7, 30, false, true, {}});
  for (const ExportSelection& selection :
       std::vector<ExportSelection>{Level{0}, Level{2}, Level{3}, write_cut("1/0\n2/2\n2/3")}) {
    Loaded wanted = all(selection);
    std::erase_if(wanted.triangles, [&](const tests::MeshTriangle& t) {
      return area_in(corners_of(wanted, t), kSomeBox) < 0;
    });
    const Loaded got = piece(selection, kSomeBox, false);
    EXPECT_EQ(surface(got), surface(wanted));
    EXPECT_FALSE(got.triangles.empty());
    std::vector<bool> used(got.positions.size());
    for (const auto& t : got.triangles)
      used[t[0]] = used[t[1]] = used[t[2]] = true;
    EXPECT_TRUE(std::ranges::all_of(used, [](bool is) { return is; }));
  }
}

TEST_F(ExportBoxTest, ABoxThatIsAVertexIsTouchedByItsTriangles) {
  publish(tests::sphere(900), {7, 30, false, true, {}});
  const Loaded whole = all(Level{3});
  for (std::size_t v = 0; v < whole.positions.size(); v += 40) {
    const Vec3d place = whole.positions[v];
    Loaded wanted = whole;
    std::erase_if(wanted.triangles, [&](const tests::MeshTriangle& t) {
      return std::ranges::count(corners_of(whole, t), place) == 0;
    });
    EXPECT_EQ(surface(piece(Level{3}, {place, place}, false)), surface(wanted)) << v;
  }
}

TEST_F(ExportBoxTest, TheBoxOfAllIsTheMesh) {
  for (const auto& mesh : {tests::sphere(900), tests::duplicates(700), tests::soup(90)}) {
    const tests::Sample sample = publish(mesh, {7, 30, false, true, {}});
    const Loaded whole = all(sample.tree.depth());
    const Loaded got = piece(sample.tree.depth(), {{-9, -9, -9}, {9, 9, 9}}, true);
    EXPECT_EQ(surface(got, 3), surface(whole, 3));
    fs::remove_all(hierarchy());
  }
}

using Place = std::array<double, 3>;

/// Returns whether both places lie on a side of kSomeBox, as floats have it.
bool is_on_side(const Place& a, const Place& b) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {kSomeBox.min[axis], kSomeBox.max[axis]}) {
      const double there = double{static_cast<float>(side)};
      const auto i = static_cast<std::size_t>(axis);
      if (a[i] == there && b[i] == there)
        return true;
    }
  }
  return false;
}

TEST_F(ExportBoxTest, ClippedItEndsAtTheBoxAndNowhereElse) {
  publish(tests::torus(3000), {13, 60, false, false, {}});
  for (const ExportSelection& selection :
       std::vector<ExportSelection>{Level{1}, Level{3}, write_cut("1/0\n2/2\n2/3")}) {
    const Loaded whole = all(selection);
    double wanted = 0;
    for (const auto& t : whole.triangles)
      wanted += std::max(0.0, area_in(corners_of(whole, t), kSomeBox));
    const Loaded got = piece(selection, kSomeBox, true);
    double area = 0;
    std::map<std::pair<Place, Place>, int> edges;
    const auto place_of = [&](std::uint32_t vertex) {
      const Vec3d p = got.positions[vertex];
      return Place{p.x, p.y, p.z};
    };
    for (const auto& t : got.triangles) {
      area += std::max(0.0, area_in(corners_of(got, t), {{-9, -9, -9}, {9, 9, 9}}));
      for (std::size_t i = 0; i < 3; ++i) {
        const Place from = place_of(t[i]), to = place_of(t[(i + 1) % 3]);
        ++edges[std::minmax(from, to)];
      }
    }
    EXPECT_NEAR(area, wanted, 1e-5 * wanted);
    for (const auto& [edge, count] : edges)
      EXPECT_TRUE(count > 1 || is_on_side(edge.first, edge.second));
  }
}

TEST_F(ExportBoxTest, TilesElsewhereAreNotRead) {
  const tests::Sample sample = publish(tests::sphere(900), {7, 30, false, true, {}});
  for (const NodeId tile : sample.tree.tile_nodes()) {
    const storage::HierarchyReader reader(*files_, hierarchy());
    const Bounds bounds = reader.record(tile).bounds;
    if (bounds.min.x > 0.7F || bounds.min.y > 0.3F || bounds.min.z > 0.45F ||
        bounds.max.z < -0.9F || bounds.max.x < -0.4F)
      fs::remove(storage::tile_path(hierarchy(), tile));
  }
  EXPECT_FALSE(piece(sample.tree.depth(), kSomeBox, true).triangles.empty());
  EXPECT_EQ(error_of(sample.tree.depth()).code(), ErrorCode::io);
}

TEST_F(ExportBoxTest, ResultDoesNotDependOnTheBudget) {
  publish(tests::sphere(2000), {9, 40, false, true, {}});
  piece(Level{3}, kSomeBox, true);
  const std::string large = bytes_of(output());
  piece(Level{3}, kSomeBox, true, 1 << 20);
  EXPECT_EQ(bytes_of(output()), large);
}

TEST_F(ExportBoxTest, CutEdgesMixWhatTheirEndsHave) {
  CutPart part;
  part.vertices.channels = 6;
  part.vertices.append({0, 0, 0}, std::array{0.F, 0.F, 1.F, 0.F, 0.F, 0.F});
  part.vertices.append({1, 0, 0}, std::array{1.F, 0.F, 0.F, 255.F, 255.F, 0.F});
  part.vertices.append({0, 1, 0}, std::array{0.F, 0.F, 1.F, 10.F, 0.F, 0.F});
  part.places = {5, 6, 7};
  part.texcoords = {{0, 0}, {1, 0}, {0, 1}};
  part.triangles = {{0, 1, 2}};
  part.image.bytes.resize(3);
  const AttributeLayout layout{.normals = true, .colour = ColourType::u8};
  const Region half{ConvexRegion::of_box({{-1, -1, -1}, {0.5, 2, 2}}), nullptr, nullptr};
  const CutPart made = clip_part(part, layout, half, Clipping::at_border);
  ASSERT_EQ(made.vertices.size(), 4U);
  EXPECT_EQ(made.triangles.size(), 2U);
  EXPECT_EQ(made.places, (std::vector<std::uint32_t>{5, 7, kNoPlace, kNoPlace}));
  EXPECT_EQ(made.vertices.positions[2], (Vec3f{0.5F, 0, 0}));
  EXPECT_EQ(made.texcoords[2], (Vec2f{0.5F, 0}));
  const auto attributes = made.vertices.attributes_of(2);
  EXPECT_FLOAT_EQ(attributes[0], std::sqrt(0.5F));
  EXPECT_FLOAT_EQ(attributes[2], std::sqrt(0.5F));
  EXPECT_EQ(attributes[3], 188);  // half the light of 255
  EXPECT_EQ(made.image.bytes.size(), 3U);
  const Region none{ConvexRegion::of_box({{3, 3, 3}, {4, 4, 4}}), nullptr, nullptr};
  EXPECT_TRUE(clip_part(part, layout, none, Clipping::at_border).image.bytes.empty());
  EXPECT_EQ(clip_part(part, layout, half, Clipping::whole_triangles).triangles, part.triangles);
}

/// A triangle with a notch, and a hole in it, in the x-z plane: y points up, so z is to the south.
constexpr const char* kNotched = R"({"type": "Feature", "geometry": {"type": "Polygon",
    "coordinates": [[[-0.9, -0.9], [0.8, -0.7], [0.1, 0.1], [0.2, 0.95], [-0.9, -0.9]],
                    [[-0.1, -0.5], [0.2, -0.5], [0.1, -0.2], [-0.1, -0.5]]]}})";

TEST_F(ExportBoxTest, APolygonIsCutOutSeenFromAbove) {
  std::ofstream(directory_.path() / "notched.geojson") << kNotched;
  const RegionRequest region{.polygon = directory_.path() / "notched.geojson"};
  publish(tests::open_grid(40, 40), {7, 30, false, true, {}});
  const auto cut_out = [&](const ExportSelection& selection, bool clip) {
    run_all(*files_, {selection, output(), 1 << 30, true, region, clip});
    return load(*files_, output());
  };
  // The grid lies in the x-y plane: from above it is a line, and strips of it stay.
  const Loaded grid = cut_out(Level{3}, true);
  EXPECT_FALSE(grid.triangles.empty());
  fs::remove_all(hierarchy());

  publish(tests::sphere(900), {7, 30, false, true, {}});
  for (const ExportSelection& selection :
       std::vector<ExportSelection>{Level{0}, Level{2}, write_cut("1/0\n2/2\n2/3")}) {
    const Loaded whole = cut_out(selection, false), cut = cut_out(selection, true);
    EXPECT_GT(whole.triangles.size(), 10U);
    EXPECT_GT(area(whole), area(cut));
    EXPECT_EQ(open_edges_within(cut, region), 0U);
  }
  const Loaded finest = cut_out(Level{3}, true);
  double signed_area = 0;
  for (const auto& t : finest.triangles) {
    const auto c = corners_of(finest, t);
    signed_area += cross(c[1] - c[0], c[2] - c[0]).y / 2;
  }
  EXPECT_NEAR(signed_area, 0, 1e-6) << "as the sphere is closed, upper and lower side are equal";
}

TEST_F(ExportBoxTest, BoxAndPolygonTogether) {
  std::ofstream(directory_.path() / "notched.geojson") << kNotched;
  publish(tests::sphere(900), {7, 30, false, true, {}});
  const auto cut_out = [&](const RegionRequest& region) {
    run_all(*files_, {Level{2}, output(), 1 << 30, true, region, true});
    return area(load(*files_, output()));
  };
  const fs::path polygon = directory_.path() / "notched.geojson";
  const BoundsD upper{{-9, 0.01, -9}, {9, 9, 9}}, lower{{-9, -9, -9}, {9, 0.01, 9}};
  EXPECT_NEAR(
      cut_out({.box = upper, .polygon = polygon}) + cut_out({.box = lower, .polygon = polygon}),
      cut_out({.polygon = polygon}), 1e-5);
}

TEST_F(ExportBoxTest, NodesHavePiecesToo) {
  publish(tests::sphere(100), {3, 10, false, true, {}});
  run(node(0, 0));
  const std::size_t all = load(*files_, output()).triangles.size();
  piece(node(0, 0), kSomeBox, false);
  const std::size_t some = load(*files_, output()).triangles.size();
  EXPECT_GT(some, 0u);
  EXPECT_LT(some, all);
}

TEST_F(ExportBoxTest, WhatIsNoneIsTold) {
  publish(tests::sphere(100), {3, 10, false, true, {}});
  const auto said = [&](const ExportSelection& selection, const BoundsD& box) -> std::string {
    return tests::usage_error([&] { piece(selection, box, false); });
  };
  EXPECT_THAT(said(Level{0}, {{5, 5, 5}, {6, 6, 6}}), HasSubstr("no triangle lies in the box"));
  EXPECT_THAT(said(Level{0}, {{1, 0, 0}, {0, 1, 1}}), HasSubstr("the box is none"));
  EXPECT_THAT(said(Level{0}, {{0, 0, 0}, {0, 1, std::nan("")}}), HasSubstr("the box is none"));
  EXPECT_THAT(said(OutlineSelection{}, kSomeBox), HasSubstr("a piece (box) is taken of a level"));
  const auto refused = [&](const RegionRequest& region) {
    try {
      run_all(*files_, {Level{0}, output(), 1 << 30, true, region, false});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const tests::TemporaryDirectory beside;
  const fs::path polygon = beside.path() / "far.geojson";
  std::ofstream(polygon)
      << R"({"type": "Polygon", "coordinates": [[[13, 52], [14, 52], [14, 53]]]})";
  EXPECT_THAT(refused({.polygon = polygon}),
              HasSubstr("give its --crs (of degrees \"EPSG:4326\")"));
  EXPECT_THAT(refused({.polygon = polygon, .crs = "EPSG:4326"}),
              HasSubstr("stands on no map, so that a CRS says nothing"));
  EXPECT_EQ(names(), std::vector<std::string>{"a.hier"});
}

TEST_F(ExportTest, WhatIsNotInTheTreeIsAUsageError) {
  publish(tests::sphere(900), {6, 50, false, false, {}});
  EXPECT_EQ(error_of(static_cast<Level>(4)).code(), ErrorCode::usage);
  EXPECT_THAT(error_of(static_cast<Level>(4)).what(), HasSubstr("the levels are 0 to 3"));
  EXPECT_EQ(error_of(node(2, 4)).code(), ErrorCode::usage);
  EXPECT_THAT(error_of(node(2, 4)).what(), HasSubstr("the nodes of level 2 are 0 to 3"));
  const Error gap = error_of(write_cut("1/0\n"));
  EXPECT_EQ(gap.code(), ErrorCode::usage);
  EXPECT_THAT(gap.what(), HasSubstr("cut.txt: not a cut: no node covers partitions 3 to 5"));
  EXPECT_EQ(error_of(directory_.path() / "none.txt").code(), ErrorCode::io);
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(ExportTest, AMistypedDirectoryIsNotMade) {
  publish(tests::sphere(900));
  execution::NoProgress progress;
  const fs::path wrong = directory_.path() / "none" / "out.ply";
  EXPECT_THROW(
      export_mesh(*files_, hierarchy(), {Level{}, wrong}, progress, execution::CancelToken()),
      Error);
  EXPECT_FALSE(fs::exists(directory_.path() / "none"));
}

TEST_F(ExportTest, FailureLeavesTheOldOutputAndNothingElse) {
  const tests::Sample sample = publish(tests::sphere(30000), {6, 50, false, false, {}});
  std::ofstream(output()) << "old";
  for (std::uint64_t room : {0, 1000, 100000}) {
    tests::FaultyFileSystem files;
    files.limit_room(room);
    EXPECT_THROW(run_on(files, sample.tree.depth(), 0), Error) << room;
    EXPECT_THAT(names(), testing::ElementsAre("a.hier", "out.ply"));
    EXPECT_EQ(bytes_of(output()), "old");
  }
  execution::NoProgress progress;
  execution::CancelToken cancel;
  cancel.cancel();
  EXPECT_THROW(export_mesh(*files_, hierarchy(), {Level{}, output()}, progress, cancel), Error);
  EXPECT_EQ(bytes_of(output()), "old");
  EXPECT_THAT(names(), testing::ElementsAre("a.hier", "out.ply"));
}

TEST_F(ExportTest, AnOutputInsideTheHierarchyIsRefused) {
  publish(tests::sphere(900));
  const fs::path index = storage::index_path(hierarchy());
  const std::string before = bytes_of(index);
  execution::NoProgress progress;
  try {
    export_mesh(*files_, hierarchy(), {Level{}, index}, progress, execution::CancelToken());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
  }
  EXPECT_EQ(bytes_of(index), before);
}

TEST_F(ExportTest, ABrokenTileIsToldAndNothingWritten) {
  publish(tests::sphere(900));
  const fs::path tile = storage::tile_path(hierarchy(), node(1, 1));
  fs::resize_file(tile, fs::file_size(tile) - 4);
  const Error error = error_of(static_cast<Level>(1));
  EXPECT_EQ(error.code(), ErrorCode::corrupt);
  EXPECT_THAT(error.what(), HasSubstr("000001.glb"));
  EXPECT_THAT(names(), testing::ElementsAre("a.hier"));
}

// Places with several vertices.

/// Without triangles that have no area.
std::vector<std::vector<double>> shown_surface(const Loaded& mesh) {
  Loaded shown = mesh;
  std::erase_if(shown.triangles, [&](const tests::MeshTriangle& t) {
    return mesh.positions[t[0]] == mesh.positions[t[1]] ||
           mesh.positions[t[1]] == mesh.positions[t[2]] ||
           mesh.positions[t[2]] == mesh.positions[t[0]];
  });
  return surface(shown);
}

class ExportCopiesTest : public ExportTest {
 protected:
  tests::WedgedInput publish_copies(const tests::TestMesh& mesh, std::uint32_t partitions,
                                    const tests::CopiesOptions& copies = {false, true}) {
    sample_.emplace(tests::make_sample(mesh, {partitions, 30, false, true, {}}));
    tests::WedgedInput input = tests::add_copies(*sample_, copies);
    fs::remove_all(hierarchy());
    tests::write_sample(*files_, hierarchy(), *sample_);
    return input;
  }

  std::optional<tests::Sample> sample_;
};

TEST_F(ExportCopiesTest, TheLastLevelIsTheInput) {
  for (const auto& mesh : {tests::sphere(900), tests::duplicates(700), tests::non_manifold(400)}) {
    for (const tests::CopiesOptions copies : {tests::CopiesOptions{false, true}, {true, true}}) {
      const tests::WedgedInput wedged = publish_copies(mesh, 8, copies);
      ASSERT_GT(wedged.mesh.positions.size(), mesh.positions.size());
      Loaded input{{}, wedged.attributes, wedged.mesh.triangles};
      for (Vec3f p : wedged.mesh.positions)
        input.positions.push_back(to_double(p));
      run(sample_->tree.depth());
      const Loaded exported = load(*files_, output());
      EXPECT_EQ(exported.positions, input.positions);
      EXPECT_EQ(exported.attributes, input.attributes);
      // Corners too, where a place's vertices are alike.
      for (tests::MeshTriangle& t : input.triangles)
        t = canonical(t);
      std::sort(input.triangles.begin(), input.triangles.end());
      EXPECT_EQ(exported.triangles, input.triangles);
    }
  }
}

TEST_F(ExportCopiesTest, EveryCutShowsTheSurfaceOfItsPlaces) {
  const tests::TestMesh torus = tests::torus(3000);
  for (const std::string cut : {"0/0", "1/0\n1/1", "1/0\n2/2\n2/3", "2/0\n3/2\n3/3\n1/1"}) {
    publish(torus, {8, 30, false, true, {}});
    run(write_cut(cut));
    const auto plain = shown_surface(load(*files_, output()));
    fs::remove_all(hierarchy());
    publish_copies(torus, 8);
    run(write_cut(cut));
    EXPECT_EQ(shown_surface(load(*files_, output())), plain) << cut;
  }
}

/// The corners of what tile 2/2 draws in the cut 1/0, 2/2, 2/3: of those in 1/0 the vertex that is
/// most like the tile's own there.
std::vector<std::vector<double>> expected_seam(tests::Sample& sample, const DrawnTile& drawn) {
  const PublishedTile& tile = sample.tile(node(2, 2));
  const TileMesh& coarse = sample.tile(node(1, 0)).mesh;
  Loaded expected;
  const auto add = [&](Vec3f position, std::span<const float> attributes) {
    expected.positions.push_back(to_double(position));
    expected.attributes.insert(expected.attributes.end(), attributes.begin(), attributes.end());
  };
  const auto attributes_of = [](const TileMesh& mesh, std::uint32_t place, std::uint32_t wedge) {
    return wedge == 0 ? mesh.vertices.attributes_of(place)
                      : mesh.copies.vertices.attributes_of(mesh.copies.first_of(place) + wedge - 1);
  };
  const auto add_corner = [&](std::uint32_t place, std::uint32_t wedge) {
    const auto own = attributes_of(tile.mesh, place, wedge);
    const std::size_t ghost = place - tile.mesh.own_count;
    if (place < tile.mesh.own_count || tile.mesh.ghosts[ghost].tile > 1)
      return add(tile.mesh.vertices.positions[place], own);
    const std::uint32_t there = tile.chains[ghost][1];
    const auto count = static_cast<std::uint32_t>(1 + coarse.copies.first_of(there + 1) -
                                                  coarse.copies.first_of(there));
    std::span<const float> nearest;
    double least = 1e30;
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto candidate = attributes_of(coarse, there, k);
      double away = 0;
      for (std::size_t c = 0; c < 3; ++c)
        away += std::pow(double{candidate[c]} - double{own[c]}, 2);
      if (away < least)
        nearest = candidate;
      least = std::min(least, away);
    }
    add(coarse.vertices.positions[there], nearest);
  };
  for (const std::uint32_t i : drawn.border) {
    const auto first = static_cast<std::uint32_t>(expected.positions.size());
    for (std::size_t c = 0; c < 3; ++c)
      add_corner(raw(tile.mesh.border[i][c]), tile.mesh.border_wedges[i][c]);
    expected.triangles.push_back({first, first + 1, first + 2});
  }
  return surface(expected, 3);
}

TEST_F(ExportCopiesTest, BesideACoarserTileACornerIsTheVertexMostLikeIt) {
  publish_copies(tests::torus(3000), 4);
  run(write_cut("1/0\n2/2\n2/3\n"));
  const auto exported = surface(load(*files_, output()), 3);
  const storage::HierarchyReader reader(*files_, hierarchy());
  const auto numbered =
      number_vertices(reader, Cut(reader.tree(), {node(1, 0), node(2, 2), node(2, 3)}));
  const auto expected =
      expected_seam(*sample_, draw_tile(reader.tree(), numbered, 1, reader.read_tile(node(2, 2))));
  EXPECT_GT(expected.size(), 20U);
  EXPECT_TRUE(std::includes(exported.begin(), exported.end(), expected.begin(), expected.end()));
}

TEST_F(ExportCopiesTest, ANodesTileComesWithTheCopiesOfItsFile) {
  publish_copies(tests::sphere(900), 4);
  for (NodeId wanted : {node(0, 0), node(1, 1), node(2, 2)}) {
    run(wanted);
    const Loaded mesh = load(*files_, output());
    const TileMesh& tile = sample_->tile(wanted).mesh;
    EXPECT_EQ(mesh.positions.size(), tile.vertices.size() + tile.copies.size());
    EXPECT_EQ(mesh.triangles.size(), tile.interior.size() + tile.border.size());
    std::uint32_t corners_at_copies = 0;
    for (const auto& t : mesh.triangles)
      corners_at_copies += static_cast<std::uint32_t>(
          std::count_if(t.begin(), t.end(), [&](auto v) { return v >= tile.vertices.size(); }));
    EXPECT_GT(corners_at_copies, 50U);
  }
}

TEST_F(ExportCopiesTest, ACopyThatItsTileHasNotIsTold) {
  publish_copies(tests::sphere(900), 4);
  PublishedTile& tile = sample_->tile(node(2, 1));
  Copies& copies = tile.mesh.copies;
  ASSERT_EQ(tile.mesh.ghosts.front().tile, 0U);
  for (std::size_t i = copies.first_of(tile.mesh.own_count); i < copies.size(); ++i)
    copies.vertices.attributes[3 * i + 1] += 1;
  fs::remove_all(hierarchy());
  tests::write_sample(*files_, hierarchy(), *sample_);
  const Error error = error_of(static_cast<Level>(2));
  EXPECT_EQ(error.code(), ErrorCode::corrupt);
  EXPECT_THAT(error.what(), HasSubstr("tile 2/1: a copy at the place of ghost"));
}

}  // namespace
}  // namespace meshhier::exporting
