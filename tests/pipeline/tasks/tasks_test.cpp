// A build in tasks makes the bytes of one on one machine: whatever it is cut into, in whatever
// order tasks run, however often, and whatever happens to them.
#include "base/error.h"
#include "bench/generator.h"
#include "pipeline/build.h"
#include "pipeline/tasks/run_task.h"
#include "pipeline/tasks/task_plan.h"
#include "pipeline/tasks/task_status.h"
#include "storage/format/layout.h"
#include "storage/format/segment.h"
#include "storage/io/forwarding_files.h"
#include "storage/io/hash.h"
#include "storage/io/process.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/meshes.h"
#include "tests/support/named_boxes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/textured_torus.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::Call;
using tests::FaultyFileSystem;

constexpr const char* kProgram = "this program";

/// Hashes of files by their paths below the output.
using Snapshot = std::map<std::string, std::uint64_t>;

class TasksTest : public testing::Test {
 protected:
  TasksTest() {
    config_.output = directory_.path() / "mesh.hier";
    config_.partition.vertices = 90;
    config_.simplify.vertices = 70;
    config_.threads = 2;
  }

  fs::path work() const { return directory_.path() / "work"; }
  fs::path file(const std::string& name) const { return directory_.path() / name; }

  void use_sphere() {
    tests::write_ply(tests::sphere(6000, 0.01F), file("mesh.ply"));
    config_.input = file("mesh.ply");
  }
  /// A mesh whose rows in the file are so long that it has many blocks of vertices and of faces;
  /// `faces`: what its triangles become.
  void use_long_rows(const tests::TestMesh& mesh, std::size_t vertex_bytes, std::size_t face_bytes,
                     const std::vector<std::vector<std::uint32_t>>& faces = {}) {
    const std::size_t count = faces.empty() ? mesh.triangles.size() : faces.size();
    std::ofstream out(file("mesh.ply"), std::ios::binary);
    const auto pad = [&](std::size_t bytes) {
      for (std::size_t i = 0; i < bytes / 8; ++i)
        out << "property double pad" << i << '\n';
    };
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
        << "\nproperty float x\nproperty float y\nproperty float z\n";
    pad(vertex_bytes);
    out << "element face " << count << "\nproperty list uchar uint vertex_indices\n";
    pad(face_bytes);
    out << "end_header\n";
    const auto write = [&](const auto& value) {
      out.write(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const std::string filling(std::max(vertex_bytes, face_bytes), 'x');
    for (const Vec3f& p : mesh.positions) {
      write(p);
      out.write(filling.data(), static_cast<std::streamsize>(vertex_bytes));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::vector<std::uint32_t> corners =
          faces.empty()
              ? std::vector<std::uint32_t>(mesh.triangles[i].begin(), mesh.triangles[i].end())
              : faces[i];
      write(static_cast<std::uint8_t>(corners.size()));
      for (const std::uint32_t corner : corners)
        write(corner);
      out.write(filling.data(), static_cast<std::streamsize>(face_bytes));
    }
    config_.input = file("mesh.ply");
    config_.preview = false;
  }
  /// Ten blocks of vertices and ten of faces.
  void use_blocks() { use_long_rows(tests::sphere(6000, 0.01F), 1600, 800); }

  void use_attributes() {
    bench::SurfaceOptions options;
    options.triangles = 5000;
    options.noise = 0.5;
    options.normals = options.colours = true;
    bench::write_ply(files_, {file("mesh.ply")}, *bench::make_surface(options));
    config_.input = file("mesh.ply");
  }
  void use_texture() {
    config_.input = tests::write_obj(tests::make_textured_torus(6, 3), directory_.path());
    config_.partition.vertices = 300;
    config_.simplify.vertices = 300;
    config_.texture.texels = 128;
    config_.texture.format.format = ImageFormat::png;
  }
  void use_normal_maps() {
    use_attributes();
    config_.storage.normals = config::Normals::map_or_none;
    config_.normal_map.texels = 128;
  }
  void use_relief() {
    use_texture();
    config_.storage.normals = config::Normals::map;
  }
  void use_objects() {
    tests::write_named_boxes(file("boxes.obj"), 150);
    config_.input = file("boxes.obj");
    config_.objects.table = file("boxes.csv");
  }
  void use_archive() {
    use_sphere();
    config_.output = file("mesh.3tz");
    config_.storage.container = config::Container::archive;
  }

  Snapshot output() {
    Snapshot all;
    std::vector<fs::path> files{config_.output};
    if (fs::is_directory(config_.output))
      files = files_.list(config_.output);
    for (const fs::path& path : files) {
      all[fs::relative(path, config_.output).string()] =
          storage::checksum(storage::read_file(files_, path, 1U << 30));
    }
    return all;
  }

  /// Returns the files of a build in one piece, which is gone then.
  Snapshot expected() {
    execution::NoProgress progress;
    build_hierarchy(config_, {}, {files_, progress, cancel_});
    const Snapshot result = output();
    fs::remove_all(config_.output);
    return result;
  }

  TaskPlan plan(std::uint32_t tasks, bool replace = false) {
    execution::NoProgress progress;
    return make_task_plan(config_, {work(), tasks, replace, kProgram}, {files_, progress, cancel_});
  }

  TaskReport run(const std::string& stage, Share worker = {}) {
    execution::NoProgress progress;
    return run_tasks({work(), stage, worker, scratch_, 0, 0, kProgram},
                     {files_, progress, cancel_});
  }

  /// All stages, the tasks of each in an order that depends on `seed`.
  void run_all(const TaskPlan& plan, std::uint32_t seed) {
    std::mt19937 chance(seed);
    for (const TaskStage& stage : stages_of(plan)) {
      std::vector<std::uint32_t> order(stage.tasks);
      for (std::uint32_t i = 0; i < stage.tasks; ++i)
        order[i] = i;
      std::shuffle(order.begin(), order.end(), chance);
      for (const std::uint32_t task : order)
        run(stage.name, {task, stage.tasks});
    }
  }

  void run_until(const TaskPlan& plan, const std::string& end) {
    for (const TaskStage& stage : stages_of(plan)) {
      if (stage.name == end)
        return;
      run(stage.name);
    }
  }

  /// The code that running a stage fails with; none if it succeeds.
  std::optional<ErrorCode> failure(const std::string& stage) {
    try {
      run(stage);
      return std::nullopt;
    } catch (const Error& error) {
      message_ = error.what();
      return error.code();
    }
  }

  fs::path segment(const TaskPlan& plan, const std::string& stage, std::uint32_t index) const {
    return storage::segment_path(work(), {plan.fingerprint, stage, index});
  }

  void flip(const fs::path& path, std::int64_t from_end) {
    const auto there = files_.reopen(path);
    std::array<std::byte, 1> byte{};
    const std::uint64_t at = there->size() - static_cast<std::uint64_t>(from_end);
    there->read_exact(at, byte);
    byte[0] ^= std::byte{1};
    there->write_at(at, byte);
  }

  void expect_any_cut_makes_the_same(const std::vector<std::uint32_t>& cuts = {1, 2, 8}) {
    const Snapshot whole = expected();
    std::uint32_t seed = 0;
    for (const std::uint32_t tasks : cuts) {
      run_all(plan(tasks), ++seed);
      EXPECT_EQ(output(), whole) << tasks;
      fs::remove_all(config_.output);
      fs::remove_all(work());
    }
  }

  tests::TemporaryDirectory directory_{tests::TemporaryDirectory::Place::memory};
  FaultyFileSystem files_;
  execution::CancelToken cancel_;
  config::Config config_ = tests::smooth_config();
  fs::path scratch_;
  std::string message_;
};

TEST_F(TasksTest, AnyCutMakesTheSameBytes) {
  use_sphere();
  expect_any_cut_makes_the_same();
}

TEST_F(TasksTest, AnyCutMakesTheSameBytesWithAttributes) {
  use_attributes();
  config_.storage.compression = config::Compression::meshopt_zlib;
  config_.storage.position_bits = 14;
  expect_any_cut_makes_the_same();
}

TEST_F(TasksTest, SLOW_AnyCutMakesTheSameBytesWithTextures) {
  use_texture();
  expect_any_cut_makes_the_same();
}

TEST_F(TasksTest, SLOW_AnyCutMakesTheSameBytesWithNormalMaps) {
  use_normal_maps();
  expect_any_cut_makes_the_same();
}

TEST_F(TasksTest, SLOW_AnyCutMakesTheSameBytesWithRelief) {
  use_relief();
  expect_any_cut_makes_the_same();
}

TEST_F(TasksTest, AnyCutMakesTheSameBytesWithObjects) {
  use_objects();
  expect_any_cut_makes_the_same();
  config_.objects.in_tiles = false;
  expect_any_cut_makes_the_same({2});
}

TEST_F(TasksTest, AnyCutMakesTheSameArchive) {
  use_archive();
  expect_any_cut_makes_the_same();
}

TEST_F(TasksTest, OnePartitionIsEnough) {
  use_sphere();
  config_.partition.vertices = 8192;
  expect_any_cut_makes_the_same();
}

TEST_F(TasksTest, AnyCutOfTheInputMakesTheSameBytes) {
  use_blocks();
  expect_any_cut_makes_the_same({1, 2, 3, 7, 8, 20});
}

/// Each slice has vertices and triangles of each chunk.
TEST_F(TasksTest, SLOW_SlicesOfManyChunksMakeTheSameBytes) {
  use_long_rows(tests::shuffled(tests::torus(540'000), 1), 80, 32);
  config_.partition.vertices = 8192;
  config_.simplify.vertices = 2000;
  config_.attributes.which = mesh_io::AttributeChoice::Which::none;  // the rows are padded
  expect_any_cut_makes_the_same({1, 3, 7});
  config_.memory_budget = std::uint64_t{64} << 20;
  config_.threads = 1;
  expect_any_cut_makes_the_same({7});
}

/// Vertices of one place are in different slices, and so are their triangles.
TEST_F(TasksTest, SlicesOfAMeshWithCopiesMakeTheSameBytes) {
  use_long_rows(tests::duplicates(6000, 0.01F), 1600, 800);
  expect_any_cut_makes_the_same({1, 3, 7, 20});
  config_.topology = Topology::index;
  expect_any_cut_makes_the_same({3});
}

TEST_F(TasksTest, SLOW_SlicesOfManyChunksWithCopiesMakeTheSameBytes) {
  use_long_rows(tests::shuffled(tests::duplicates(400'000, 0.001F), 1), 80, 32);
  config_.partition.vertices = 8192;
  config_.simplify.vertices = 2000;
  expect_any_cut_makes_the_same({1, 7});
}

TEST_F(TasksTest, InputWithoutSlicesMakesTheSameBytes) {
  const tests::TestMesh mesh = tests::duplicates(1500, 0.01F);
  std::ofstream out(file("mesh.ply"));
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const Vec3f& p : mesh.positions)
    out << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const tests::MeshTriangle& t : mesh.triangles)
    out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  out.close();
  config_.input = file("mesh.ply");
  expect_any_cut_makes_the_same({3});
}

TEST_F(TasksTest, PointsMakeTheSameBytes) {
  use_long_rows(tests::points(3000), 1600, 0);
  expect_any_cut_makes_the_same({1, 3});
}

/// Behind a polygon no face has a known place: what slices make of the rest must not count.
TEST_F(TasksTest, PolygonsBetweenTrianglesMakeTheSameBytes) {
  const tests::TestMesh mesh = tests::duplicates(6000, 0.01F);
  std::vector<std::vector<std::uint32_t>> faces;
  for (const tests::MeshTriangle& t : mesh.triangles)
    faces.emplace_back(t.begin(), t.end());
  for (const std::size_t at : {std::size_t{0}, std::size_t{2500}, faces.size() - 1}) {
    auto polygons = faces;
    const std::uint32_t other = polygons[at][0] < 1000 ? 2000 : 0;
    polygons[at].push_back(other);
    use_long_rows(mesh, 1600, 800, polygons);
    expect_any_cut_makes_the_same({1, 3, 7});
  }
}

TEST_F(TasksTest, ABrokenFaceIsToldAsByABuild) {
  const tests::TestMesh mesh = tests::sphere(6000, 0.01F);
  std::vector<std::vector<std::uint32_t>> faces;
  for (const tests::MeshTriangle& t : mesh.triangles)
    faces.emplace_back(t.begin(), t.end());
  faces[4000][1] = 4'000'000;
  use_long_rows(mesh, 1600, 800, faces);
  std::string told;
  try {
    expected();
  } catch (const Error& error) {
    told = error.what();
  }
  EXPECT_THAT(told, HasSubstr("row 4000"));
  const TaskPlan planned = plan(3);
  run_until(planned, "join");
  EXPECT_EQ(failure("join"), ErrorCode::input);
  EXPECT_EQ(message_, told);
}

TEST_F(TasksTest, AnInputThatChangesBetweenSlicesIsRefused) {
  use_blocks();
  for (const char* stage : {"distribute", "faces", "join"}) {
    const TaskPlan planned = plan(3);
    run_until(planned, stage);
    fs::last_write_time(file("mesh.ply"),
                        fs::last_write_time(file("mesh.ply")) + std::chrono::seconds(1));
    EXPECT_EQ(failure(stage), ErrorCode::input);
    EXPECT_THAT(message_, HasSubstr("was changed since the stage read"));
    fs::remove_all(work());
  }
}

TEST_F(TasksTest, ScratchOfTheMachineHoldsWhatIsNotSealed) {
  use_sphere();
  const Snapshot whole = expected();
  scratch_ = file("local");
  const TaskPlan planned = plan(3);
  run_all(planned, 1);
  EXPECT_EQ(output(), whole);
  EXPECT_TRUE(fs::is_empty(scratch_));
}

TEST_F(TasksTest, WorkersShareTheTasksOfAStage) {
  use_sphere();
  plan(5);
  run("read", {1, 2});  // has only one task, which is the other worker's
  EXPECT_EQ(run("read", {0, 2}).done, 1);
  for (const char* stage : {"distribute", "faces", "join"})
    run(stage);
  EXPECT_EQ(run("leaves", {1, 2}).done, 2);
  EXPECT_EQ(run("leaves", {0, 2}).done, 3);
  const TaskReport again = run("leaves");
  EXPECT_EQ(again.done, 0);
  EXPECT_EQ(again.found, 5);
}

TEST_F(TasksTest, ATaskThatIsMissingIsNamed) {
  use_sphere();
  const TaskPlan planned = plan(3);
  EXPECT_EQ(failure("leaves"), ErrorCode::io);
  EXPECT_THAT(message_, HasSubstr("task 0 of stage read is not done"));
  run("read");
  run("distribute", {0, 3});
  EXPECT_EQ(failure("faces"), ErrorCode::io);
  EXPECT_THAT(message_, HasSubstr("task 1 of stage distribute is not done"));
  run_until(planned, "level-1");
  fs::remove(segment(planned, "leaves", 1));
  EXPECT_EQ(failure("level-1"), ErrorCode::io);
  EXPECT_THAT(message_, HasSubstr("task 1 of stage leaves is not done"));
  EXPECT_THAT(message_, HasSubstr("leaves --index 1"));
}

TEST_F(TasksTest, ATornSegmentIsMadeAgain) {
  use_sphere();
  const Snapshot whole = expected();
  const TaskPlan planned = plan(3);
  run_until(planned, "level-1");
  const fs::path torn = segment(planned, "leaves", 1);
  const std::uintmax_t size = fs::file_size(torn);
  for (const std::uintmax_t bytes : {std::uintmax_t{0}, std::uintmax_t{20}, size / 2, size - 1}) {
    fs::resize_file(torn, bytes);
    EXPECT_EQ(failure("level-1"), ErrorCode::corrupt) << bytes;
    EXPECT_THAT(message_, HasSubstr("run its task again"));
    EXPECT_EQ(run("leaves").done, 1) << bytes;
  }
  run_all(planned, 1);
  EXPECT_EQ(output(), whole);
}

/// Whatever byte of a segment is another: the task that reads it is refused, or did not need it.
TEST_F(TasksTest, NoFlippedByteReachesTheResult) {
  use_sphere();
  const Snapshot whole = expected();
  const TaskPlan planned = plan(2);
  run_until(planned, "level-1");
  const fs::path flipped = segment(planned, "leaves", 1);
  const auto size = static_cast<std::int64_t>(fs::file_size(flipped));
  int refused = 0;
  for (std::int64_t from_end = 1; from_end <= size; from_end += size / 40) {
    flip(flipped, from_end);
    const auto code = failure("level-1");
    EXPECT_TRUE(!code || code == ErrorCode::corrupt) << message_;
    refused += code ? 1 : 0;
    if (code) {
      EXPECT_THAT(message_, HasSubstr("leaves-00001"));
    }
    flip(flipped, from_end);
    if (!code) {
      run_all(planned, 1);
      EXPECT_EQ(output(), whole) << from_end;
      return;
    }
    for (std::uint32_t i = 0; i < 2; ++i)
      fs::remove(segment(planned, "level-1", i));
  }
  EXPECT_GT(refused, 35);
  run_all(planned, 1);
  EXPECT_EQ(output(), whole);
}

/// Likewise of what slices leave: some stage up to `leaves` refuses it.
TEST_F(TasksTest, NoFlippedByteOfASliceReachesTheLeaves) {
  use_long_rows(tests::duplicates(6000, 0.01F), 1600, 800);
  const TaskPlan planned = plan(2);
  for (const std::string stage : {"distribute", "faces"}) {
    run_until(planned, "leaves");
    const fs::path flipped = segment(planned, stage, 1);
    const auto size = static_cast<std::int64_t>(fs::file_size(flipped));
    for (std::int64_t from_end = 1; from_end <= size; from_end += size / 40) {
      flip(flipped, from_end);
      std::optional<ErrorCode> code;
      for (const std::string reader : {"faces", "join", "leaves"}) {
        if (reader == stage)
          continue;
        for (std::uint32_t i = 0; i < 2; ++i)
          fs::remove(segment(planned, reader, i));
        code = failure(reader);
        if (code)
          break;
      }
      EXPECT_EQ(code, ErrorCode::corrupt) << stage << ' ' << from_end;
      EXPECT_THAT(message_, HasSubstr(stage + "-00001")) << from_end;
      flip(flipped, from_end);
    }
  }
}

TEST_F(TasksTest, ATornSegmentOfASliceIsMadeAgain) {
  use_blocks();
  const Snapshot whole = expected();
  const TaskPlan planned = plan(3);
  const std::pair<const char*, const char*> stages[] = {
      {"distribute", "faces"}, {"faces", "join"}, {"join", "leaves"}};
  for (const auto& [stage, next] : stages) {
    run_until(planned, next);
    const std::uint32_t task = find_stage(planned, stage).tasks - 1;
    const fs::path torn = segment(planned, stage, task);
    const std::uintmax_t size = fs::file_size(torn);
    for (const std::uintmax_t bytes : {std::uintmax_t{0}, std::uintmax_t{20}, size / 2, size - 1}) {
      fs::resize_file(torn, bytes);
      EXPECT_EQ(failure(next), ErrorCode::corrupt) << stage << bytes;
      EXPECT_THAT(message_, HasSubstr("run its task again"));
      EXPECT_EQ(run(stage).done, 1) << stage << bytes;
    }
  }
  run_all(planned, 1);
  EXPECT_EQ(output(), whole);
}

TEST_F(TasksTest, PicturesThatAreDamagedAreNotShown) {
  use_texture();
  const TaskPlan planned = plan(1);
  run_until(planned, "texture-0");
  flip(segment(planned, "images", 0),
       static_cast<std::int64_t>(fs::file_size(segment(planned, "images", 0))));
  EXPECT_EQ(failure("texture-0"), ErrorCode::corrupt);
  EXPECT_THAT(message_, HasSubstr("images-00000"));
}

TEST_F(TasksTest, ATaskMayRunTwiceAtOnce) {
  use_sphere();
  const Snapshot whole = expected();
  const TaskPlan planned = plan(3);
  for (const TaskStage& stage : stages_of(planned)) {
    std::vector<std::thread> workers;
    for (int i = 0; i < 3; ++i) {
      workers.emplace_back([&] {
        try {
          run(stage.name);
        } catch (const Error& error) {  // one finishes while the other wants to
          EXPECT_EQ(stage.name, "finish") << error.what();
          EXPECT_EQ(error.code(), ErrorCode::locked) << error.what();
        }
      });
    }
    for (std::thread& worker : workers)
      worker.join();
  }
  run("finish");
  EXPECT_EQ(output(), whole);
}

TEST_F(TasksTest, WhatIsFinishedStaysSo) {
  use_sphere();
  const TaskPlan planned = plan(2);
  run_all(planned, 1);
  const Snapshot whole = output();
  EXPECT_EQ(run("leaves").found, 2);
  EXPECT_THAT(run("finish").text, HasSubstr("made "));
  EXPECT_EQ(output(), whole);
  EXPECT_EQ(plan(2).fingerprint, planned.fingerprint) << "the same command goes on";
  EXPECT_THAT(status_text(task_status(planned, work(), files_), planned, {}),
              HasSubstr("finished"));
  fs::remove_all(config_.output);
  EXPECT_EQ(failure("finish"), ErrorCode::corrupt);  // the earlier files are gone
  EXPECT_THAT(message_, HasSubstr("plan the build again"));
}

TEST_F(TasksTest, OnlyTheProgramThatPlannedGoesOn) {
  use_sphere();
  plan(2);
  execution::NoProgress progress;
  try {
    run_tasks({work(), "read", {}, {}, 0, 0, "another program"}, {files_, progress, cancel_});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::other_work);
    EXPECT_THAT(error.what(), HasSubstr("another program"));
  }
}

TEST_F(TasksTest, SegmentsOfAnotherPlanAreRefused) {
  use_sphere();
  const TaskPlan first = plan(2);
  run_until(first, "level-1");
  fs::rename(work(), file("first"));
  config_.partition.vertices = 100;
  const TaskPlan second = plan(2);
  ASSERT_NE(second.fingerprint, first.fingerprint);
  run_until(second, "leaves");
  for (const char* name : {"leaves-00000", "leaves-00001"})
    fs::copy_file(file("first") / "segments" / name, work() / "segments" / name);
  EXPECT_EQ(failure("level-1"), ErrorCode::corrupt);
  EXPECT_THAT(message_, HasSubstr("belongs to another plan"));
  EXPECT_EQ(run("leaves").done, 2) << "they are made again";
  EXPECT_EQ(failure("level-1"), std::nullopt) << message_;
}

TEST_F(TasksTest, APlanIsMadeOnce) {
  use_sphere();
  const TaskPlan first = plan(2);
  EXPECT_EQ(plan(2).fingerprint, first.fingerprint);
  EXPECT_THROW(plan(3), Error);
  EXPECT_EQ(read_task_plan(files_, work(), kProgram).config, first.config);
  EXPECT_EQ(read_task_plan(files_, work(), kProgram).fingerprint, first.fingerprint);
}

TEST_F(TasksTest, APlanThatAnotherMakesMeanwhileIsTheSame) {
  /// Says once that there is no plan.
  class Early final : public storage::ForwardingFiles {
   public:
    using ForwardingFiles::ForwardingFiles;
    bool exists(const fs::path& path) override {
      return ForwardingFiles::exists(path) &&
             (path.filename() != storage::task_plan_path({}) || std::exchange(has_asked_, true));
    }

   private:
    bool has_asked_ = false;
  };
  use_sphere();
  const TaskPlan first = plan(2);
  run("read");
  execution::NoProgress progress;
  const execution::CancelToken cancel;
  Early files(files_);
  EXPECT_EQ(
      make_task_plan(config_, {work(), 2, false, kProgram}, {files, progress, cancel}).fingerprint,
      first.fingerprint);
}

TEST_F(TasksTest, AnOutputIsReplacedOnlyIfThePlanSaysSo) {
  use_sphere();
  execution::NoProgress progress;
  config_.partition.vertices = 400;
  build_hierarchy(config_, {}, {files_, progress, cancel_});
  const Snapshot before = output();
  config_.partition.vertices = 90;
  EXPECT_THROW(plan(2), Error);
  const TaskPlan planned = plan(2, true);
  run_until(planned, "finish");
  EXPECT_EQ(output(), before);
  run("finish");
  const Snapshot after = output();
  EXPECT_NE(after, before);
  run("finish");
  EXPECT_EQ(output(), after);
}

TEST_F(TasksTest, WhatIsFinishedButNotNamedIsNotDone) {
  use_sphere();
  const TaskPlan planned = plan(2);
  run_until(planned, "finish");
  fs::create_directories(config_.output);
  EXPECT_EQ(failure("finish"), ErrorCode::exists);
  const TaskStatus status = task_status(planned, work(), files_);
  EXPECT_FALSE(status.is_finished);
  ASSERT_NE(next_stage(status), nullptr);
  EXPECT_EQ(next_stage(status)->name, "finish");
  EXPECT_EQ(run("leaves").found, 2);
  fs::remove_all(config_.output);
  run("finish");
  EXPECT_EQ(next_stage(task_status(planned, work(), files_)), nullptr);
}

TEST_F(TasksTest, ADamagedOutputOfTheSameMeshIsReplaced) {
  use_sphere();
  const Snapshot whole = expected();
  execution::NoProgress progress;
  build_hierarchy(config_, {}, {files_, progress, cancel_});
  fs::resize_file(config_.output / "outline.glb", 10);
  run_all(plan(2, true), 1);
  EXPECT_EQ(output(), whole);
  run("finish");
  EXPECT_EQ(output(), whole);
}

TEST_F(TasksTest, APictureThatChangesIsRefused) {
  use_texture();
  const TaskPlan planned = plan(1);
  run_until(planned, "images");
  for (const auto& entry : fs::directory_iterator(directory_.path())) {
    if (entry.path().extension() == ".png")
      fs::resize_file(entry.path(), fs::file_size(entry.path()) - 10);
  }
  EXPECT_EQ(failure("images"), ErrorCode::input);
  EXPECT_THAT(message_, HasSubstr("changed since the stage read"));
}

TEST_F(TasksTest, MemoryAndThreadsMayChange) {
  use_sphere();
  const TaskPlan first = plan(2);
  run_until(first, "level-1");
  config_.memory_budget = std::uint64_t{300} << 20;
  config_.threads = 1;
  EXPECT_EQ(plan(2).fingerprint, first.fingerprint);
  EXPECT_EQ(read_task_plan(files_, work(), kProgram).config.threads, 1);
  EXPECT_EQ(run("leaves").found, 2);
}

TEST_F(TasksTest, TilesThatChangeBeforeTheEndAreMadeAgain) {
  use_sphere();
  config_.preview = false;
  const Snapshot whole = expected();
  const TaskPlan planned = plan(3);
  run_until(planned, "finish");
  const fs::path tile = work() / "hierarchy" / "tiles" / "03" / "000002.glb";
  const auto size = static_cast<std::int64_t>(fs::file_size(tile));
  for (const std::int64_t from_end : {std::int64_t{1}, size / 2, std::int64_t{0}}) {
    if (from_end > 0)
      flip(tile, from_end);
    else
      fs::remove(tile);
    EXPECT_EQ(failure("finish"), ErrorCode::corrupt);
    EXPECT_THAT(message_, HasSubstr("tiles/03/000002.glb is missing or damaged"));
    EXPECT_THAT(message_, HasSubstr("publish --index "));
    const auto at = message_.find("--index ") + 8;
    fs::remove(segment(planned, "publish", static_cast<std::uint32_t>(message_[at] - '0')));
    EXPECT_EQ(run("publish").done, 1);
  }
  tests::write_ply(tests::sphere(100), work() / "hierarchy" / "tiles" / "00" / "other");
  EXPECT_EQ(failure("finish"), ErrorCode::io);
  EXPECT_THAT(message_, HasSubstr("no file of a hierarchy"));
  fs::remove(work() / "hierarchy" / "tiles" / "00" / "other");
  run("finish");
  EXPECT_EQ(output(), whole);
}

TEST_F(TasksTest, AnOutputThatAppearsStays) {
  use_sphere();
  const TaskPlan planned = plan(2);
  run_until(planned, "finish");
  fs::create_directories(config_.output);
  EXPECT_EQ(failure("finish"), ErrorCode::exists);
  EXPECT_THAT(message_, HasSubstr("move it away"));
  fs::remove_all(config_.output);
  EXPECT_EQ(failure("finish"), std::nullopt) << message_;
}

/// Any call of any task fails, once; then all tasks run again.
TEST_F(TasksTest, SLOW_AnyCallMayFail) {
  tests::write_ply(tests::sphere(500, 0.01F), file("mesh.ply"));
  config_.input = file("mesh.ply");
  config_.preview = false;
  config_.threads = 1;
  const Snapshot whole = expected();
  for (std::uint64_t n = 1;; n += n < 60 ? 1 : 29) {
    const TaskPlan planned = plan(2);
    files_.fail(Call::any, n);
    const std::uint64_t before = files_.calls(Call::any);
    for (const TaskStage& stage : stages_of(planned)) {
      const auto code = failure(stage.name);
      if (code) {
        EXPECT_EQ(code, ErrorCode::io) << message_;
        EXPECT_EQ(failure(stage.name), std::nullopt) << n << ' ' << stage.name << ' ' << message_;
      }
    }
    files_.fail(Call::any, 1, 0);
    EXPECT_EQ(output(), whole) << n;
    fs::remove_all(config_.output);
    fs::remove_all(work());
    if (files_.calls(Call::any) - before < n) {
      EXPECT_GT(n, 500);  // so many calls there are
      break;
    }
    ASSERT_FALSE(HasFailure()) << n;
  }
}

/// As a power cut, or kill -9: nothing after it happens, not even what tidies up.
TEST_F(TasksTest, SLOW_ATaskMayBeKilledAtAnyMoment) {
  tests::write_ply(tests::sphere(500, 0.01F), file("mesh.ply"));
  config_.input = file("mesh.ply");
  config_.preview = false;
  config_.threads = 1;
  const Snapshot whole = expected();
  for (std::uint64_t n = 5;; n += 37) {
    const TaskPlan planned = plan(2);
    files_.fail(Call::any, n, std::numeric_limits<std::uint32_t>::max());
    const std::uint64_t before = files_.calls(Call::any);
    for (const TaskStage& stage : stages_of(planned)) {
      if (failure(stage.name)) {
        files_.fail(Call::any, 1, 0);
        EXPECT_EQ(failure(stage.name), std::nullopt) << n << ' ' << stage.name << ' ' << message_;
      }
    }
    files_.fail(Call::any, 1, 0);
    EXPECT_EQ(output(), whole) << n;
    fs::remove_all(config_.output);
    fs::remove_all(work());
    if (files_.calls(Call::any) - before < n)
      break;
    ASSERT_FALSE(HasFailure()) << n;
  }
}

TEST_F(TasksTest, StatusComesFromTheSegmentsAlone) {
  use_sphere();
  const TaskPlan planned = plan(3);
  TaskStatus status = task_status(planned, work(), files_);
  EXPECT_EQ(status.stages.front().done, 0);
  EXPECT_FALSE(cpu_seconds_left(status, planned, files_));
  EXPECT_EQ(status_json(status, planned, {}).at("next"), "read");
  run_until(planned, "leaves");
  run("leaves", {1, 3});
  // Under another name.
  fs::copy_file(segment(planned, "leaves", 1), segment(planned, "leaves", 2));
  status = task_status(planned, work(), files_);
  EXPECT_EQ(status.stages[0].done, 1);
  EXPECT_EQ(status.stages[4].done, 1);
  EXPECT_THAT(status.stages[4].damaged, testing::ElementsAre(2));
  EXPECT_EQ(status.stages[4].bytes, fs::file_size(segment(planned, "leaves", 1)));
  EXPECT_GT(status.stages[4].peak_resident_bytes, 0);
  EXPECT_GT(cpu_seconds_left(status, planned, files_).value_or(0), 0);
  EXPECT_EQ(status_json(status, planned, {}).at("next"), "leaves");
  EXPECT_THAT(status_text(status, planned, {}), HasSubstr("segment of task 2 is damaged"));
}

TEST_F(TasksTest, TheDirectoryHasNothingElse) {
  use_sphere();
  for (const char* name : {"segments/a", "attempts/a", "other"}) {
    fs::create_directories(work() / name);
    EXPECT_THROW(plan(2), Error) << name;
    EXPECT_TRUE(fs::exists(work() / name));
    fs::remove_all(work());
  }
  fs::create_directories(work() / "segments");  // as a plan that was killed leaves it
  fs::create_directories(work() / "attempts" / storage::unique_name());
  plan(2);
  fs::remove_all(work());
  for (const char* output : {"work", "work/mesh.hier", "work/hierarchy"}) {
    config_.output = file(output);
    EXPECT_THROW(plan(2), Error) << output;
    EXPECT_FALSE(fs::exists(work()));
  }
  config_.output = directory_.path();
  EXPECT_THROW(plan(2), Error);
}

dev_t device_of(const fs::path& path) {
  struct stat facts {};
  EXPECT_EQ(::stat(path.c_str(), &facts), 0) << path;
  return facts.st_dev;
}

TEST_F(TasksTest, AnotherFileSystemIsRefused) {
  use_sphere();
  const fs::path here = fs::path(MESHHIER_BINARY).parent_path();
  const fs::path elsewhere = here / ("tasks_test_elsewhere" + std::to_string(::getpid()));
  execution::NoProgress progress;
  if (device_of(directory_.path()) == device_of(here) || ::access(here.c_str(), W_OK) != 0)
    GTEST_SKIP() << "only one file system to write to";
  try {
    make_task_plan(config_, {elsewhere, 2, false, kProgram}, {files_, progress, cancel_});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_THAT(error.what(), HasSubstr("must be on the file system of the output"));
  }
  EXPECT_FALSE(fs::exists(elsewhere));
}

}  // namespace
}  // namespace meshhier::pipeline
