// Queries of whole hierarchies, against trying all triangles.
#include "query/query.h"

#include "base/closest_point.h"
#include "base/error.h"
#include "base/ray.h"
#include "compare/cut_surface.h"
#include "compare/triangle_search.h"
#include "execution/progress.h"
#include "export/piece.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::querying {
namespace {

using testing::HasSubstr;

constexpr Vec3d kOrigin{1000, -50, 3};

Vec3d noise_vector(std::uint64_t index, std::uint64_t stream) {
  return {tests::hash_noise(index, 3 * stream), tests::hash_noise(index, 3 * stream + 1),
          tests::hash_noise(index, 3 * stream + 2)};
}

Ray ray_of(const std::vector<double>& row) {
  const Vec3d given{row[3], row[4], row[5]};
  const double most = std::max({std::abs(given.x), std::abs(given.y), std::abs(given.z)});
  const Vec3d way{given.x / most, given.y / most, given.z / most};
  return {Vec3d{row[0], row[1], row[2]} - kOrigin, way * (1 / length(way))};
}

class QueryTest : public testing::Test {
 protected:
  QueryTest() {
    sample_ = std::make_unique<tests::Sample>(
        tests::make_sample(tests::torus(2400, 0.02F), {11, 40, false, false, kOrigin}));
    tests::write_sample(*files_, hierarchy(), *sample_);
  }
  std::filesystem::path hierarchy() const { return directory_.path() / "mesh.hier"; }
  std::filesystem::path file(const char* name) const { return directory_.path() / name; }

  void write(const char* name, const std::vector<std::vector<double>>& rows) const {
    std::ofstream text(file(name));
    text.precision(17);
    for (const auto& row : rows) {
      for (const double number : row)
        text << number << ' ';
      text << '\n';
    }
  }
  QuerySummary run(QueryOptions options) {
    options.replace = true;
    if (options.output.empty())
      options.output = file("answers.csv");
    execution::NoProgress progress;
    return run_query(*files_, hierarchy(), *files_, options, progress, execution::CancelToken());
  }
  static std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  /// The rows of a CSV behind its first line.
  std::vector<std::vector<double>> answers(const char* name = "answers.csv") const {
    std::ifstream text(file(name));
    std::string line;
    std::getline(text, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(text, line)) {
      std::istringstream fields(line);
      rows.emplace_back();
      for (std::string field; std::getline(fields, field, ',');)
        rows.back().push_back(std::stod(field));
    }
    return rows;
  }

  std::vector<std::vector<double>> points() const {
    std::vector<std::vector<double>> rows;
    for (std::uint64_t i = 0; i < 3000; ++i) {
      const Vec3d p = noise_vector(i, 1) * (i % 5 == 0 ? 9 : 1.2) + kOrigin;
      rows.push_back({p.x, p.y, p.z});
    }
    return rows;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::unique_ptr<tests::Sample> sample_;
};

TEST_F(QueryTest, NearestPlacesAreThoseOfTryingAllTrianglesOfEachLevel) {
  const auto rows = points();
  write("points", rows);
  const storage::HierarchyReader reader(*files_, hierarchy());
  for (const int level : {0, 2, 4}) {
    const comparing::CutSurface surface(reader,
                                        Cut::of_level(reader.tree(), static_cast<Level>(level)), 0);
    const QuerySummary summary =
        run({.rows = file("points"), .selection = static_cast<Level>(level)});
    EXPECT_EQ(summary.rows, rows.size());
    EXPECT_EQ(summary.error_bound > 0, level < 4);
    const auto found = answers();
    ASSERT_EQ(found.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); i += 7) {
      const Vec3d point = Vec3d{rows[i][0], rows[i][1], rows[i][2]} - kOrigin;
      double least = std::numeric_limits<double>::infinity();
      std::vector<double> expected;
      for (std::size_t tile = 0; tile < surface.size(); ++tile) {
        const auto shown = surface.load(tile);
        for (std::uint32_t t = 0; t < shown.triangles.size(); ++t) {
          const double squared = comparing::squared_distance(point, shown.triangles[t]);
          if (squared < least) {
            const NodeId node = surface.cut()[tile];
            least = squared;
            expected = {double(raw(node.level)), double(node.index),
                        double(shown.facts.number_in_tile(t))};
          }
        }
      }
      ASSERT_EQ(found[i][0], std::sqrt(least));
      ASSERT_EQ(std::vector(found[i].begin() + 4, found[i].end()), expected);
      const Vec3d place{found[i][1], found[i][2], found[i][3]};
      ASSERT_NEAR(length(place - kOrigin - point), found[i][0], 1e-12);
    }
  }
}

TEST_F(QueryTest, AnswersDependOnTheRowAlone) {
  auto rows = points();
  write("points", rows);
  std::vector<std::vector<double>> rays;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vec3d way = noise_vector(i, 9);
    rays.push_back({rows[i][0], rows[i][1], rows[i][2], way.x, way.y, way.z});
  }
  write("rays", rays);
  run({.rows = file("points"), .has_sides = true});
  const auto near = answers();
  run({.kind = RowKind::rays, .rows = file("rays")});
  const auto hits = answers();
  std::ranges::reverse(rows);
  std::ranges::reverse(rays);
  write("points", rows);
  write("rays", rays);
  for (const std::uint64_t budget : {std::uint64_t{1}, std::uint64_t{90} << 20}) {
    for (const std::size_t threads : {1, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      run({.rows = file("points"), .has_sides = true, .memory_budget = budget});
      auto again = answers();
      std::ranges::reverse(again);
      EXPECT_EQ(again, near);
      run({.kind = RowKind::rays, .rows = file("rays"), .memory_budget = budget});
      again = answers();
      std::ranges::reverse(again);
      EXPECT_THAT(again, testing::SizeIs(hits.size()));
      for (std::size_t i = 0; i < hits.size(); ++i) {
        EXPECT_EQ(again[i][7], hits[i][7]);
        EXPECT_EQ(again[i][0], hits[i][0]);
      }
    }
  }
}

TEST_F(QueryTest, RaysHitWhatTryingAllTrianglesHits) {
  std::vector<std::vector<double>> rows;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vec3d from = noise_vector(i, 3) * 3 + kOrigin;
    const Vec3d way = (noise_vector(i, 4) * 0.5 + kOrigin - from) * (i % 2 == 0 ? 1e-3 : 50);
    rows.push_back({from.x, from.y, from.z, way.x, way.y, way.z});
  }
  write("rays", rows);
  const QuerySummary summary = run({.kind = RowKind::rays, .rows = file("rays")});
  const auto found = answers();
  const storage::HierarchyReader reader(*files_, hierarchy());
  const comparing::CutSurface surface(reader, Cut::of_level(reader.tree(), reader.tree().depth()),
                                      0);
  std::uint64_t hits = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Ray ray = ray_of(rows[i]);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t tile = 0; tile < surface.size(); ++tile) {
      for (const SurfaceTriangle& t : surface.load(tile).triangles)
        least = std::min(least, ray.hit(t[0], t[1], t[2]).value_or(least));
    }
    ASSERT_EQ(found[i][0], least);
    hits += std::isfinite(least) ? 1 : 0;
    if (std::isfinite(least)) {
      EXPECT_NEAR(length(Vec3d{found[i][4], found[i][5], found[i][6]}), 1, 1e-12);
    } else {
      EXPECT_EQ(found[i][9], -1);
    }
  }
  EXPECT_EQ(summary.hits, hits);
  EXPECT_GT(hits, 500U);
}

TEST_F(QueryTest, SidesAreThoseOfTheSurface) {
  // The axis of the tube is inside, the middle of the hole outside.
  write("points", {{kOrigin.x + 0.7, kOrigin.y, kOrigin.z},
                   {kOrigin.x, kOrigin.y, kOrigin.z},
                   {kOrigin.x + 5, kOrigin.y, kOrigin.z}});
  const QuerySummary summary = run({.rows = file("points"), .has_sides = true});
  const auto found = answers();
  EXPECT_LT(found[0][0], -0.2);
  EXPECT_GT(found[1][0], 0.2);
  EXPECT_EQ(found[0][7], -1);
  EXPECT_EQ(found[2][7], 1);
  EXPECT_EQ(summary.unknown_sides, 0U);
}

TEST_F(QueryTest, RowsThatAskNothingAreAnsweredByNan) {
  std::ofstream(file("points")) << "nan 0 0\n1000 -50 3\n0 inf 0\n";
  const QuerySummary summary = run({.rows = file("points")});
  EXPECT_EQ(summary.rows, 3U);
  EXPECT_EQ(summary.not_asked, 2U);
  EXPECT_THAT(text_of(file("answers.csv")),
              testing::MatchesRegex("distance,x,y,z,level,index,triangle\n"
                                    "nan,nan,nan,nan,-1,-1,-1\n0\\.[^\n]*\nnan,nan,[^\n]*\n"));
  std::ofstream(file("rays")) << "0 0 0 0 0 0\n0 0 0 1 0 0\n";
  run({.kind = RowKind::rays, .rows = file("rays")});
  EXPECT_THAT(text_of(file("answers.csv")), HasSubstr("\nnan,nan,nan,nan,nan,nan,nan,-1,-1,-1\n"
                                                      "inf,nan,nan,nan,nan,nan,nan,-1,-1,-1\n"));
  std::ofstream(file("points")) << "";
  run({.rows = file("points")});
  EXPECT_EQ(text_of(file("answers.csv")), "distance,x,y,z,level,index,triangle\n");
}

TEST_F(QueryTest, PlacesTooFarToSquareAreNotSaidToBeOnTheFirstTriangle) {
  std::ofstream(file("points")) << "1e308 0 0\n0 -1e200 0\n0 0 1e155\n";
  EXPECT_EQ(run({.rows = file("points")}).not_asked, 3U);
  for (const std::vector<double>& row : answers())
    EXPECT_EQ(row.back(), -1) << "triangle";
  std::ofstream(file("rays")) << "1e308 0 0 -1 0 0\n";
  EXPECT_EQ(run({.kind = RowKind::rays, .rows = file("rays")}).not_asked, 1U);
}

TEST_F(QueryTest, AnArrayHasTheNumbersOfTheCsv) {
  write("points", points());
  run({.rows = file("points")});
  run({.rows = file("points"), .output = file("answers.npy"), .format = AnswerFormat::npy});
  const std::string bytes = text_of(file("answers.npy"));
  constexpr std::size_t kRecord = 8 + 24 + 4 + 8 + 8;
  const auto expected = answers();
  ASSERT_EQ(bytes.size() % 64, expected.size() * kRecord % 64);
  const std::size_t head = bytes.size() - expected.size() * kRecord;
  EXPECT_THAT(bytes.substr(0, head), HasSubstr("'shape': (3000,)"));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    double distance = 0;
    std::int64_t triangle = 0;
    std::memcpy(&distance, bytes.data() + head + i * kRecord, 8);
    std::memcpy(&triangle, bytes.data() + head + (i + 1) * kRecord - 8, 8);
    ASSERT_EQ(distance, expected[i][0]);
    ASSERT_EQ(triangle, expected[i][6]);
  }
}

TEST_F(QueryTest, ByErrorTheBoundHolds) {
  write("points", points());
  run({.rows = file("points")});
  const auto exact = answers();
  const storage::HierarchyReader reader(*files_, hierarchy());
  const double error = reader.record(tests::node(1, 0)).error;
  const QuerySummary quick =
      run({.rows = file("points"), .selection = exporting::LargestError{error}});
  const auto found = answers();
  EXPECT_GT(quick.error_bound, 0);
  EXPECT_LT(quick.tiles, 11U);
  for (std::size_t i = 0; i < exact.size(); ++i)
    EXPECT_NEAR(found[i][0], exact[i][0], quick.error_bound * (1 + 1e-9));
}

TEST_F(QueryTest, OfAPieceAnswersAreThoseOfTryingTheTrianglesThatExportWrites) {
  const auto rows = points();
  write("points", rows);
  std::vector<std::vector<double>> rays;
  for (const auto& row : rows)
    rays.push_back({row[0], row[1], row[2], kOrigin.x + 0.6 - row[0], kOrigin.y + 0.1 - row[1], 1});
  write("rays", rays);
  const exporting::RegionRequest piece{
      .box = BoundsD{kOrigin + Vec3d{0.3, -0.4, -0.1}, kOrigin + Vec3d{0.9, 0.3, 9}}};
  const storage::HierarchyReader reader(*files_, hierarchy());
  const execution::CancelToken cancel;
  const double error = reader.record(tests::node(1, 0)).error;
  for (const comparing::SurfaceSelection& selection :
       {comparing::SurfaceSelection(), comparing::SurfaceSelection(static_cast<Level>(2)),
        comparing::SurfaceSelection(exporting::LargestError{error})}) {
    std::vector<SurfaceTriangle> triangles;
    exporting::Piece exported(reader, selected_cut(reader, selection),
                              region_of(*files_, reader, piece, cancel),
                              exporting::Clipping::whole_triangles, 0);
    for (std::size_t i = 0; i < exported.size(); ++i) {
      const exporting::CutPart part = exported.load(i);
      for (const auto& [a, b, c] : part.triangles)
        triangles.push_back(
            {part.vertices.positions[a], part.vertices.positions[b], part.vertices.positions[c]});
    }
    ASSERT_GT(triangles.size(), 20U);
    const comparing::CutSurface whole(reader, selected_cut(reader, selection), 0);
    ASSERT_LT(triangles.size(), whole.total().triangles);
    const auto triangle_of = [&](const std::vector<double>& answer, std::size_t column) {
      const NodeId node = tests::node(static_cast<int>(answer[column]),
                                      static_cast<std::uint32_t>(answer[column + 1]));
      const auto shown = whole.load(static_cast<std::size_t>(
          std::ranges::find(whole.cut().nodes(), node) - whole.cut().nodes().begin()));
      std::uint32_t t = 0;
      while (shown.facts.number_in_tile(t) != answer[column + 2])
        ++t;
      return shown.triangles.at(t);
    };
    const QuerySummary near = run({.rows = file("points"), .selection = selection, .piece = piece});
    EXPECT_LE(near.tiles, exported.size());
    EXPECT_EQ(near.tiles_read, near.tiles);
    const auto found = answers();
    for (std::size_t i = 0; i < rows.size(); i += 3) {
      const Vec3d point = Vec3d{rows[i][0], rows[i][1], rows[i][2]} - kOrigin;
      double least = std::numeric_limits<double>::infinity();
      for (const SurfaceTriangle& triangle : triangles)
        least = std::min(least, comparing::squared_distance(point, triangle));
      ASSERT_EQ(found[i][0], std::sqrt(least));
      ASSERT_EQ(comparing::squared_distance(point, triangle_of(found[i], 4)), least);
    }
    run({.kind = RowKind::rays, .rows = file("rays"), .selection = selection, .piece = piece});
    const auto hits = answers();
    std::size_t hit = 0;
    for (std::size_t i = 0; i < rays.size(); i += 3) {
      const Ray ray = ray_of(rays[i]);
      double least = std::numeric_limits<double>::infinity();
      for (const auto& [a, b, c] : triangles)
        least = std::min(least, ray.hit(a, b, c).value_or(least));
      ASSERT_EQ(hits[i][0], least);
      hit += std::isfinite(least) ? 1 : 0;
    }
    EXPECT_GT(hit, 20U);
  }
}

TEST_F(QueryTest, RefusesWhatItCannotAnswer) {
  write("points", {{0, 0, 0}});
  const auto failure = [&](QueryOptions options) {
    try {
      run(std::move(options));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(failure({.rows = file("points"), .selection = static_cast<Level>(9)}),
              HasSubstr("level"));
  EXPECT_THAT(failure({.rows = file("nothing")}), HasSubstr("nothing"));
  const BoundsD away{{0, 0, 0}, {1, 1, 1}}, reversed{{1, 1, 1}, {0, 0, 0}};
  EXPECT_THAT(failure({.rows = file("points"), .piece = {.box = away}}),
              HasSubstr("no triangle lies in the box; the mesh reaches from"));
  EXPECT_THAT(failure({.rows = file("points"), .piece = {.box = reversed}}),
              HasSubstr("the box is none"));
  EXPECT_THAT(failure({.rows = file("points"), .piece = {.objects = {.names = {"a"}}}}),
              HasSubstr("objects"));
  EXPECT_THAT(failure({.rows = file("points"), .output = file("points")}), HasSubstr("replace"));
  EXPECT_THAT(failure({.rows = file("points"), .output = hierarchy() / "x.csv"}),
              HasSubstr("hier"));
  EXPECT_THAT(failure({.rows = file("points"), .output = file("a.ply")}), HasSubstr(".npy"));
}

}  // namespace
}  // namespace meshhier::querying
