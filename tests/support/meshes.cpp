#include "tests/support/meshes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

namespace meshhier::tests {
namespace {

constexpr double kPi = std::numbers::pi;
std::uint32_t u32(std::size_t value) {
  return static_cast<std::uint32_t>(value);
}

/// SplitMix64 (Steele, Lea & Flood 2014): a bijection that mixes all bits.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// The least n >= low with factor * n^2 >= count.
std::size_t side_for(std::size_t count, std::size_t factor, std::size_t low) {
  std::size_t n = low;
  while (factor * n * n < count)
    ++n;
  return n;
}

Vec3f vec(double x, double y, double z) {
  return to_float(Vec3d{x, y, z});
}

void add_noise(TestMesh& mesh, float noise) {
  if (noise == 0)
    return;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i] =
        mesh.positions[i] + Vec3f{hash_noise(i, 0), hash_noise(i, 1), hash_noise(i, 2)} * noise;
  }
}

void add_quad(TestMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// Appends `other`, its vertices after those of `mesh`.
/// The rings of an octahedron of n edges a side: ring j of 2n + 1 has 4 min(j, 2n - j) vertices,
/// the first and the last have the one pole.
class OctahedronRings {
 public:
  explicit OctahedronRings(std::size_t n) : n_(n) {
    first_.push_back(0);
    for (std::size_t ring = 0; ring <= 2 * n; ++ring) {
      first_.push_back(first_.back() + std::max<std::size_t>(1, 4 * quarter(ring)));
    }
  }
  std::size_t quarter(std::size_t ring) const { return std::min(ring, 2 * n_ - ring); }
  /// Vertex `i` (0 .. quarter) of quarter `q` of `ring`.
  std::uint32_t vertex(std::size_t ring, std::size_t q, std::size_t i) const {
    const std::size_t count = std::max<std::size_t>(1, 4 * quarter(ring));
    return u32(first_[ring] + (q * quarter(ring) + i) % count);
  }

 private:
  std::size_t n_;
  std::vector<std::size_t> first_;
};

/// The triangles between a ring and the next larger one, towards a pole.
void add_octahedron_strip(TestMesh& mesh, const OctahedronRings& rings, std::size_t small,
                          std::size_t large) {
  for (std::size_t q = 0; q < 4; ++q) {
    for (std::size_t i = 0; i < rings.quarter(large); ++i) {
      const std::uint32_t tip = rings.vertex(small, q, i);
      const std::uint32_t a = rings.vertex(large, q, i);
      const std::uint32_t b = rings.vertex(large, q, i + 1);
      const bool down = small < large;  // the pole at the top: counter-clockwise from outside
      mesh.triangles.push_back(down ? MeshTriangle{tip, a, b} : MeshTriangle{tip, b, a});
      if (i == rings.quarter(small))
        continue;
      const std::uint32_t next = rings.vertex(small, q, i + 1);
      mesh.triangles.push_back(down ? MeshTriangle{tip, b, next} : MeshTriangle{tip, next, b});
    }
  }
}

/// Cells of a slab of (2 genus + 1) x 3 x 1, with holes at the odd columns of the middle row, each
/// cell of side^3 unit cubes.
class HoledSlab {
 public:
  HoledSlab(std::size_t genus, std::size_t side)
      : side_(side), size_{(2 * genus + 1) * side, 3 * side, side} {}

  /// Surface squares for side 1.
  static std::size_t squares(std::size_t genus) {
    const std::size_t columns = 2 * genus + 1;
    return 2 * (3 * columns - genus) + 2 * columns + 2 * 3 + 4 * genus;
  }

  TestMesh surface() {
    for (std::size_t z = 0; z < size_[2]; ++z) {
      for (std::size_t y = 0; y < size_[1]; ++y) {
        for (std::size_t x = 0; x < size_[0]; ++x)
          add_cube({x, y, z});
      }
    }
    return std::move(mesh_);
  }

 private:
  using Cell = std::array<std::size_t, 3>;

  /// Unsigned wrap-around makes -1 larger than any size.
  bool solid(const Cell& c) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (c[axis] >= size_[axis])
        return false;
    }
    return !(c[1] / side_ == 1 && (c[0] / side_) % 2 == 1);
  }

  void add_cube(const Cell& c) {
    if (!solid(c))
      return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Cell before = c, after = c;
      before[axis] -= 1;
      after[axis] += 1;
      if (!solid(before))
        add_square(c, axis, false);
      if (!solid(after))
        add_square(after, axis, true);
    }
  }

  /// The square at `corner` across `axis`, facing along the axis or against it.
  void add_square(const Cell& corner, std::size_t axis, bool forward) {
    Cell b = corner, c = corner, d = corner;
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    b[u] += 1;
    c[u] += 1;
    c[v] += 1;
    d[v] += 1;
    if (!forward)
      std::swap(b, d);
    add_quad(mesh_, vertex(corner), vertex(b), vertex(c), vertex(d));
  }

  std::uint32_t vertex(const Cell& c) {
    const auto [found, added] = vertices_.try_emplace(c, u32(mesh_.positions.size()));
    if (added)
      mesh_.positions.push_back(position(c));
    return found->second;
  }

  /// About 2 across, bent so that no part is flat.
  Vec3f position(const Cell& c) const {
    const double scale = 2.0 / static_cast<double>(size_[0]);
    const double x = static_cast<double>(c[0]) * scale - 1, y = static_cast<double>(c[1]) * scale;
    const double z = static_cast<double>(c[2]) * scale;
    return vec(x, y + 0.1 * std::sin(2 * x + z), z + 0.2 * std::sin(3 * x) * std::cos(2 * y));
  }

  std::size_t side_;
  Cell size_;
  std::map<Cell, std::uint32_t> vertices_;
  TestMesh mesh_;
};

/// A half plane of n x n quads that starts on the line of vertices 0 .. n and leaves it by `angle`.
void add_sheet(TestMesh& mesh, std::size_t n, double angle) {
  const std::uint32_t base = u32(mesh.positions.size());
  const auto vertex = [&](std::size_t row, std::size_t i) {
    return row == 0 ? u32(i) : u32(base + (row - 1) * (n + 1) + i);
  };
  const double step = 1.0 / static_cast<double>(n);
  for (std::size_t row = 1; row <= n; ++row) {
    const double r = static_cast<double>(row) * step;
    for (std::size_t i = 0; i <= n; ++i) {
      const double x = 2 * static_cast<double>(i) * step - 1;
      mesh.positions.push_back(vec(x, r * std::cos(angle), r * std::sin(angle)));
    }
  }
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t i = 0; i < n; ++i) {
      add_quad(mesh, vertex(row, i), vertex(row, i + 1), vertex(row + 1, i + 1),
               vertex(row + 1, i));
    }
  }
}

void add_bow_tie(TestMesh& mesh, Vec3f tip) {
  const std::uint32_t center = u32(mesh.positions.size());
  mesh.positions.push_back(tip);
  for (int side = 0; side < 2; ++side) {
    const std::uint32_t base = u32(mesh.positions.size());
    for (std::uint32_t i = 0; i < 8; ++i) {
      const double angle = i * kPi / 4, z = side == 0 ? 0.3 : -0.3;
      mesh.positions.push_back(tip + vec(0.2 * std::cos(angle), 0.2 * std::sin(angle), z));
      mesh.triangles.push_back({center, base + i, base + (i + 1) % 8});
    }
  }
}

template <class Value>
void shuffle(std::vector<Value>& values, std::uint64_t seed) {
  for (std::size_t i = values.size(); i > 1; --i) {
    std::swap(values[i - 1], values[mix(seed ^ mix(i)) % i]);
  }
}

}  // namespace

void append(TestMesh& mesh, const TestMesh& other, Vec3f shift, float scale) {
  const std::uint32_t base = u32(mesh.positions.size());
  for (const Vec3f p : other.positions)
    mesh.positions.push_back(p * scale + shift);
  for (const MeshTriangle& t : other.triangles)
    mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

TestMesh by_first_appearance(const TestMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.positions.size(), UINT32_MAX);
  TestMesh renumbered;
  for (MeshTriangle t : mesh.triangles) {
    for (std::uint32_t& corner : t) {
      if (number[corner] == UINT32_MAX) {
        number[corner] = static_cast<std::uint32_t>(renumbered.positions.size());
        renumbered.positions.push_back(mesh.positions[corner]);
      }
      corner = number[corner];
    }
    renumbered.triangles.push_back(t);
  }
  return renumbered;
}

float hash_noise(std::uint64_t index, std::uint64_t stream) {
  const std::uint64_t bits = mix(index ^ mix(stream)) >> 40;  // 24 bits: exact as a float
  return static_cast<float>(bits) / 8388608.0f - 1.0f;
}

TestMesh sphere(std::size_t triangles, float noise) {
  const std::size_t n = side_for(triangles, 8, 1);
  const OctahedronRings rings(n);
  TestMesh mesh;
  for (std::size_t ring = 0; ring <= 2 * n; ++ring) {
    const std::size_t count = std::max<std::size_t>(1, 4 * rings.quarter(ring));
    const double polar = kPi * static_cast<double>(ring) / static_cast<double>(2 * n);
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2 * kPi * static_cast<double>(i) / static_cast<double>(count);
      mesh.positions.push_back(vec(std::sin(polar) * std::cos(angle),
                                   std::sin(polar) * std::sin(angle), std::cos(polar)));
    }
  }
  for (std::size_t ring = 0; ring < n; ++ring)
    add_octahedron_strip(mesh, rings, ring, ring + 1);
  for (std::size_t ring = n; ring < 2 * n; ++ring) {
    add_octahedron_strip(mesh, rings, ring + 1, ring);
  }
  add_noise(mesh, noise);
  return mesh;
}

TestMesh torus(std::size_t triangles, float noise) {
  const std::size_t n = side_for(triangles, 6, 3), around = 3 * n;
  TestMesh mesh;
  const auto vertex = [&](std::size_t u, std::size_t v) { return u32((u % around) * n + v % n); };
  for (std::size_t u = 0; u < around; ++u) {
    const double a = 2 * kPi * static_cast<double>(u) / static_cast<double>(around);
    for (std::size_t v = 0; v < n; ++v) {
      const double b = 2 * kPi * static_cast<double>(v) / static_cast<double>(n);
      const double r = 0.7 + 0.3 * std::cos(b);
      mesh.positions.push_back(vec(r * std::cos(a), r * std::sin(a), 0.3 * std::sin(b)));
      add_quad(mesh, vertex(u, v), vertex(u + 1, v), vertex(u + 1, v + 1), vertex(u, v + 1));
    }
  }
  add_noise(mesh, noise);
  return mesh;
}

TestMesh genus_n(std::size_t genus, std::size_t triangles, float noise) {
  const std::size_t side = side_for(triangles, 2 * HoledSlab::squares(genus), 1);
  TestMesh mesh = HoledSlab(genus, side).surface();
  add_noise(mesh, noise);
  return mesh;
}

TestMesh nested_shells(std::size_t triangles, float noise) {
  TestMesh mesh = sphere((triangles + 1) / 2);
  TestMesh inner = mesh;
  for (Vec3f& p : inner.positions)
    p = p * 0.5f;
  for (MeshTriangle& t : inner.triangles)
    std::swap(t[1], t[2]);
  append(mesh, inner);
  add_noise(mesh, noise);
  return mesh;
}

TestMesh open_grid(std::size_t width, std::size_t height, float noise) {
  TestMesh mesh;
  const auto vertex = [&](std::size_t x, std::size_t y) { return u32(y * (width + 1) + x); };
  for (std::size_t y = 0; y <= height; ++y) {
    for (std::size_t x = 0; x <= width; ++x) {
      mesh.positions.push_back(vec(static_cast<double>(x), static_cast<double>(y), 0));
    }
  }
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      add_quad(mesh, vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1));
    }
  }
  add_noise(mesh, noise);
  return mesh;
}

TestMesh moebius(std::size_t triangles, float noise) {
  const std::size_t n = side_for(triangles, 16, 1), around = 8 * n;
  TestMesh mesh;
  const auto vertex = [&](std::size_t u, std::size_t v) {
    return u == around ? u32(n - v) : u32(u * (n + 1) + v);
  };
  for (std::size_t u = 0; u < around; ++u) {
    const double a = 2 * kPi * static_cast<double>(u) / static_cast<double>(around);
    for (std::size_t v = 0; v <= n; ++v) {
      const double s = 0.6 * (static_cast<double>(v) / static_cast<double>(n) - 0.5);
      const double r = 0.7 + s * std::cos(a / 2);
      mesh.positions.push_back(vec(r * std::cos(a), r * std::sin(a), s * std::sin(a / 2)));
      if (v == n)
        continue;
      add_quad(mesh, vertex(u, v), vertex(u + 1, v), vertex(u + 1, v + 1), vertex(u, v + 1));
    }
  }
  add_noise(mesh, noise);
  return mesh;
}

TestMesh non_manifold(std::size_t triangles, float noise) {
  const std::size_t n = side_for(triangles > 16 ? triangles - 16 : 0, 6, 1);
  TestMesh mesh;
  for (std::size_t i = 0; i <= n; ++i) {
    mesh.positions.push_back(vec(2 * static_cast<double>(i) / static_cast<double>(n) - 1, 0, 0));
  }
  for (int sheet = 0; sheet < 3; ++sheet)
    add_sheet(mesh, n, sheet * 2 * kPi / 3);
  add_bow_tie(mesh, {0, -2, 0});
  add_noise(mesh, noise);
  return mesh;
}

TestMesh soup(std::size_t triangles) {
  TestMesh mesh = points(3 * triangles);
  for (std::uint32_t v = 0; v < mesh.positions.size(); v += 3) {
    for (std::uint32_t i = v + 1; i < v + 3; ++i)
      mesh.positions[i] = mesh.positions[v] + mesh.positions[i] * 0.05f;
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  return mesh;
}

TestMesh points(std::size_t count) {
  TestMesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    mesh.positions.push_back({hash_noise(i, 10), hash_noise(i, 11), hash_noise(i, 12)});
  }
  return mesh;
}

TestMesh duplicates(std::size_t triangles, float noise) {
  TestMesh mesh = sphere(triangles, noise);
  const std::size_t vertex_count = mesh.positions.size(), triangle_count = mesh.triangles.size();
  std::vector<std::uint32_t> twin(vertex_count);
  std::iota(twin.begin(), twin.end(), 0u);
  for (std::size_t v = 0; v < vertex_count; v += 5) {
    twin[v] = u32(mesh.positions.size());
    mesh.positions.push_back(Vec3f(mesh.positions[v]));
  }
  for (std::size_t i = 0; i < triangle_count; ++i) {
    MeshTriangle t = mesh.triangles[i];
    if (i % 2 == 1)
      t = {twin[t[0]], twin[t[1]], twin[t[2]]};
    mesh.triangles[i] = t;
    if (i % 7 == 0)
      mesh.triangles.push_back(t);
    if (i % 11 == 0)
      mesh.triangles.push_back({t[1], t[2], t[0]});
    if (i % 13 == 0)
      mesh.triangles.push_back({t[0], t[2], t[1]});
  }
  return mesh;
}

TestMesh shuffled(const TestMesh& mesh, std::uint64_t seed) {
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  shuffle(order, seed);
  TestMesh result;
  result.positions.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    result.positions[order[i]] = mesh.positions[i];
  for (const MeshTriangle& t : mesh.triangles) {
    result.triangles.push_back({order[t[0]], order[t[1]], order[t[2]]});
  }
  shuffle(result.triangles, seed + 1);
  return result;
}

namespace {

/// Sorts ascending what begins with a number up to about as many as there are items: by counting
/// those of each beginning, several times as fast as std::sort.
template <class Item, class Beginning>
void sort_by_beginning(std::vector<Item>& items, const Beginning& beginning) {
  std::uint32_t last = 0;
  for (const Item& item : items)
    last = std::max(last, beginning(item));
  std::vector<std::size_t> places(std::size_t{last} + 2);
  for (const Item& item : items)
    ++places[std::size_t{beginning(item)} + 1];
  std::partial_sum(places.begin(), places.end(), places.begin());
  std::vector<Item> sorted(items.size());
  for (const Item& item : items)
    sorted[places[beginning(item)]++] = item;
  auto from = sorted.begin();
  for (const std::size_t end : places) {  // by now, where each beginning's items end
    const auto to = sorted.begin() + static_cast<std::ptrdiff_t>(end);
    std::sort(from, to);
    from = to;
  }
  items.swap(sorted);
}

/// Edges as single numbers: they sort three times as fast as pairs, and in the same order.
using EdgeKey = std::uint64_t;

EdgeKey edge_key(std::uint32_t from, std::uint32_t to) {
  return EdgeKey{from} << 32 | to;
}

std::vector<EdgeKey> sorted_keys(std::span<const MeshTriangle> triangles,
                                 EdgeKey (*key)(std::uint32_t from, std::uint32_t to)) {
  std::vector<EdgeKey> keys;
  keys.reserve(3 * triangles.size());
  for (const MeshTriangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k)
      keys.push_back(key(t[k], t[(k + 1) % 3]));
  }
  sort_by_beginning(keys, [](EdgeKey edge) { return static_cast<std::uint32_t>(edge >> 32); });
  return keys;
}

std::vector<EdgeKey> undirected_keys(std::span<const MeshTriangle> triangles) {
  return sorted_keys(triangles, [](std::uint32_t from, std::uint32_t to) {
    return edge_key(std::min(from, to), std::max(from, to));
  });
}

std::vector<Edge> edges_of(const std::vector<EdgeKey>& keys) {
  std::vector<Edge> edges;
  edges.reserve(keys.size());
  for (const EdgeKey key : keys)
    edges.push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)});
  return edges;
}

}  // namespace

void sort_triangles(std::vector<MeshTriangle>& triangles) {
  sort_by_beginning(triangles, [](const MeshTriangle& t) { return t[0]; });
}

std::vector<Edge> directed_edges(std::span<const MeshTriangle> triangles) {
  return edges_of(sorted_keys(triangles, edge_key));
}

std::vector<Edge> undirected_edges(std::span<const MeshTriangle> triangles) {
  return edges_of(undirected_keys(triangles));
}

std::vector<Edge> boundary_edges(std::span<const MeshTriangle> triangles) {
  const std::vector<EdgeKey> keys = undirected_keys(triangles);
  std::vector<EdgeKey> result;
  for (std::size_t i = 0, end = 0; i < keys.size(); i = end) {
    while (end < keys.size() && keys[end] == keys[i])
      ++end;
    if (end == i + 1)
      result.push_back(keys[i]);
  }
  return edges_of(result);
}

std::vector<Edge> unmatched_edges(std::span<const MeshTriangle> triangles) {
  const std::vector<EdgeKey> keys = sorted_keys(triangles, edge_key);
  const std::vector<EdgeKey> opposites = sorted_keys(
      triangles, [](std::uint32_t from, std::uint32_t to) { return edge_key(to, from); });
  std::vector<EdgeKey> result;
  std::set_difference(keys.begin(), keys.end(), opposites.begin(), opposites.end(),
                      std::back_inserter(result));
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return edges_of(result);
}

bool is_closed(std::span<const MeshTriangle> triangles) {
  return !triangles.empty() && unmatched_edges(triangles).empty();
}

std::int64_t euler_characteristic(std::span<const MeshTriangle> triangles) {
  std::vector<Edge> edges = undirected_edges(triangles);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<std::uint32_t> vertices;
  for (const MeshTriangle& t : triangles)
    vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return static_cast<std::int64_t>(vertices.size()) - static_cast<std::int64_t>(edges.size()) +
         static_cast<std::int64_t>(triangles.size());
}

std::size_t component_count(const TestMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v)
      v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<bool> used(parent.size());
  for (const MeshTriangle& t : mesh.triangles) {
    for (std::uint32_t corner : t) {
      used[corner] = true;
      parent[root(corner)] = root(t[0]);
    }
  }
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < parent.size(); ++v)
    count += used[v] && root(v) == v ? 1 : 0;
  return count;
}

void write_ply(const TestMesh& mesh, const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little);
  std::ofstream out(path, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  out.write(reinterpret_cast<const char*>(mesh.positions.data()),
            static_cast<std::streamsize>(mesh.positions.size() * sizeof(Vec3f)));
  for (const MeshTriangle& t : mesh.triangles) {
    char record[13] = {3};
    std::memcpy(record + 1, t.data(), 12);
    out.write(record, sizeof record);
  }
  out.close();
  if (!out)
    throw std::runtime_error("cannot write " + path.string());
}

}  // namespace meshhier::tests
