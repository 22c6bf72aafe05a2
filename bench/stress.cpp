#include "bench/stress.h"

#include "base/angle.h"
#include "base/error.h"
#include "bench/block_writer.h"
#include "bench/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

struct StressOptions {
  std::uint64_t size = 1;
  std::uint64_t seed = 1;
};

std::uint32_t u32(std::uint64_t value) {
  return static_cast<std::uint32_t>(value);
}

/// Returns a point in [-1, 1]^3, the item-th of the sequence that `seed` names.
Vec3d random_point(std::uint64_t seed, std::uint64_t item) {
  const auto at = [&](std::uint64_t axis) { return signed_unit(random_at(seed, 3 * item + axis)); };
  return rounded_to_float(Vec3d{at(0), at(1), at(2)});
}

constexpr std::size_t kBlock = 65536;

LoadedMesh collect(const GeneratedMesh& generated) {
  LoadedMesh mesh;
  generated.visit_vertices(kBlock, [&](std::span<const Vec3d> block, std::span<const float>) {
    mesh.positions.insert(mesh.positions.end(), block.begin(), block.end());
  });
  generated.visit_triangles(kBlock, [&](std::span<const MeshTriangle> block) {
    mesh.triangles.insert(mesh.triangles.end(), block.begin(), block.end());
  });
  return mesh;
}

// The cases are made of this. A rough closed surface is the sound mesh that many of them spoil.

LoadedMesh surface(const StressOptions& options) {
  SurfaceOptions wanted;
  wanted.triangles = std::max<std::uint64_t>(options.size, 8);
  wanted.seed = options.seed;
  return collect(*make_surface(wanted));
}

/// The surface with every position moved.
template <class Move>
LoadedMesh moved_surface(const StressOptions& options, Move move) {
  LoadedMesh mesh = surface(options);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.positions[i] = rounded_to_float(move(mesh.positions[i], i));
  return mesh;
}

LoadedMesh scaled_surface(const StressOptions& options, double factor) {
  return moved_surface(options, [&](Vec3d p, std::size_t) { return p * factor; });
}

LoadedMesh points(const StressOptions& options) {
  LoadedMesh mesh;
  for (std::uint64_t i = 0; i < options.size; ++i)
    mesh.positions.push_back(random_point(options.seed, i));
  return mesh;
}

/// Returns the turn by i parts of `count`.
UnitTurn turn_of(std::uint64_t i, std::uint64_t count) {
  return turn_by(2 * std::numbers::pi * static_cast<double>(i % count) /
                 static_cast<double>(count));
}

/// Returns point i of `count` on a circle that is no circle.
Vec3d ring_point(std::uint64_t i, std::uint64_t count) {
  const UnitTurn turn = turn_of(i, count);
  return rounded_to_float(Vec3d{turn.cosine, turn.sine, 0.2 * turn_of(7 * i, count).sine});
}

/// A disc of one fan: every triangle has the vertex 0.
LoadedMesh hub(const StressOptions& options) {
  const std::uint64_t count = std::max<std::uint64_t>(options.size, 3);
  LoadedMesh mesh;
  mesh.positions.push_back({0, 0, 1});
  for (std::uint64_t i = 0; i < count; ++i) {
    mesh.positions.push_back(ring_point(i, count));
    mesh.triangles.push_back({0, u32(1 + i), u32(1 + (i + 1) % count)});
  }
  return mesh;
}

/// The same disc, but every triangle has a tip of its own at the one place.
LoadedMesh copies(const StressOptions& options) {
  LoadedMesh mesh = hub(options);
  const Vec3d tip = mesh.positions[0];
  for (std::size_t i = 1; i < mesh.triangles.size(); ++i) {
    mesh.triangles[i][0] = u32(mesh.positions.size());
    mesh.positions.push_back(tip);
  }
  return mesh;
}

/// Triangles that all share one edge, like the pages of a book.
LoadedMesh book(const StressOptions& options) {
  const std::uint64_t count = std::max<std::uint64_t>(options.size, 1);
  LoadedMesh mesh;
  mesh.positions = {{0, 0, -1}, {0, 0, 1}};
  for (std::uint64_t i = 0; i < count; ++i) {
    mesh.positions.push_back(ring_point(i, count));
    mesh.triangles.push_back({0, 1, u32(2 + i)});
  }
  return mesh;
}

LoadedMesh one_face(const StressOptions& options) {
  LoadedMesh mesh = points({std::max<std::uint64_t>(options.size, 3), options.seed});
  mesh.triangles.push_back({0, u32(mesh.positions.size() / 2), u32(mesh.positions.size() - 1)});
  return mesh;
}

LoadedMesh degenerate(const StressOptions& options) {
  LoadedMesh mesh = points({std::max<std::uint64_t>(options.size, 2), options.seed});
  const std::uint64_t count = mesh.positions.size();
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint32_t a = u32(i), b = u32((i + 1) % count);
    const std::array<MeshTriangle, 4> kinds = {{{a, a, b}, {a, b, a}, {b, a, a}, {a, a, a}}};
    mesh.triangles.push_back(kinds[i % kinds.size()]);
  }
  return mesh;
}

/// Makes tetrahedra, each alone.
LoadedMesh pieces(const StressOptions& options) {
  LoadedMesh mesh;
  for (std::uint64_t i = 0; i < std::max<std::uint64_t>(options.size / 4, 1); ++i) {
    const Vec3d at = random_point(options.seed, i);
    const std::uint32_t a = u32(mesh.positions.size());
    constexpr double kSide = 0x1p-7;
    for (const Vec3d& corner :
         {Vec3d{}, Vec3d{kSide, 0, 0}, Vec3d{0, kSide, 0}, Vec3d{0, 0, kSide}})
      mesh.positions.push_back(rounded_to_float(at + corner));
    mesh.triangles.insert(
        mesh.triangles.end(),
        {{a, a + 2, a + 1}, {a, a + 1, a + 3}, {a, a + 3, a + 2}, {a + 1, a + 2, a + 3}});
  }
  return mesh;
}

/// Triangles across the whole box, no vertex shared.
LoadedMesh soup(const StressOptions& options) {
  LoadedMesh mesh = points({3 * std::max<std::uint64_t>(options.size, 1), options.seed});
  for (std::uint64_t i = 0; i + 2 < mesh.positions.size(); i += 3)
    mesh.triangles.push_back({u32(i), u32(i + 1), u32(i + 2)});
  return mesh;
}

/// Makes twice as many triangles as vertices, each between any three: nothing is near its
/// neighbours.
LoadedMesh tangle(const StressOptions& options) {
  LoadedMesh mesh = points({std::max<std::uint64_t>(options.size / 2, 4), options.seed});
  const std::uint64_t count = mesh.positions.size();
  for (std::uint64_t i = 0; mesh.triangles.size() < 2 * count; ++i) {
    const auto corner = [&](std::uint64_t k) {
      return u32(random_at(options.seed + 1, 3 * i + k) % count);
    };
    const MeshTriangle t = {corner(0), corner(1), corner(2)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
      mesh.triangles.push_back(t);
  }
  return mesh;
}

LoadedMesh moebius(const StressOptions& options) {
  const auto width = std::max<std::uint64_t>(
      2, static_cast<std::uint64_t>(std::sqrt(static_cast<double>(options.size) / 16)));
  const std::uint64_t length = 8 * width;
  LoadedMesh mesh;
  for (std::uint64_t i = 0; i < length; ++i) {
    const UnitTurn around = turn_of(i, length), half = turn_of(i, 2 * length);
    for (std::uint64_t j = 0; j <= width; ++j) {
      const double off = static_cast<double>(j) / static_cast<double>(width) - 0.5;
      const double radius = 1 + off * half.cosine;
      mesh.positions.push_back(
          rounded_to_float(Vec3d{radius * around.cosine, radius * around.sine, off * half.sine}));
    }
  }
  const auto vertex = [&](std::uint64_t i, std::uint64_t j) {
    return i < length ? u32(i * (width + 1) + j) : u32(width - j);
  };
  for (std::uint64_t i = 0; i < length; ++i) {
    for (std::uint64_t j = 0; j < width; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

LoadedMesh repeated(const StressOptions& options) {
  constexpr std::uint64_t kTimes = 100;
  LoadedMesh mesh = surface({options.size / kTimes, options.seed});
  std::vector<MeshTriangle> all;
  for (const MeshTriangle& t : mesh.triangles)
    all.insert(all.end(), kTimes, t);
  mesh.triangles = std::move(all);
  return mesh;
}

LoadedMesh mirrored(const StressOptions& options) {
  LoadedMesh mesh = surface({options.size / 2, options.seed});
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.triangles[i];
    mesh.triangles.push_back({a, c, b});
  }
  return mesh;
}

LoadedMesh utm(const StressOptions& options) {
  LoadedMesh mesh = surface(options);
  mesh.double_coordinates = true;
  for (Vec3d& p : mesh.positions)
    p = p * 1000.0 + Vec3d{500123.4567, 5812345.6789, 100.125};
  return mesh;
}

/// Makes a surface with every vertex in a size of its own: 10^30, 1, 10^-30 or 10^-40.
LoadedMesh mixed(const StressOptions& options) {
  constexpr std::array kFactors = {1e30, 1.0, 1e-30, 1e-40};
  return moved_surface(options, [&](Vec3d p, std::size_t i) {
    return p * kFactors[random_at(options.seed, i) % kFactors.size()];
  });
}

LoadedMesh shuffled(const StressOptions& options) {
  return collect(*shuffle(surface(options), options.seed));
}

class Held final : public GeneratedMesh {
 public:
  explicit Held(LoadedMesh mesh) : mesh_(std::move(mesh)) {
    content_.vertex_count = mesh_.positions.size();
    content_.triangle_count = mesh_.triangles.size();
    content_.attributes = mesh_.attributes;
    content_.double_coordinates = mesh_.double_coordinates;
  }

  const mesh_io::PlyContent& content() const override { return content_; }

  void visit_vertices(std::size_t block_size, const VertexBlockVisitor& visit) const override {
    VertexCollector blocks(block_size, visit);
    const auto channels = static_cast<std::size_t>(mesh_.attributes.channels());
    const std::span<const float> all(mesh_.channels);
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v)
      blocks.add(mesh_.positions[v], all.subspan(v * channels, channels));
    blocks.flush();
  }

  void visit_triangles(std::size_t block_size, const TriangleBlockVisitor& visit) const override {
    TriangleCollector blocks(block_size, visit);
    for (const MeshTriangle& t : mesh_.triangles)
      blocks.add(t);
    blocks.flush();
  }

 private:
  LoadedMesh mesh_;
  mesh_io::PlyContent content_;
};

struct Maker {
  StressCase listed;
  LoadedMesh (*make)(const StressOptions&);
};

constexpr std::array kMakers = {
    Maker{{"one-point", "a surface whose vertices are all equal"},
          [](const StressOptions& o) {
            return moved_surface(o, [](Vec3d, std::size_t) { return Vec3d{1, 2, 3}; });
          }},
    Maker{{"line", "a surface pressed onto a line"},
          [](const StressOptions& o) {
            return moved_surface(o, [](Vec3d p, std::size_t) { return Vec3d{p.x, p.x, p.x}; });
          }},
    Maker{{"plane", "a surface pressed onto a plane"},
          [](const StressOptions& o) {
            return moved_surface(o, [](Vec3d p, std::size_t) { return Vec3d{p.x, p.y, 0}; });
          }},
    Maker{{"copies", "a disc of one fan, each triangle with its own copy of the tip"}, copies},
    Maker{{"hub", "a disc of one fan: one vertex has all triangles"}, hub},
    Maker{{"book", "all triangles at one edge"}, book},
    Maker{{"points", "no faces"}, points},
    Maker{{"one-face", "many vertices, one face"}, one_face},
    Maker{{"degenerate", "every face has two equal corners"}, degenerate},
    Maker{{"pieces", "tetrahedra, each alone"}, pieces},
    Maker{{"soup", "triangles across the box that share no vertex"}, soup},
    Maker{{"tangle", "triangles between any three vertices"}, tangle},
    Maker{{"moebius", "a strip with half a twist"}, moebius},
    Maker{{"repeated", "a surface of which each triangle is there 100 times"}, repeated},
    Maker{{"mirrored", "a surface of which each triangle is there with its mirror image"},
          mirrored},
    Maker{{"shuffled", "a surface in random order"}, shuffled},
    Maker{{"utm", "a surface of a kilometre at geographic coordinates, in double"}, utm},
    Maker{{"huge", "coordinates of 10^30"},
          [](const StressOptions& o) { return scaled_surface(o, 1e30); }},
    Maker{{"largest", "coordinates of 10^36"},
          [](const StressOptions& o) { return scaled_surface(o, 1e36); }},
    Maker{{"tiny", "coordinates of 10^-30"},
          [](const StressOptions& o) { return scaled_surface(o, 1e-30); }},
    Maker{{"denormal", "coordinates of 10^-40"},
          [](const StressOptions& o) { return scaled_surface(o, 1e-40); }},
    Maker{{"mixed", "each vertex of a size of its own, 10^30 to 10^-40"}, mixed}};

constexpr auto kCases = [] {
  std::array<StressCase, kMakers.size()> cases;
  for (std::size_t i = 0; i < cases.size(); ++i)
    cases[i] = kMakers[i].listed;
  return cases;
}();

}  // namespace

std::span<const StressCase> stress_cases() {
  return kCases;
}

LoadedMesh make_stress(std::string_view name, std::uint64_t size, std::uint64_t seed) {
  const auto found = std::find_if(kMakers.begin(), kMakers.end(),
                                  [&](const Maker& maker) { return maker.listed.name == name; });
  if (found == kMakers.end())
    throw Error(ErrorCode::usage, fmt::format("there is no case '{}'", name));
  if (size >= std::uint64_t{1} << 30)
    throw Error(ErrorCode::usage, fmt::format("size must be below 2^30, found {}", size));
  return found->make({size, seed});
}

std::unique_ptr<GeneratedMesh> as_generated(LoadedMesh mesh) {
  return std::make_unique<Held>(std::move(mesh));
}

}  // namespace meshhier::bench
