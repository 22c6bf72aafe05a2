// Pieces of meshes: what "crop" leaves of them.
#include "base/error.h"
#include "import/imported.h"
#include "tests/support/memory_files.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::Imported;
using tests::ImportHow;

using Corners = std::array<Vec3d, 3>;

/// A grid of squares of side 1 in the plane z = 0, and a triangle over all of it at z = 5; text.
std::string grid_text(bool as_obj) {
  constexpr int kSide = 30;
  std::string vertices, faces;
  const int first = as_obj ? 1 : 0;
  const char* vertex = as_obj ? "v {} {} {}\n" : "{} {} {}\n";
  const char* face = as_obj ? "f {} {} {}\n" : "3 {} {} {}\n";
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x)
      vertices += fmt::format(fmt::runtime(vertex), x, y, 0);
  }
  for (const auto& [x, y] : {std::pair(-100, -100), {200, -100}, {-100, 200}})
    vertices += fmt::format(fmt::runtime(vertex), x, y, 5);
  const auto number = [=](int x, int y) { return first + y * (kSide + 1) + x; };
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      faces += fmt::format(fmt::runtime(face), number(x, y), number(x + 1, y), number(x, y + 1));
      faces +=
          fmt::format(fmt::runtime(face), number(x + 1, y), number(x + 1, y + 1), number(x, y + 1));
    }
  }
  const int last = first + (kSide + 1) * (kSide + 1);
  faces += fmt::format(fmt::runtime(face), last, last + 1, last + 2);
  if (as_obj)
    return vertices + faces;
  return fmt::format(
             "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float "
             "y\nproperty float z\nelement face {}\nproperty list uchar int "
             "vertex_indices\nend_header\n",
             (kSide + 1) * (kSide + 1) + 3, 2 * kSide * kSide + 1) +
         vertices + faces;
}

std::multiset<std::array<std::array<double, 3>, 3>> surface(const Imported& mesh) {
  std::multiset<std::array<std::array<double, 3>, 3>> all;
  for (const auto& t : mesh.triangles) {
    std::array<std::array<double, 3>, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = mesh.positions[t[k]];
      corners[k] = {p.x, p.y, p.z};
    }
    all.insert(corners);
  }
  return all;
}

class CropTest : public testing::Test {
 protected:
  CropTest() {
    files_.put("w/grid.ply", grid_text(false));
    files_.put("w/grid.obj", grid_text(true));
    // Binary: read in place.
    tests::TestMesh mesh = tests::sphere(3000);
    tests::TemporaryDirectory folder;
    tests::write_ply(mesh, folder.path() / "s.ply");
    const auto posix = storage::make_posix_file_system();
    const auto bytes = storage::read_file(*posix, folder.path() / "s.ply", 1 << 24);
    files_.put("w/sphere.ply",
               std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  Imported import(const std::string& name, const BoundsD& box,
                  const ImportMemory& memory = tests::kRoomy) {
    return tests::import_files(files_, fs::path("w") / name, {.memory = memory, .crop = box});
  }

  tests::MemoryFiles files_;
};

TEST_F(CropTest, TrianglesThatTouchTheBoxAreThere) {
  for (const char* name : {"grid.ply", "grid.obj"}) {
    const Imported mesh = import(name, {{3.4, 4.4, -1}, {5.6, 5.6, 1}});
    // There are three squares by two, and two triangles at each corner of the box.
    EXPECT_EQ(mesh.triangles.size(), 12U) << name;
    EXPECT_EQ(mesh.positions.size(), 12U) << name;
    EXPECT_EQ(mesh.count("cropped_triangles"), 1801U - 12U) << name;
    EXPECT_EQ(mesh.summary.faces, 1801U) << name;
  }
}

TEST_F(CropTest, ATriangleWhoseCornersAreFarAwayIsThere) {
  for (const char* name : {"grid.ply", "grid.obj"})
    EXPECT_EQ(import(name, {{3, 4, 4}, {4, 5, 6}}).triangles.size(), 1U) << name;
  EXPECT_THROW(import("grid.ply", {{190, 190, 4}, {195, 195, 6}}), Error)
      << "in the triangle's box, but beside it";
}

/// A triangle in the plane y = 0, and boxes that have one point, or a line, in common with it.
TEST_F(CropTest, WhatOnlyTouchesTheBoxIsThere) {
  files_.put("w/one.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
             "y\nproperty float z\nelement face 1\nproperty list uchar int "
             "vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n");
  const std::vector<BoundsD> touching{
      {{-9, -9, 0.5}, {9, 9, 0.5}},         // flat, through its middle
      {{-9, -9, 0.1}, {9, 9, 0.1}},         // the same at no round number
      {{0.25, -9, 0.25}, {0.25, 9, 0.25}},  // a line through it
      {{0.25, 0, 0.25}, {0.25, 0, 0.25}},   // a point of it
      {{-9, 0, -9}, {9, 0, 9}},             // in its plane
      {{-9, 0, -9}, {9, 5, 9}},             // on it with a side
      {{1, 0, 0}, {5, 5, 5}},               // corner on corner
      {{-5, -5, -5}, {0, 0, 0}},            // the same
      {{-5, -1, -5}, {5, 1, 0}},            // along an edge
      {{0.5, -1, 0.5}, {2, 1, 2}},          // with an edge, in the middle of the longest
      {{0.3, -1, 0.7}, {2, 1, 2}},          // the same
      {{0.1, -1, 0.9}, {2, 1, 2}},          // the same
  };
  for (std::size_t i = 0; i < touching.size(); ++i)
    EXPECT_EQ(import("one.ply", touching[i]).triangles.size(), 1U) << i;
  const std::vector<BoundsD> apart{{{-9, -9, 1.001}, {9, 9, 2}},
                                   {{0.501, -1, 0.5}, {2, 1, 2}},
                                   {{-9, 1e-9, -9}, {9, 5, 9}},
                                   {{0.3, -1, 0.7000001}, {2, 1, 2}}};
  for (std::size_t i = 0; i < apart.size(); ++i)
    EXPECT_THROW(import("one.ply", apart[i]), Error) << i;
}

TEST_F(CropTest, ReadInPlaceOrAfterwardsItIsTheSame) {
  const BoundsD box{{-0.3, -2, -0.2}, {0.8, 0.4, 2}};
  const Imported whole = tests::import_files(files_, fs::path("w/sphere.ply"), {.weld = true});
  const Imported in_place = import("sphere.ply", box);
  const Imported tight = import("sphere.ply", box, tests::kTight);
  EXPECT_EQ(surface(tight), surface(in_place));
  EXPECT_EQ(tight.positions, in_place.positions);
  EXPECT_GT(in_place.triangles.size(), 100U);
  EXPECT_LT(in_place.triangles.size(), whole.triangles.size());
  std::size_t touching = 0;
  for (const auto& t : whole.triangles) {
    Vec3d low = whole.positions[t[0]], high = low;
    for (const std::uint32_t v : t) {
      const Vec3d p = whole.positions[v];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    touching += low.x <= box.max.x && low.y <= box.max.y && low.z <= box.max.z &&
                        high.x >= box.min.x && high.y >= box.min.y && high.z >= box.min.z
                    ? 1
                    : 0;
  }
  EXPECT_LE(in_place.triangles.size(), touching);
  EXPECT_GT(in_place.triangles.size(), touching - 20) << "but for some at the box's edges";
  EXPECT_EQ(in_place.count("cropped_triangles") + in_place.triangles.size(),
            whole.triangles.size());
  // Vertices come in the order of the file, and each is used.
  std::set<std::uint32_t> used;
  for (const auto& t : in_place.triangles)
    used.insert(t.begin(), t.end());
  EXPECT_EQ(used.size(), in_place.positions.size());
}

TEST_F(CropTest, OfPointsThoseInTheBoxStay) {
  files_.put("w/points.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
             "y\nproperty float z\nend_header\n0 0 0\n1 1 1\n2 2 2\n");
  const Imported mesh = import("points.ply", {{0.5, 0.5, 0.5}, {2, 2, 2}});
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{1, 1, 1}, {2, 2, 2}}));
}

TEST_F(CropTest, NothingThereIsTold) {
  try {
    import("sphere.ply", {{5, 5, 5}, { 6, 6, 6 }});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(), HasSubstr("nothing of sphere.ply lies in the box of \"crop\""));
  }
}

TEST_F(CropTest, FilesOfAListAreCroppedTogether) {
  mesh_io::InputPaths both;
  both.assign({"w/grid.ply", "w/grid.obj"});
  const Imported mesh =
      tests::import_files(files_, both, {.crop = BoundsD{{3.4, 4.4, -1}, {5.6, 5.6, 1}}});
  EXPECT_EQ(mesh.triangles.size(), 24U);
  const Imported welded = tests::import_files(
      files_, both, {.weld = true, .crop = BoundsD{{3.4, 4.4, -1}, {5.6, 5.6, 1}}});
  EXPECT_EQ(welded.positions.size(), 12U);
}

}  // namespace
}  // namespace meshhier::importing
