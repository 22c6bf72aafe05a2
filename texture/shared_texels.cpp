#include "texture/shared_texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace meshhier::texture {
namespace {

/// The period is divided into so many cells each way, to find what lies near a place.
constexpr int kCells = 16;
/// A cell knows so many shared parts at most, and a piece looks at no more.
constexpr std::size_t kMostInCell = 16;

TexcoordBox moved(const TexcoordBox& box, double u, double v) {
  return {box.u0 + u, box.v0 + v, box.u1 + u, box.v1 + v};
}

TexcoordBox joined(const TexcoordBox& a, const TexcoordBox& b) {
  return {std::min(a.u0, b.u0), std::min(a.v0, b.v0), std::max(a.u1, b.u1), std::max(a.v1, b.v1)};
}

/// A material's picture: its shared parts, to be found by the place.
class Picture {
 public:
  explicit Picture(const AtlasMaterial& texels) : texels_(texels) {
    period_u_ = period(texels, texels.wrap_u);
    period_v_ = period(texels, texels.wrap_v);
  }

  TexelBox texels_of(const TexcoordBox& box) const { return texels_around(box, texels_, 0); }

  /// By what a piece is moved so that it begins in the first period.
  SharedPlace first_place(const TexcoordBox& box) const {
    return {0, to_first(box.u0, period_u_), to_first(box.v0, period_v_)};
  }

  const std::vector<std::uint32_t>& near(const TexcoordBox& box) const {
    return cells_[cell(middle(box.u0, box.u1), period_u_)][cell(middle(box.v0, box.v1), period_v_)];
  }

  /// The moves of a piece that may bring it into `shared`.
  std::array<SharedPlace, 4> moves(const TexcoordBox& piece, const TexcoordBox& shared) const {
    const double u = into(piece.u0, shared.u0, period_u_), v = into(piece.v0, shared.v0, period_v_);
    return {SharedPlace{0, u, v},
            {0, u - period_u_, v},
            {0, u, v - period_v_},
            {0, u - period_u_, v - period_v_}};
  }

  /// Makes `shared` known to all cells that it covers.
  void add(std::uint32_t shared, const TexcoordBox& box) {
    const auto [u0, u1] = cells_between(box.u0, box.u1, period_u_);
    const auto [v0, v1] = cells_between(box.v0, box.v1, period_v_);
    for (int u = u0; u <= u1; ++u) {
      for (int v = v0; v <= v1; ++v)
        add(cells_[static_cast<std::size_t>(u % kCells)][static_cast<std::size_t>(v % kCells)],
            shared);
    }
  }

 private:
  static void add(std::vector<std::uint32_t>& cell, std::uint32_t shared) {
    if (cell.size() < kMostInCell && std::find(cell.begin(), cell.end(), shared) == cell.end())
      cell.push_back(shared);
  }
  static double middle(double low, double high) { return low + (high - low) / 2; }
  static double to_first(double low, double period) {
    return period == 0 ? 0 : -period * std::floor(low / period);
  }
  /// The least move that brings `low` to `first` or beyond.
  static double into(double low, double first, double period) {
    return period == 0 ? 0 : period * std::ceil((first - low) / period);
  }
  /// Pictures that do not repeat have cells in 0 ... 1, the outer ones for all that is beyond.
  static std::size_t cell(double at, double period) {
    if (period == 0)
      return static_cast<std::size_t>(std::clamp(at, 0.0, 1 - 0.5 / kCells) * kCells);
    const double part = at / period - std::floor(at / period);
    return std::min<std::size_t>(static_cast<std::size_t>(part * kCells), kCells - 1);
  }
  static std::array<int, 2> cells_between(double low, double high, double period) {
    const auto first = static_cast<int>(cell(low, period)),
               last = static_cast<int>(cell(high, period));
    if (period == 0)
      return {first, last};
    if (high - low >= period)
      return {0, kCells - 1};
    return {first, last < first ? last + kCells : last};
  }

  const AtlasMaterial& texels_;
  double period_u_ = 0, period_v_ = 0;
  std::array<std::array<std::vector<std::uint32_t>, kCells>, kCells> cells_;
};

class Sharer {
 public:
  Sharer(std::span<const ChartPiece> pieces, std::span<const AtlasMaterial> materials,
         std::uint32_t most_side)
      : pieces_(pieces), materials_(materials), most_side_(most_side) {}

  SharedCharts operator()() && {
    result_.places.resize(pieces_.size());
    const std::vector<std::uint32_t> order = by_material_and_size();
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
      const std::uint32_t material = pieces_[order[begin]].material;
      while (end < order.size() && pieces_[order[end]].material == material)
        ++end;
      share(material, std::span(order).subspan(begin, end - begin));
    }
    return std::move(result_);
  }

 private:
  double texels_of(std::uint32_t piece) const {
    const ChartPiece& chart = pieces_[piece];
    return texels_around(chart.box, materials_[chart.material], 0).area();
  }

  /// The largest pieces of a material first.
  std::vector<std::uint32_t> by_material_and_size() const {
    std::vector<double> texels(pieces_.size());
    for (std::uint32_t p = 0; p < pieces_.size(); ++p)
      texels[p] = texels_of(p);
    std::vector<std::uint32_t> order(pieces_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (pieces_[a].material != pieces_[b].material)
        return pieces_[a].material < pieces_[b].material;
      return texels[a] != texels[b] ? texels[a] > texels[b] : a < b;
    });
    return order;
  }

  void share(std::uint32_t material, std::span<const std::uint32_t> pieces) {
    Picture picture(materials_[material]);
    for (const std::uint32_t p : pieces) {
      SharedPlace& place = result_.places[p] = best_place(p, picture);
      const TexcoordBox box = moved(pieces_[p].box, place.u, place.v);
      if (place.shared == result_.shared.size())
        result_.shared.push_back({material, box});
      TexcoordBox& all = result_.shared[place.shared].box;
      all = joined(all, box);
      picture.add(place.shared, all);
    }
  }

  /// Where a piece adds the fewest texels; a place of its own if none saves some.
  SharedPlace best_place(std::uint32_t piece, const Picture& picture) const {
    const TexcoordBox& box = pieces_[piece].box;
    SharedPlace best = picture.first_place(box);
    best.shared = static_cast<std::uint32_t>(result_.shared.size());
    double least = picture.texels_of(box).area();
    for (const std::uint32_t other : picture.near(box)) {
      const TexcoordBox& shared = result_.shared[other].box;
      const double before = picture.texels_of(shared).area();
      for (const SharedPlace& move : picture.moves(box, shared)) {
        const TexelBox both = picture.texels_of(joined(shared, moved(box, move.u, move.v)));
        if (std::max(both.width, both.height) <= most_side_ && both.area() - before < least) {
          least = both.area() - before;
          best = {other, move.u, move.v};
        }
      }
    }
    return best;
  }

  std::span<const ChartPiece> pieces_;
  std::span<const AtlasMaterial> materials_;
  std::uint32_t most_side_;
  SharedCharts result_;
};

}  // namespace

SharedCharts share_texels(std::span<const ChartPiece> pieces,
                          std::span<const AtlasMaterial> materials, std::uint32_t most_side) {
  return Sharer(pieces, materials, most_side)();
}

}  // namespace meshhier::texture
