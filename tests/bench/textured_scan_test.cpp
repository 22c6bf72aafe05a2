// Pictures of generated meshes show what lies in space where their triangles are.
#include "bench/textured_scan.h"

#include "bench/textured_files.h"
#include "images/image_codec.h"
#include "tests/bench/collected.h"
#include "tests/support/error_message.h"
#include "tests/support/memory_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::bench {
namespace {

using testing::HasSubstr;

TexturedOptions small_mesh() {
  return {.surface = {.shape = BaseShape::torus, .triangles = 20'000, .height = 0.3, .noise = 0.2},
          .atlas = {.images = 3, .side = 256, .charts = 60, .gutter = 2, .seed = 1}};
}

images::Image picture_of(const TexturedScan& mesh, std::uint32_t image) {
  const std::uint32_t side = mesh.atlas().options().side;
  images::Image picture(side, side, 3);
  std::uint32_t y = 0;
  mesh.visit_rows(image, [&](std::span<const std::uint8_t> row) {
    std::copy(row.begin(), row.end(), picture.at(0, y++));
  });
  EXPECT_EQ(y, side);
  return picture;
}

struct Corner {
  TexelPlace texel;
  Vec3d place;
};
using CornerTriangle = std::array<Corner, 3>;

/// Returns all triangles of a chart.
std::vector<CornerTriangle> triangles_in(const TexturedScan& mesh, const PlacedChart& chart) {
  std::vector<CornerTriangle> all;
  const auto corner = [&](PatchPoint at) {
    return Corner{chart.texel_of({double(at.column - chart.cells.column_begin),
                                  double(at.row - chart.cells.row_begin)}),
                  mesh.surface().vertex(at).moved};
  };
  for (std::uint32_t row = 0; row < chart.cells.rows(); ++row) {
    for (std::uint32_t column = 0; column < chart.cells.columns(); ++column) {
      for (const auto& [a, b, c] : triangles_of(grid_point(chart, column, row)))
        all.push_back({corner(a), corner(b), corner(c)});
    }
  }
  return all;
}

double turn(TexelPlace a, TexelPlace b, TexelPlace c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Where that place of the picture lies in space; nothing unless it is inside.
std::optional<Vec3d> place_of(const CornerTriangle& t, TexelPlace at) {
  const double whole = turn(t[0].texel, t[1].texel, t[2].texel);
  const double a = turn(at, t[1].texel, t[2].texel) / whole;
  const double b = turn(t[0].texel, at, t[2].texel) / whole;
  if (a <= 0 || b <= 0 || a + b >= 1)
    return std::nullopt;
  return t[0].place * a + t[1].place * b + t[2].place * (1 - a - b);
}

int largest_difference(const std::uint8_t* a, const std::uint8_t* b) {
  int most = 0;
  for (int c = 0; c < 3; ++c)
    most = std::max(most, std::abs(a[c] - b[c]));
  return most;
}

TEST(TexturedScanTest, TexelsShowThePaintWhereTheirTrianglesLie) {
  const TexturedScan mesh(small_mesh());
  std::vector<images::Image> pictures;
  for (std::uint32_t i = 0; i < 3; ++i)
    pictures.push_back(picture_of(mesh, i));
  std::size_t compared = 0;
  mesh.visit_charts([&](const PlacedChart& chart) {
    for (const CornerTriangle& triangle : triangles_in(mesh, chart)) {
      const auto [left, right] =
          std::minmax({triangle[0].texel.x, triangle[1].texel.x, triangle[2].texel.x});
      const auto [top, bottom] =
          std::minmax({triangle[0].texel.y, triangle[1].texel.y, triangle[2].texel.y});
      for (auto y = static_cast<std::uint32_t>(top); y < bottom; ++y) {
        for (auto x = static_cast<std::uint32_t>(left); x < right; ++x) {
          const auto place = place_of(triangle, {x + 0.5, y + 0.5});
          if (!place)
            continue;
          std::array<std::uint8_t, 3> colour{};
          mesh.paint().paint(std::span(&*place, 1), colour);
          ASSERT_LE(largest_difference(colour.data(), pictures[chart.image].at(x, y)), 1)
              << x << " " << y;
          ++compared;
        }
      }
    }
  });
  EXPECT_GT(compared, std::size_t{mesh.atlas().chart_count()} * mesh.atlas().chart_side() *
                          mesh.atlas().chart_side() * 9 / 10);
}

TEST(TexturedScanTest, GuttersContinueTheBorder) {
  TexturedOptions options = small_mesh();
  options.surface.height = 0;
  options.surface.noise = 0;
  options.atlas.side = 1024;  // colours of neighbouring texels are near
  const TexturedScan mesh(options);
  const images::Image picture = picture_of(mesh, 0);
  mesh.visit_charts([&](const PlacedChart& chart) {
    if (chart.image != 0)
      return;
    const std::uint32_t middle = chart.side / 2;
    for (std::uint32_t i = 1; i <= 2; ++i) {
      EXPECT_LE(largest_difference(picture.at(chart.x - i, chart.y + middle),
                                   picture.at(chart.x, chart.y + middle)),
                16);
      EXPECT_LE(largest_difference(picture.at(chart.x + middle, chart.y + chart.side - 1 + i),
                                   picture.at(chart.x + middle, chart.y + chart.side - 1)),
                16);
    }
  });
}

TEST(TexturedScanTest, PicturesHaveDetailOfAllSizes) {
  TexturedOptions options = small_mesh();
  options.surface.height = 0;
  options.surface.noise = 0;
  options.atlas = {.images = 1, .side = 1024, .charts = 1};
  const TexturedScan mesh(options);
  const PlacedChart chart = *mesh.atlas().chart(0, 1, 1);
  const images::Image picture = picture_of(mesh, 0);
  // Means of squares of 1, 2, 4, ... texels differ from their neighbours at each of the sizes.
  for (std::uint32_t size = 4; size <= chart.side / 4; size *= 2) {
    const auto mean = [&](std::uint32_t column) {
      double sum = 0;
      for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x)
          sum += picture.at(chart.x + column * size + x, chart.y + y)[1];
      }
      return sum / (size * size);
    };
    double most = 0;
    for (std::uint32_t column = 0; (column + 2) * size <= chart.side; ++column)
      most = std::max(most, std::abs(mean(column) - mean(column + 1)));
    EXPECT_GT(most, 1) << size;
  }
}

// ---- files ---------------------------------------------------------------------------------

TexturedFileSizes write(tests::MemoryFiles& files, const std::string& path,
                        const TexturedFileOptions& options, bool replace = false) {
  return write_textured(files, {path, replace, {}}, TexturedScan(small_mesh()), options);
}

TEST(TexturedFilesTest, AnObjIsTheSurfaceWithItsCharts) {
  tests::MemoryFiles files;
  write(files, "/models/a.obj", {});
  std::istringstream text(files.content("/models/a.obj"));
  Collected mesh;
  std::size_t texcoords = 0, materials = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3d p;
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(to_double(to_float(p)));
    } else if (kind == "vt") {
      double u = -1, v = -1;
      words >> u >> v;
      ASSERT_TRUE(u > 0 && u < 1 && v > 0 && v < 1) << line;
      ++texcoords;
    } else if (kind == "usemtl") {
      ++materials;
    } else if (kind == "f") {
      MeshTriangle triangle;
      for (std::uint32_t& corner : triangle) {
        std::size_t texcoord = 0;
        char slash = 0;
        words >> corner >> slash >> texcoord;
        --corner;
        ASSERT_TRUE(texcoord >= 1 && texcoord <= texcoords) << line;
      }
      mesh.triangles.push_back(triangle);
    }
  }
  Collected plain = collect(*make_surface(small_mesh().surface));
  EXPECT_EQ(mesh.positions, plain.positions);
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
  std::sort(plain.triangles.begin(), plain.triangles.end());
  EXPECT_EQ(mesh.triangles, plain.triangles);
  EXPECT_EQ(materials, 3U);
  EXPECT_GT(texcoords, mesh.positions.size());
  const std::string library = files.content("/models/a.mtl");
  EXPECT_THAT(library, HasSubstr("newmtl a_0002\n"));
  EXPECT_THAT(library, HasSubstr("map_Kd a_0002.jpg\n"));
}

TEST(TexturedFilesTest, APlyHasItsTexturesInItsFaces) {
  tests::MemoryFiles files;
  const TexturedFileSizes sizes =
      write(files, "/models/a.ply", {.mesh = MeshFileFormat::ply, .image = ImageFormat::png});
  const std::string file = files.content("/models/a.ply");
  const std::string end = "end_header\n";
  const std::size_t body = file.find(end) + end.size();
  const TexturedScan mesh(small_mesh());
  EXPECT_EQ(file.size(), sizes.mesh_bytes);
  EXPECT_EQ(file.size() - body,
            mesh.grid().vertex_count() * 12 + mesh.grid().triangle_count() * (1 + 12 + 1 + 24 + 4));
  EXPECT_THAT(file.substr(0, body), HasSubstr("comment TextureFile a_0001.png\n"));
}

TEST(TexturedFilesTest, PicturesAreBesideTheMesh) {
  tests::MemoryFiles files;
  const TexturedFileSizes sizes = write(files, "/models/a.obj", {.image = ImageFormat::png});
  const TexturedScan mesh(small_mesh());
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const auto& file = files.bytes("/models/a_000" + std::to_string(i) + ".png");
    bytes += file.size();
    EXPECT_EQ(images::decode_image(file, "picture", 1U << 20), picture_of(mesh, i));
  }
  EXPECT_EQ(sizes.image_bytes, bytes);
}

TEST(TexturedFilesTest, AreEqualForAnyNumberOfThreads) {
  const auto run = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    tests::MemoryFiles files;
    write(files, "/models/a.ply", {.mesh = MeshFileFormat::ply});
    return std::array{files.content("/models/a.ply"), files.content("/models/a_0000.jpg"),
                      files.content("/models/a_0002.jpg")};
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(TexturedFilesTest, NothingIsReplacedUnlessItIsToBe) {
  tests::MemoryFiles files;
  files.put("/models/a_0001.jpg", "mine");
  EXPECT_THROW(write(files, "/models/a.obj", {}), Error);
  EXPECT_EQ(files.content("/models/a_0001.jpg"), "mine");
  EXPECT_FALSE(files.exists("/models/a.obj"));
  write(files, "/models/a.obj", {}, true);
  EXPECT_NE(files.content("/models/a_0001.jpg"), "mine");
  EXPECT_THAT(tests::usage_error([&] { write(files, "/models/b.obj", {.quality = 0}); }),
              HasSubstr("quality must be from 1 to 100"));
}

}  // namespace
}  // namespace meshhier::bench
