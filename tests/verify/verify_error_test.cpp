#include "verify/verify_error.h"

#include "base/error.h"
#include "config/config.h"
#include "export/random_cut.h"
#include "hierarchy/cut.h"
#include "pipeline/build.h"
#include "storage/format/layout.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tests::node;

/// Bounds and errors that hold: how far any vertex under a node is from where the node shows it.
void set_true_bounds(tests::Sample& sample) {
  for (TileRecord& record : sample.records) {
    const RankRange ranks = sample.tree.ranks(record.node);
    const TileMesh& mesh = sample.tile(record.node).mesh;
    double bound = 0;
    for (std::uint64_t rank = ranks.begin; rank < ranks.end; ++rank) {
      const std::uint32_t vertex = sample.local[raw(record.node.level)][rank];
      bound = std::max(bound, length(to_double(sample.ranked.positions[rank]) -
                                     to_double(mesh.vertices.positions[vertex])));
    }
    record.bound = std::nextafter(static_cast<float>(bound), 1e30F);
    record.error = record.bound / 2;
    if (sample.tree.is_partition(record.node))
      record.bound = record.error = 0;
  }
}

class VerifyErrorTest : public testing::Test {
 protected:
  fs::path path() const { return directory_.path() / "mesh.hier"; }

  tests::Sample make(const tests::TestMesh& mesh, const tests::SampleOptions& options = {}) {
    tests::Sample sample = tests::make_sample(mesh, options);
    set_true_bounds(sample);
    return sample;
  }

  std::vector<ErrorMeasurement> measure(tests::Sample& sample, ErrorOptions options = {}) {
    fs::remove_all(path());
    tests::write_sample(*files_, path(), sample);
    return measure_again(options);
  }

  std::vector<ErrorMeasurement> measure_again(ErrorOptions options = {}) {
    if (options.samples == ErrorOptions{}.samples)
      options.samples = 4000;
    execution::NoProgress progress;
    return measure_errors(*files_, path(), options, progress, execution::CancelToken());
  }

  ErrorMeasurement measure_level(tests::Sample& sample, int level) {
    return measure(sample, {.selection = static_cast<Level>(level)}).front();
  }

  fs::path cut_file(const std::string& text) {
    const fs::path file = directory_.path() / "cut.txt";
    std::ofstream(file) << text;
    return file;
  }

  static Error error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return error;
    }
    ADD_FAILURE() << "nothing was thrown";
    return {ErrorCode::internal, ""};
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(VerifyErrorTest, ThePartitionsAreNoDistanceFromThemselves) {
  tests::Sample sample = make(tests::torus(2000, 0.03F));
  const ErrorMeasurement m = measure_level(sample, raw(sample.tree.depth()));
  EXPECT_LT(m.forward.max, 1e-14);
  EXPECT_LT(m.backward.max, 1e-14);
  EXPECT_EQ(m.bound, 0);
  EXPECT_FALSE(m.ratio);
  EXPECT_THAT(m.problems, IsEmpty());
  EXPECT_EQ(m.triangles, sample.ranked.triangles.size());
  EXPECT_EQ(m.tiles, sample.tree.partition_count());
}

/// A flat grid whose coarsest mesh is moved up, its ghosts' positions too.
TEST_F(VerifyErrorTest, AMovedPlaneIsAsFarAsItWasMoved) {
  tests::Sample sample = make(tests::open_grid(20, 20), {4, 100, false, false, {}});
  for (Vec3f& p : sample.tile(node(0, 0)).mesh.vertices.positions)
    p.z += 0.25F;
  sample.record(node(0, 0)).bounds = bounds_of(sample.tile(node(0, 0)).mesh.vertices.positions);
  sample.record(node(0, 0)).bound = 100;
  const ErrorMeasurement m = measure_level(sample, 0);
  EXPECT_DOUBLE_EQ(m.backward.mean, 0.25);
  EXPECT_DOUBLE_EQ(m.backward.rms, 0.25);
  EXPECT_DOUBLE_EQ(m.backward.max, 0.25);
  EXPECT_GE(m.forward.mean, 0.25);  // the grid's border was drawn in
  EXPECT_GE(m.forward.rms, m.forward.mean);
  EXPECT_GE(m.forward.max, m.forward.rms);
  ASSERT_TRUE(m.ratio);
  EXPECT_NEAR(m.ratio->median, 100 / std::max(m.forward.max, m.backward.max), 1e-9);
  EXPECT_EQ(m.ratio->p95, m.ratio->median);
}

/// A sphere against a smaller one of the same triangles: nearest points lie along the radius.
TEST_F(VerifyErrorTest, AShrunkSphereIsARadiusAway) {
  tests::Sample sample = make(tests::sphere(8000), {1, 5000, false, false, {}});
  ASSERT_EQ(sample.tiles.size(), 1U);
  tests::Sample coarse = make(tests::sphere(8000), {2, 5000, false, false, {}});
  auto& root = coarse.tile(node(0, 0)).mesh;  // as many vertices as the sphere: a copy
  for (Vec3f& p : root.vertices.positions)
    p = p * 0.9F;
  coarse.record(node(0, 0)).error = 0.1F;
  coarse.record(node(0, 0)).bounds = bounds_of(root.vertices.positions);
  coarse.record(node(0, 0)).bound = 0.1001F;
  const ErrorMeasurement m = measure_level(coarse, 0);
  EXPECT_NEAR(m.forward.mean, 0.1, 2e-4);
  EXPECT_NEAR(m.backward.mean, 0.1, 2e-4);
  EXPECT_NEAR(m.forward.rms, 0.1, 2e-4);
  EXPECT_LE(m.forward.max, 0.1 + 1e-6);
  EXPECT_THAT(m.problems, IsEmpty());
}

TEST_F(VerifyErrorTest, TrueBoundsHoldForEveryLevelAndForMixedCuts) {
  for (const auto& mesh : {tests::sphere(2000, 0.02F), tests::duplicates(1500),
                           tests::non_manifold(1500), tests::genus_n(2, 2000)}) {
    tests::Sample sample = make(mesh, {11, 40, false, false, {}});
    for (const ErrorMeasurement& m : measure(sample, {.selection = AllLevels{}})) {
      EXPECT_THAT(m.problems, IsEmpty()) << m.name;
      ASSERT_TRUE(m.ratio) << m.name;
      EXPECT_GE(m.ratio->median, 1) << m.name;
      EXPECT_GE(m.ratio->p95, m.ratio->median) << m.name;
    }
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
      std::string text;
      const Cut cut = exporting::random_cut(sample.tree, seed);
      for (NodeId shown : cut.nodes())
        text += to_text(shown) + '\n';
      const auto results = measure_again({.selection = cut_file(text)});
      EXPECT_THAT(results.front().problems, IsEmpty()) << text;
    }
  }
}

/// Shown beside a coarse neighbour, a partition's border triangles reach to where that has its
/// corners: the partition's own bound of zero does not hold for them.
TEST_F(VerifyErrorTest, BorderTrianglesAreHeldToTheLargestBoundTheyTouch) {
  tests::Sample sample = make(tests::sphere(2000), {4, 40, false, false, {}});
  const auto m = measure(sample, {.selection = cut_file("1/0\n2/2\n2/3\n")}).front();
  EXPECT_THAT(m.problems, IsEmpty());
  EXPECT_GT(m.forward.max, 1e-3);
  EXPECT_EQ(m.tiles, 3U);
  EXPECT_FALSE(m.level);
  EXPECT_THAT(m.name, HasSubstr("cut.txt"));

  sample.record(node(1, 0)).bound = 1e-4F;  // blamed for its own triangles and those it bends
  const auto wrong = measure(sample, {.selection = cut_file("1/0\n2/2\n2/3\n")}).front();
  EXPECT_THAT(wrong.problems,
              ElementsAre(AllOf(HasSubstr(storage::tile_path(path(), node(1, 0)).string()),
                                HasSubstr("its bound is 0.0001"))));
}

TEST_F(VerifyErrorTest, ABoundBelowTheMeasuredMaximumIsAProblemOfItsTile) {
  tests::Sample sample = make(tests::torus(2000), {8, 40, false, false, {}});
  const ErrorMeasurement before = measure_level(sample, 1);
  ASSERT_THAT(before.problems, IsEmpty());
  sample.record(node(1, 1)).bound = static_cast<float>(before.forward.max / 100);
  sample.record(node(1, 0)).bound = 50;
  const ErrorMeasurement m = measure_level(sample, 1);
  EXPECT_THAT(m.problems,
              ElementsAre(AllOf(HasSubstr(storage::tile_path(path(), node(1, 1)).string()),
                                HasSubstr("measured from"), HasSubstr("its bound is"))));
  EXPECT_EQ(m.bound, 50);
  EXPECT_EQ(m.forward.max, before.forward.max) << "bounds do not change what is measured";
}

TEST_F(VerifyErrorTest, ErrorsOfLessThanHalfTheMeanAreAProblem) {
  tests::Sample sample = make(tests::torus(2000), {8, 40, false, false, {}});
  const ErrorMeasurement before = measure_level(sample, 1);
  ASSERT_THAT(before.problems, IsEmpty());
  const double mean = std::max(before.forward.mean, before.backward.mean);
  const auto say = [&](double error) {
    for (const std::uint32_t i : {0U, 1U})
      sample.record(node(1, i)).error = static_cast<float>(error);
    return measure_level(sample, 1);
  };
  const ErrorMeasurement honest = say(0.51 * mean);
  EXPECT_THAT(honest.problems, IsEmpty());
  EXPECT_NEAR(honest.error, 0.51 * mean, 1e-6 * mean);
  for (const double error : {0.47 * mean, 7e-45}) {  // the mean of samples has an error, too
    EXPECT_THAT(say(error).problems, ElementsAre(AllOf(HasSubstr("level 1 is off by"),
                                                       HasSubstr("more than twice the"))));
  }
}

/// Bounds are far larger than means where one vertex goes far.
TEST_F(VerifyErrorTest, ErrorsAreHeldToTheMeanHoweverLargeTheBoundIs) {
  tests::Sample sample = make(tests::torus(2000), {8, 40, false, false, {}});
  const ErrorMeasurement before = measure_level(sample, 1);
  const double mean = std::max(before.forward.mean, before.backward.mean);
  const auto say = [&](double error) {
    for (const std::uint32_t i : {0U, 1U}) {
      sample.record(node(1, i)).error = static_cast<float>(error);
      sample.record(node(1, i)).bound = static_cast<float>(1000 * mean);
    }
    return measure_level(sample, 1);
  };
  EXPECT_THAT(say(0.51 * mean).problems, IsEmpty());
  for (const double error : {0.47 * mean, 7e-45})
    EXPECT_THAT(say(error).problems, ElementsAre(HasSubstr("level 1 is off by")));
}

/// Coarse vertices on both sides of the line between what rounding does and what it does not.
TEST_F(VerifyErrorTest, AMeanBeyondRoundingIsHeldToTheErrors) {
  tests::TestMesh mesh = tests::open_grid(20, 20);
  for (Vec3f& p : mesh.positions)
    p.z += 1024;
  const auto problems = [&](int roundings) {
    tests::Sample sample = make(mesh, {2, 1000, false, false, {}});
    auto& root = sample.tile(node(0, 0)).mesh.vertices.positions;  // a copy of the original
    for (Vec3f& p : root)
      p.z += static_cast<float>(roundings) * 0x1p-14F;  // 2^-24 of it
    sample.record(node(0, 0)).bounds = bounds_of(root);
    sample.record(node(0, 0)).bound = 1;
    sample.record(node(0, 0)).error = 7e-45F;
    return measure_level(sample, 0).problems;
  };
  EXPECT_THAT(problems(0), IsEmpty());
  EXPECT_THAT(problems(2), ElementsAre(HasSubstr("level 0 is off by")));
}

/// As a scan whose triangles share no vertex: every piece vanishes by itself.
TEST_F(VerifyErrorTest, ASoupSaysHowFarItIsOff) {
  const tests::TestMesh sphere = tests::sphere(4000);
  tests::TestMesh soup;
  for (const tests::MeshTriangle& t : sphere.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : t)
      soup.positions.push_back(sphere.positions[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const fs::path input = directory_.path() / "soup.ply";
  tests::write_ply(soup, input);
  for (const auto method : {config::SimplifyMethod::edge_collapse,
                            config::SimplifyMethod::half_edge, config::SimplifyMethod::cluster}) {
    config::Config config = tests::quick_config();
    config.input = input;
    config.output = path();
    config.partition.vertices = 500;
    config.simplify.vertices = 500;
    config.simplify.method = method;
    execution::NoProgress progress;
    const execution::CancelToken cancel;
    pipeline::build_hierarchy(config, {.force = true}, {*files_, progress, cancel});
    for (const ErrorMeasurement& m :
         measure_errors(*files_, path(), {AllLevels{}, 10'000}, progress, cancel)) {
      EXPECT_THAT(m.problems, IsEmpty()) << m.name;
      EXPECT_GT(m.error, std::max(m.forward.mean, m.backward.mean) / 2) << m.name;
    }
  }
}

TEST_F(VerifyErrorTest, RoundingOfFarCoordinatesIsNoProblem) {
  tests::TestMesh mesh = tests::sphere(500);
  for (Vec3f& p : mesh.positions)
    p.x += 1000;
  tests::Sample sample = make(mesh, {2, 1000, false, false, {}});
  auto& root = sample.tile(node(0, 0)).mesh.vertices.positions;  // a copy of the original
  for (Vec3f& p : root)
    p.x = std::nextafter(p.x, 2000.0F);
  sample.record(node(0, 0)).bounds = bounds_of(root);
  sample.record(node(0, 0)).bound = 0;
  const ErrorMeasurement m = measure_level(sample, 0);
  EXPECT_GT(m.forward.max, 1e-5);
  EXPECT_THAT(m.problems, IsEmpty());
  for (Vec3f& p : root)
    p.x += 0.01F;
  sample.record(node(0, 0)).bounds = bounds_of(root);
  sample.record(node(0, 0)).error = 0.01F;
  EXPECT_THAT(measure_level(sample, 0).problems, ElementsAre(HasSubstr("its bound is 0")));
}

TEST_F(VerifyErrorTest, SLOW_ResultsAreTheSameForAnyBudgetAndAnyThreads) {
  tests::Sample sample = make(tests::torus(2000, 0.02F), {13, 100, false, false, {}});
  constexpr std::uint64_t kSamples = 150'000;  // more than are looked up at a time
  const auto selection = static_cast<Level>(2);
  const auto text = [](const std::vector<ErrorMeasurement>& results) {
    return to_json(results.front()).dump();
  };
  const std::string expected = text(measure(sample, {selection, kSamples}));
  EXPECT_EQ(text(measure_again({selection, kSamples, 1})), expected);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(text(measure_again({selection, kSamples, 1 << 20})), expected);
}

TEST_F(VerifyErrorTest, MoreSamplesFindTheSameMeans) {
  tests::Sample sample = make(tests::genus_n(1, 3000), {7, 60, false, false, {}});
  const ErrorMeasurement few = measure(sample, {Level{}, 3000}).front();
  const ErrorMeasurement many = measure_again({Level{}, 150'000}).front();
  EXPECT_NEAR(few.forward.mean, many.forward.mean, 0.05 * many.forward.mean);
  EXPECT_NEAR(few.backward.mean, many.backward.mean, 0.05 * many.backward.mean);
  EXPECT_LE(few.forward.max, 1.02 * many.forward.max);
  EXPECT_EQ(few.samples, 3000U);
}

TEST_F(VerifyErrorTest, AllLevelsAreTheSimplifiedOnesFromTheRootOn) {
  tests::Sample sample = make(tests::sphere(2000), {7, 40, false, false, {}});
  const auto results = measure(sample, {.selection = AllLevels{}});
  ASSERT_EQ(results.size(), 3U);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].level, static_cast<Level>(i));
    EXPECT_EQ(results[i].tiles, std::size_t{1} << i) << "an early node's partition counts";
  }
  EXPECT_GT(results[0].forward.mean, results[2].forward.mean);
  tests::Sample one = make(tests::sphere(100), {1, 1000, false, false, {}});
  EXPECT_THAT(measure(one, {.selection = AllLevels{}}), IsEmpty());
}

TEST_F(VerifyErrorTest, PointsHaveNothingToMeasure) {
  tests::Sample sample = make(tests::points(200), {4, 20, false, false, {}});
  const ErrorMeasurement m = measure_level(sample, 0);
  EXPECT_THAT(m.problems, IsEmpty());
  EXPECT_EQ(m.triangles, 0U);
  EXPECT_EQ(m.forward.max, 0);
}

TEST_F(VerifyErrorTest, ALevelThatShowsNothingOfASurfaceIsAProblem) {
  tests::Sample sample = make(tests::sphere(300), {4, 2, false, false, {}});
  ASSERT_EQ(sample.record(node(0, 0)).interior_count, 0U);
  EXPECT_THAT(measure_level(sample, 0).problems,
              ElementsAre(HasSubstr("level 0 shows no triangle, the original has 392")));
}

TEST_F(VerifyErrorTest, TrianglesWithoutAreaAreCountedAndMeasuredTo) {
  tests::TestMesh mesh = tests::open_grid(6, 6);
  for (Vec3f& p : mesh.positions)
    p.y = 0;  // all on one line
  tests::Sample sample = make(mesh, {2, 20, false, false, {}});
  const ErrorMeasurement m = measure_level(sample, 0);
  EXPECT_GT(m.flat, 0U);
  EXPECT_EQ(m.flat, m.triangles);
  EXPECT_EQ(m.forward.max, 0) << "no area, no samples";
  EXPECT_THAT(m.problems, IsEmpty());
}

TEST_F(VerifyErrorTest, WrongSelectionsAreTold) {
  tests::Sample sample = make(tests::sphere(500), {4, 40, false, false, {}});
  measure(sample);
  const auto measured = [&](ErrorOptions options) {
    return [this, options] { measure_again(options); };
  };
  const Error level = error_of(measured({.selection = static_cast<Level>(9)}));
  EXPECT_EQ(level.code(), ErrorCode::usage);
  EXPECT_THAT(level.what(), HasSubstr("0 to 2"));
  const Error gap = error_of(measured({.selection = cut_file("1/0\n")}));
  EXPECT_EQ(gap.code(), ErrorCode::usage);
  EXPECT_THAT(gap.what(), HasSubstr("cut.txt"));
  EXPECT_EQ(error_of(measured({.selection = fs::path("absent.txt")})).code(), ErrorCode::io);
}

TEST_F(VerifyErrorTest, DamageEndsIt) {
  tests::Sample sample = make(tests::sphere(500), {4, 40, false, false, {}});
  measure(sample);
  const fs::path tile = storage::tile_path(path(), node(2, 1));
  fs::resize_file(tile, fs::file_size(tile) - 4);
  const Error error = error_of([&] { measure_again(); });
  EXPECT_EQ(error.code(), ErrorCode::corrupt);
  EXPECT_THAT(error.what(), HasSubstr(tile.filename().string()));
  fs::remove_all(path());
  EXPECT_EQ(error_of([&] { measure_again(); }).code(), ErrorCode::io);
}

TEST_F(VerifyErrorTest, StopsWhenAsked) {
  tests::Sample sample = make(tests::sphere(500));
  measure(sample);
  execution::CancelToken cancel;
  cancel.cancel();
  execution::NoProgress progress;
  const Error error = error_of([&] { measure_errors(*files_, path(), {}, progress, cancel); });
  EXPECT_EQ(error.code(), ErrorCode::interrupted);
}

TEST(ErrorReportTest, JsonHasTheKeysThatScriptsRead) {
  ErrorMeasurement m;
  m.level = static_cast<Level>(3);
  m.name = "level 3";
  m.tiles = 8;
  m.triangles = 1234;
  m.diagonal = 10;
  m.samples = 500;
  m.forward = {0.5, 0.75, 1};
  m.backward = {0.25, 0.375, 2};
  m.error = 0.875;
  m.bound = 4;
  m.ratio = BoundRatio{2, 3};
  m.problems = {"one"};
  const auto json = to_json(m);
  EXPECT_EQ(json["level"], 3);
  EXPECT_EQ(json["tiles"], 8);
  EXPECT_EQ(json["triangles"], 1234);
  EXPECT_EQ(json["diagonal"], 10);
  EXPECT_EQ(json["samples"], 500);
  EXPECT_EQ(json["forward"]["mean"], 0.5);
  EXPECT_EQ(json["forward"]["rms"], 0.75);
  EXPECT_EQ(json["backward"]["max"], 2);
  EXPECT_EQ(json["error"], 0.875);
  EXPECT_EQ(json["bound"], 4);
  EXPECT_EQ(json["ratio"]["median"], 2);
  EXPECT_EQ(json["ratio"]["p95"], 3);
  EXPECT_THAT(json["problems"], SizeIs(1));
  m.level.reset();
  m.ratio.reset();
  EXPECT_TRUE(to_json(m)["level"].is_null());
  EXPECT_TRUE(to_json(m)["ratio"].is_null());
}

TEST(ErrorReportTest, TextHasInputUnitsAndPartsOfTheDiagonal) {
  ErrorMeasurement m;
  m.name = "level 0";
  m.tiles = 1;
  m.triangles = 16384;
  m.diagonal = 20;
  m.forward = {0.004, 0.006, 0.5};
  m.bound = 0.75;
  m.problems = {"tile x is wrong"};
  const std::string text = to_text(m);
  EXPECT_THAT(text, AllOf(HasSubstr("level 0: 1 tile, 16384 triangles;"), HasSubstr("0.004"),
                          HasSubstr("2.0000"), HasSubstr("250.000"), HasSubstr("375.000"),
                          HasSubstr("PROBLEM: tile x is wrong")));
  EXPECT_THAT(text, testing::Not(HasSubstr("nan")));
  m.diagonal = 0;
  EXPECT_THAT(to_text(m), testing::Not(testing::ContainsRegex("nan|inf")));
}

class VerifyErrorModelTest : public VerifyErrorTest,
                             public testing::WithParamInterface<const char*> {};

TEST_P(VerifyErrorModelTest, SLOW_BoundsHoldForEveryTileOfAScan) {
  const fs::path model = fs::path(MESHHIER_MODELS_DIR) / GetParam();
  if (!fs::exists(model))
    GTEST_SKIP() << "no " << model << ": real scans are not there";
  config::Config config = tests::quick_config();
  config.input = model;
  config.output = path();
  config.partition.vertices = 1024;
  config.simplify.vertices = 1024;
  execution::NoProgress progress;
  const execution::CancelToken cancel;
  pipeline::build_hierarchy(config, {.force = true}, {*files_, progress, cancel});
  const auto results = measure_errors(*files_, path(), {AllLevels{}, 50'000}, progress, cancel);
  EXPECT_GE(results.size(), 3U);
  for (const ErrorMeasurement& m : results) {
    EXPECT_THAT(m.problems, IsEmpty()) << m.name;
    EXPECT_LE(m.forward.max, m.bound) << m.name;
    EXPECT_LE(m.backward.max, m.bound) << m.name;
    EXPECT_LT(m.forward.mean, 0.01 * m.diagonal) << m.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Scans, VerifyErrorModelTest,
                         testing::Values("dragon_vrip_res4.ply", "laurana_50k.ply", "feline.ply"));

}  // namespace
}  // namespace meshhier::verifying
