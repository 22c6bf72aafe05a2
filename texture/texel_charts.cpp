#include "texture/texel_charts.h"

#include "base/union_find.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>

namespace meshhier::texture {
namespace {

/// A chart with less of its texels inside triangles may be cut.
constexpr double kFull = 1.0 / 3;
/// Pieces may have so much of the texels of the whole.
constexpr double kPays = 0.75;
/// A chart that is longer than so many periods of its picture is cut.
constexpr double kManyPeriods = 1.5;

struct Point {
  double u = 0, v = 0;
};

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr TexcoordBox kNowhere{kInfinite, kInfinite, -kInfinite, -kInfinite};

void add(TexcoordBox& box, const Point& p) {
  box = {std::min(box.u0, p.u), std::min(box.v0, p.v), std::max(box.u1, p.u),
         std::max(box.v1, p.v)};
}

/// Near the middle of two triple coordinates, where the picture begins again if it does between
/// them.
double cut_line(double low, double high, double period) {
  const double middle = low + (high - low) / 2;
  if (period == 0)
    return middle;
  const double begin = 3 * period * std::round(middle / (3 * period));
  return begin > low && begin <= high ? begin : middle;
}

std::int64_t aligned(std::int64_t length) {
  const std::int64_t unit = kLeafAlignment;
  return (length + unit - 1) / unit * unit;
}

/// Joins the vertices of each triangle, and those of equal coordinates in a material.
UnionFind connect(const LeafTriangles& leaf) {
  const auto count = static_cast<std::uint32_t>(leaf.texcoords.size());
  UnionFind sets(count);
  for (const TileTriangle& t : leaf.triangles) {
    sets.join(raw(t[0]), raw(t[1]));
    sets.join(raw(t[0]), raw(t[2]));
  }
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); };
  const auto key = [&](std::uint32_t v) {
    const Vec2f& at = leaf.texcoords[v];
    return std::tuple(leaf.materials[v], bits(at.u), bits(at.v));
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i - 1]) == key(order[i]))
      sets.join(order[i - 1], order[i]);
  }
  return sets;
}

class Cutter {
 public:
  Cutter(const LeafTriangles& leaf, std::span<const AtlasMaterial> materials,
         std::uint32_t most_side)
      : leaf_(leaf), materials_(materials), most_side_(most_side) {}

  ChartPieces operator()() && {
    UnionFind sets = connect(leaf_);
    std::vector<std::array<std::uint32_t, 3>> order(leaf_.triangles.size());
    for (std::uint32_t t = 0; t < order.size(); ++t)
      order[t] = {sets.find(raw(leaf_.triangles[t][0])), material_of(t), t};
    std::sort(order.begin(), order.end());
    for (const auto& [set, material, t] : order)
      result_.triangles.push_back(t);
    std::uint32_t begin = 0;
    for (std::uint32_t i = 1; i <= order.size(); ++i) {
      if (i < order.size() && order[i][0] == order[begin][0] && order[i][1] == order[begin][1])
        continue;
      cut(begin, i);
      begin = i;
    }
    return std::move(result_);
  }

 private:
  std::uint32_t material_of(std::uint32_t triangle) const {
    return leaf_.materials[raw(leaf_.triangles[triangle][0])];
  }
  Point point(std::uint32_t triangle, std::size_t corner) const {
    const Vec2f& at = leaf_.texcoords[raw(leaf_.triangles[triangle][corner])];
    return {clamped_texcoord(at.u), clamped_texcoord(at.v)};
  }
  /// Three times its centroid.
  Point middle(std::uint32_t t) const {
    const Point a = point(t, 0), b = point(t, 1), c = point(t, 2);
    return {a.u + b.u + c.u, a.v + b.v + c.v};
  }
  /// In texture coordinates.
  double area(std::uint32_t t) const {
    const Point a = point(t, 0), b = point(t, 1), c = point(t, 2);
    return std::abs((b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v)) / 2;
  }

  ChartPiece piece(std::uint32_t begin, std::uint32_t end) const {
    ChartPiece result{material_of(result_.triangles[begin]), begin, end, kNowhere};
    for (std::uint32_t i = begin; i < end; ++i) {
      for (std::size_t corner = 0; corner < 3; ++corner)
        add(result.box, point(result_.triangles[i], corner));
    }
    return result;
  }

  bool is_full(const ChartPiece& whole, const TexelBox& box) const {
    const AtlasMaterial& picture = materials_[whole.material];
    double covered = 0;
    for (std::uint32_t i = whole.begin; i < whole.end; ++i)
      covered += area(result_.triangles[i]);
    return covered * picture.width * picture.height >= kFull * box.area();
  }

  bool is_repeated(const ChartPiece& chart) const {
    const auto is_long = [](double length, double period) {
      return period > 0 && length > kManyPeriods * period;
    };
    const AtlasMaterial& picture = materials_[chart.material];
    return is_long(chart.box.u1 - chart.box.u0, period(picture, picture.wrap_u)) ||
           is_long(chart.box.v1 - chart.box.v0, period(picture, picture.wrap_v));
  }

  /// Sorts the triangles by the side of a line on which their middles are, and returns where the
  /// second side begins; the end if that is not worth a cut.
  std::uint32_t divide(const ChartPiece& whole) {
    TexcoordBox middles = kNowhere;
    for (std::uint32_t i = whole.begin; i < whole.end; ++i)
      add(middles, middle(result_.triangles[i]));
    const AtlasMaterial& picture = materials_[whole.material];
    const double width = (middles.u1 - middles.u0) * picture.width;
    const double height = (middles.v1 - middles.v0) * picture.height;
    if (!(std::max(width, height) > 3))
      return whole.end;  // less than a texel
    const double u = cut_line(middles.u0, middles.u1, period(picture, picture.wrap_u));
    const double v = cut_line(middles.v0, middles.v1, period(picture, picture.wrap_v));
    const auto is_first = [&](std::uint32_t t) {
      const Point at = middle(t);
      return width >= height ? at.u < u : at.v < v;
    };
    const auto second = std::stable_partition(result_.triangles.begin() + whole.begin,
                                              result_.triangles.begin() + whole.end, is_first);
    return static_cast<std::uint32_t>(second - result_.triangles.begin());
  }

  /// Appends the pieces and returns their texels.
  double cut(std::uint32_t begin, std::uint32_t end) {
    const ChartPiece whole = piece(begin, end);
    const AtlasMaterial& picture = materials_[whole.material];
    const std::size_t first = result_.pieces.size();
    const TexelBox box = texels_around(whole.box, picture, 0);
    const bool fits = std::max(box.width, box.height) <= most_side_ && !is_repeated(whole);
    const bool stays = picture.width == 0 || (fits && is_full(whole, box));
    if (const std::uint32_t second = stays ? end : divide(whole); second < end) {
      const double texels = cut(begin, second) + cut(second, end);
      if (!fits || texels <= kPays * box.area())
        return texels;
      result_.pieces.resize(first);
    }
    result_.pieces.push_back(whole);
    return box.area();
  }

  const LeafTriangles& leaf_;
  std::span<const AtlasMaterial> materials_;
  std::uint32_t most_side_;
  ChartPieces result_;
};

}  // namespace

double clamped_texcoord(float value) {
  return value > -kFarthestTexcoord ? std::min<double>(value, kFarthestTexcoord)
                                    : -kFarthestTexcoord;
}

double period(const AtlasMaterial& material, Wrap wrap) {
  if (material.width == 0 || wrap == Wrap::clamp)
    return 0;
  return wrap == Wrap::mirrored ? 2 : 1;
}

std::uint32_t level_side(std::uint32_t side, std::uint32_t level) {
  if (level >= 32)
    return 1;
  return static_cast<std::uint32_t>((std::uint64_t{side} + (std::uint64_t{1} << level) - 1) >>
                                    level);
}

TexelBox texels_around(const TexcoordBox& box, const AtlasMaterial& material, std::uint32_t level) {
  const std::int64_t gutter = kLeafGutter;
  const double width = level_side(material.width, level);
  const double height = level_side(material.height, level);
  const auto low = [&](double at) { return static_cast<std::int64_t>(std::floor(at)) - gutter; };
  const auto high = [&](double at) { return static_cast<std::int64_t>(std::ceil(at)) + gutter; };
  TexelBox texels{low(box.u0 * width), low(box.v0 * height)};
  texels.width = aligned(high(box.u1 * width) - texels.x);
  texels.height = aligned(high(box.v1 * height) - texels.y);
  return texels;
}

ChartPieces cut_charts(const LeafTriangles& leaf, std::span<const AtlasMaterial> materials,
                       std::uint32_t most_side) {
  return Cutter(leaf, materials, most_side)();
}

}  // namespace meshhier::texture
