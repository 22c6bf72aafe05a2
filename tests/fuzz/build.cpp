// The input of the target `build`, little endian:
//
//   u8  choices           as many bytes follow, of which a config is drawn (random_config.h)
//   u8  method            of simplifying, modulo what there are
//   u8  partitions        one less than there are, modulo the places of the vertices
//   u8  tile vertices     four less than a simplified tile has
//   u8  form              0 to 15: positions are bytes times 10^(form - 8); above: floats
//   u8  vertices          one less than there are
//   a position (3 bytes or 3 floats) a vertex, then three u8 a triangle, modulo the vertices
//
// Whatever the mesh and the config, the hierarchy is sound and within its bounds, or the build is
// refused with a reason and leaves nothing behind.
#include "pipeline/build.h"

#include "bench/stress.h"
#include "config/config.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "storage/format/archive_files.h"
#include "support/memory_files.h"
#include "support/random_config.h"
#include "support/simplify_methods.h"
#include "verify/verify.h"
#include "verify/verify_error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include <tbb/global_control.h>

namespace meshhier::tests::fuzz {
namespace {

bench::LoadedMesh take_mesh(Take& take) {
  constexpr std::uint8_t kFloats = 16;
  const auto form = take.number<std::uint8_t>();
  const double scale = std::pow(10.0, static_cast<double>(form) - 8);
  const auto coordinate = [&]() -> double {
    if (form >= kFloats)
      return double{take.number<float>()};
    const auto byte = static_cast<std::int8_t>(take.number<std::uint8_t>());
    return double{static_cast<float>(byte * scale)};
  };
  bench::LoadedMesh mesh;
  mesh.positions.resize(take.number<std::uint8_t>() + std::size_t{1});
  for (Vec3d& position : mesh.positions) {
    position.x = coordinate();
    position.y = coordinate();
    position.z = coordinate();
  }
  const auto last = static_cast<std::uint8_t>(mesh.positions.size() - 1);
  while (!take.rest().empty()) {
    bench::MeshTriangle& triangle = mesh.triangles.emplace_back();
    for (std::uint32_t& corner : triangle)
      corner = take.upto(last);
  }
  return mesh;
}

/// As the first bytes say: of none of them the defaults.
class Choices {
 public:
  explicit Choices(Take& take) : bytes_(take.bytes(take.number<std::uint8_t>())) {}

  config::Config draw(const bench::LoadedMesh& mesh) {
    DrawnFor what{.with_ktx2 = false};  // those take another process
    what.box = {};
    for (const Vec3d& p : mesh.positions) {
      if (is_finite(p))
        what.box.add(p);
    }
    return random_config(
        [&](std::uint64_t most) { return bytes_.number<std::uint16_t>() % (most + 1); }, what);
  }

 private:
  Take bytes_;
};

/// Where the vertices lie: -0 equals 0, and those that are not finite lie nowhere.
std::size_t count_places(const bench::LoadedMesh& mesh) {
  std::set<std::array<std::uint64_t, 3>> places;
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };
  for (const Vec3d& p : mesh.positions) {
    if (is_finite(p))
      places.insert({bits(p.x), bits(p.y), bits(p.z)});
  }
  return std::max<std::size_t>(places.size(), 1);
}

/// A mesh of which nothing can be measured has no errors.
void check_bounds(MemoryFiles& files, const config::Config& config) {
  execution::NoProgress progress;
  const verifying::ErrorOptions options{Level{}, 300, pipeline::memory_budget(config)};
  const storage::HierarchyFiles inside(files, config.output);
  for (const auto& level :
       verifying::measure_errors(inside.files(), config.output, options, progress, {})) {
    if (level.triangles > 0 && !level.problems.empty())
      throw Violation(level.name + ": " + level.problems.front());
  }
}

void check_sound(MemoryFiles& files, const config::Config& config) {
  execution::NoProgress progress;
  verifying::VerifyOptions options;
  options.input = config.input;
  options.cuts = 4;
  const storage::HierarchyFiles inside(files, config.output);
  const auto report =
      verifying::verify_hierarchy(inside.files(), config.output, options, progress, {});
  if (!report.problems.empty())
    throw Violation(report.problems.front());
}

}  // namespace

void build(Bytes input) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  Take take(input);
  Choices choices(take);
  const auto methods = all_simplify_methods();
  const auto method = take.upto(static_cast<std::uint8_t>(methods.size() - 1));
  const auto partitions = take.number<std::uint8_t>();
  const auto tile_vertices = take.number<std::uint8_t>();
  bench::LoadedMesh mesh = take_mesh(take);
  config::Config config = choices.draw(mesh);
  config.input = "/models/a.ply";
  config.output = "/models/a.hier";
  config.threads = 1;
  config.simplify = methods[method].second;
  config.simplify.vertices = 4U + tile_vertices;
  config.preview = mesh.triangles.size() % 16 == 0;  // drawing takes longer than all else
  config.partition.count = 1 + partitions % static_cast<std::uint32_t>(count_places(mesh));

  MemoryFiles files;
  bench::write_ply(files, {config.input.front(), true}, *bench::as_generated(std::move(mesh)));
  execution::NoProgress progress;
  // Nothing may lie in a piece of the mesh, and a config may have no place on the globe.
  const bool is_plain = !config.crop && config.placement == config::PlacementConfig();
  const auto run = [&] { pipeline::build_hierarchy(config, {}, {files, progress, {}}); };
  const std::string refused = is_plain ? refusal({ErrorCode::input}, "/models/a.ply: ", run)
                                       : refusal({ErrorCode::input, ErrorCode::usage}, "", run);
  if (!refused.empty()) {
    for (const auto& path : files.list("models"))
      require(path == config.input, "left behind after \"" + refused + "\": " + path.string());
    return;
  }
  check_sound(files, config);
  check_bounds(files, config);
}

}  // namespace meshhier::tests::fuzz
