#include "tests/cluster_simplify/stars.h"

#include "tests/cluster_simplify/test_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

/// Noise of one star: a number in [0, 1) per question.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : seed_(seed) {}
  double operator()() { return (double{hash_noise(asked_++, 1000 + seed_)} + 1) / 2; }
  double between(double low, double high) { return low + (high - low) * (*this)(); }
  std::uint32_t below(std::uint32_t count) {
    return std::min(count - 1, static_cast<std::uint32_t>((*this)() * count));
  }

 private:
  std::uint64_t seed_;
  std::uint64_t asked_ = 0;
};

double height(const StarRelief& relief, double x, double y, Chance& chance) {
  return relief.crease * std::abs(x + y / 2) + relief.bowl * (x * x + y * y) +
         relief.noise * chance.between(-1, 1);
}

/// Ring vertices 2, 3, ... at angles that ascend from `first` to `last`.
void add_ring(TestMesh& mesh, const StarRelief& relief, std::uint32_t count, double first,
              double last, Chance& chance) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool open = last - first < 6;
    const double steps = open ? count - 1 : count;
    const bool at_end = open && (i == 0 || i + 1 == count);
    const double angle =
        first + (last - first) * (i + (at_end ? 0 : chance.between(-0.3, 0.3))) / steps;
    const double radius = chance.between(1.6, 2.2);
    const double x = radius * std::cos(angle);
    const double y = radius * std::sin(angle);
    mesh.positions.push_back(vec3f(x, y, height(relief, x, y, chance)));
  }
}

void set_end(TestMesh& mesh, std::uint32_t v, const StarRelief& relief, double x, double y,
             Chance& chance) {
  mesh.positions[v] = vec3f(x, y, height(relief, x, y, chance));
}

/// Links [begin, end) of the ring with `apex`.
void add_links(TestMesh& mesh, std::uint32_t apex, std::uint32_t begin, std::uint32_t end,
               std::uint32_t ring_size) {
  for (std::uint32_t i = begin; i < end; ++i)
    mesh.triangles.push_back({apex, 2 + i, 2 + (i + 1) % ring_size});
}

TestMesh closed_star(const StarRelief& relief, Chance& chance) {
  TestMesh mesh{std::vector<Vec3f>(2), {}};
  const std::uint32_t count = 4 + chance.below(8);
  add_ring(mesh, relief, count, std::numbers::pi / 2, std::numbers::pi * 5 / 2, chance);
  set_end(mesh, 0, relief, -0.5, chance.between(-0.2, 0.2), chance);
  set_end(mesh, 1, relief, 0.5, chance.between(-0.2, 0.2), chance);
  const std::uint32_t turn = count / 2;
  add_links(mesh, 0, 0, turn, count);
  add_links(mesh, 1, turn, count, count);
  mesh.triangles.push_back({0, 1, 2});
  mesh.triangles.push_back({1, 0, 2 + turn});
  return mesh;
}

TestMesh border_edge_star(const StarRelief& relief, Chance& chance) {
  TestMesh mesh{std::vector<Vec3f>(2), {}};
  const std::uint32_t count = 3 + chance.below(6);  // vertices
  add_ring(mesh, relief, count, 0.1, std::numbers::pi - 0.1, chance);
  set_end(mesh, 0, relief, 0.6, chance.between(-0.1, 0.1), chance);  // the right one
  set_end(mesh, 1, relief, -0.6, chance.between(-0.1, 0.1), chance);
  const std::uint32_t turn = chance.below(4) == 0 ? 0 : chance.below(count);
  add_links(mesh, 0, 0, turn, count);
  add_links(mesh, 1, turn, count - 1, count);
  mesh.triangles.push_back({1, 0, 2 + turn});
  return mesh;
}

TestMesh border_end_star(const StarRelief& relief, Chance& chance) {
  TestMesh mesh{std::vector<Vec3f>(2), {}};
  const std::uint32_t count = 4 + chance.below(6);  // vertices
  add_ring(mesh, relief, count, 0, std::numbers::pi, chance);
  set_end(mesh, 0, relief, chance.between(-0.2, 0.2), 0.7, chance);  // inside
  set_end(mesh, 1, relief, 0, 0, chance);
  const bool ear = chance.below(4) == 0;
  const std::uint32_t head = ear ? 0 : chance.below(count / 2);
  const std::uint32_t turn = ear ? count - 1 : count / 2 + chance.below(count / 2);
  add_links(mesh, 1, 0, head, count);
  add_links(mesh, 0, head, turn, count);
  add_links(mesh, 1, turn, count - 1, count);
  mesh.triangles.push_back({1, 2 + head, 0});
  mesh.triangles.push_back({1, 0, 2 + turn});
  return mesh;
}

}  // namespace

Star make_star(StarShape shape, const StarRelief& relief, double deviation, std::uint64_t seed) {
  Chance chance(seed);
  Star star;
  star.mesh = shape == StarShape::closed        ? closed_star(relief, chance)
              : shape == StarShape::border_edge ? border_edge_star(relief, chance)
                                                : border_end_star(relief, chance);
  if (chance.below(2) == 0)
    std::swap(star.from, star.to);
  const Vec3f a = star.mesh.positions[star.from];
  const Vec3f b = star.mesh.positions[star.to];
  switch (chance.below(4)) {
    case 0:
      star.place = a;
      break;
    case 1:
      star.place = b;
      break;
    case 2:
      star.place = (a + b) * 0.5F;
      break;
    default: {
      const auto part = static_cast<float>(chance());
      const auto any = [&] { return chance.between(-0.15, 0.15); };
      star.place = a * part + b * (1 - part) + vec3f(any(), any(), any() + relief.noise * any());
    }
  }
  for (std::size_t t = 0; t < star.mesh.triangles.size(); ++t) {
    const bool deviated = deviation > 0 && chance.below(3) > 0;
    star.deviations.push_back(deviated ? static_cast<float>(deviation * chance()) : 0.0F);
  }
  return star;
}

Star round_star(RoundRing ring, const StarRelief& relief, std::uint64_t seed) {
  Chance chance(seed);
  Star star{{std::vector<Vec3f>(2), {}}, 0, 1, vec3f(0.1, 0.05, 0), {}};
  TestMesh& mesh = star.mesh;
  // The ends lie on the line between the first and the last ring vertex of vertex 0.
  const double first = -std::numbers::pi * ring.from_links / ring.size;
  set_end(mesh, 0, relief, 0.4, 0, chance);
  set_end(mesh, 1, relief, -0.4, 0, chance);
  for (std::uint32_t i = 0; i < ring.size; ++i) {
    const double angle = first + 2 * std::numbers::pi * i / ring.size;
    const double x = 2 * std::cos(angle);
    const double y = 2 * std::sin(angle);
    mesh.positions.push_back(vec3f(x, y, height(relief, x, y, chance)));
  }
  add_links(mesh, 0, 0, ring.from_links, ring.size);
  add_links(mesh, 1, ring.from_links, ring.size, ring.size);
  mesh.triangles.push_back({0, 1, 2});
  mesh.triangles.push_back({1, 0, 2 + ring.from_links});
  for (std::uint32_t i = count_of(mesh.triangles); i-- > 1;) {
    std::swap(mesh.triangles[i], mesh.triangles[chance.below(i + 1)]);
    std::ranges::rotate(mesh.triangles[i], mesh.triangles[i].begin() + chance.below(3));
  }
  star.deviations.resize(mesh.triangles.size());
  return star;
}

StarMesh::StarMesh(const Star& star) : star_(star), mesh_(tile_of(star.mesh).mesh) {
  edge_star_.gather(mesh_, star.from, star.to);
  if (edge_star_.is_disc())
    edge_star_.look_from(star.place, star.mesh.positions);
}

bool StarMesh::survives(std::uint32_t triangle) const {
  const MeshTriangle& t = star_.mesh.triangles[triangle];
  return std::ranges::count(t, star_.from) + std::ranges::count(t, star_.to) < 2;
}

std::vector<Corners> StarMesh::after() const {
  TestMesh moved = star_.mesh;
  moved.positions[star_.from] = moved.positions[star_.to] = star_.place;
  std::vector<Corners> surface = surface_of(moved);
  for (std::uint32_t t = 0; t < surface.size(); ++t) {
    if (!survives(t))
      surface[t].fill(Vec3d{1e9, 1e9, 1e9});
  }
  return surface;
}

double expect_covers(const Star& star, const StarMesh& mesh, const cluster_simplify::DiscGap& gap) {
  constexpr int kSteps = 12;
  constexpr double kSlack = 1e-9;
  const std::vector<Corners> before = mesh.before();
  const std::vector<Corners> after = mesh.after();
  std::vector<double> fresh(after.size(), -1);
  EXPECT_EQ(gap.triangles.size(), gap.deviations.size());
  for (std::size_t i = 0; i < gap.triangles.size(); ++i)
    fresh[gap.triangles[i]] = double{gap.deviations[i]};
  double farthest = 0;
  for (std::uint32_t t = 0; t < after.size(); ++t) {
    EXPECT_EQ(fresh[t] >= 0, mesh.survives(t)) << "triangle " << t;
    if (!mesh.survives(t))
      continue;
    for (const Vec3d p : samples_of(after[t], kSteps)) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t old = 0; old < before.size(); ++old)
        least =
            std::min(least, distance_to_triangle(p, before[old]) + double{star.deviations[old]});
      EXPECT_LE(least, fresh[t] + kSlack) << "new triangle " << t;
      farthest = std::max(farthest, distance_to_surface(p, before));
    }
  }
  for (std::size_t old = 0; old < before.size(); ++old) {
    for (const Vec3d p : samples_of(before[old], kSteps)) {
      double missing = std::numeric_limits<double>::infinity();
      for (std::size_t t = 0; t < after.size(); ++t) {
        missing = std::min(
            missing, distance_to_triangle(p, after[t]) + double{star.deviations[old]} - fresh[t]);
      }
      EXPECT_LE(missing, kSlack) << "old triangle " << old;
      farthest = std::max(farthest, distance_to_surface(p, after));
    }
  }
  const auto at = [&](std::uint32_t v) { return to_double(star.mesh.positions[v]); };
  EXPECT_GE(std::abs(gap.from) + 1e-5, distance_to_surface(at(star.from), after));
  EXPECT_GE(std::abs(gap.to) + 1e-5, distance_to_surface(at(star.to), after));
  return farthest;
}

float largest_deviation(const cluster_simplify::DiscGap& gap) {
  return std::ranges::max(gap.deviations);
}

int expect_all_covered(StarShape shape, const StarRelief& relief, std::uint64_t seeds,
                       const MeasureStar& measure) {
  SCOPED_TRACE(relief.name);
  int measured = 0;
  for (std::uint64_t seed = 0; seed < seeds && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    const Star star = make_star(shape, relief, seed % 2 == 0 ? 0 : 0.1, seed);
    const StarMesh mesh(star);
    if (const auto gap = measure(star, mesh)) {
      ++measured;
      expect_covers(star, mesh, *gap);
    }
  }
  return measured;
}

Looseness looseness_of(StarShape shape, const StarRelief& relief, std::uint64_t seeds,
                       const MeasureStar& measure) {
  Looseness looseness;
  double sum = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const Star star = make_star(shape, relief, 0, seed);
    const StarMesh mesh(star);
    const auto gap = measure(star, mesh);
    if (!gap)
      continue;
    const double ratio = double{largest_deviation(*gap)} / expect_covers(star, mesh, *gap);
    looseness.largest = std::max(looseness.largest, ratio);
    sum += ratio;
    ++looseness.stars;
  }
  looseness.mean = sum / looseness.stars;
  return looseness;
}

}  // namespace meshhier::tests
