#include "texture/chart_refining.h"

#include "texture/texel_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace meshhier::texture {
namespace {

/// About what is covered of a picture.
constexpr double kUsual = 0.5;
/// A chart with less of its rectangle covered may be cut; its pieces may have so much of it.
constexpr double kFullEnough = 0.75;
constexpr double kSaves = 0.84;
/// A larger part of all rectangles is cut even if that saves nothing: large ones leave gaps.
constexpr double kLargest = 1.0 / 16;
/// Fewer triangles are not cut.
constexpr std::size_t kFewest = 16;
/// A triangle that is seen more from the side leaves its chart: the sine of 12 degrees.
constexpr double kLeastSeen = 0.2;
/// Triangles that leave are charts together up to so many times, then alone.
constexpr int kRounds = 4;

class Refiner {
 public:
  Refiner(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles,
          const Faces& faces, std::uint32_t side)
      : positions_(positions),
        triangles_(triangles),
        faces_(faces),
        leaves_(triangles.size()),
        side_(side) {
    double area = 0;
    for (const double a : faces.areas)
      area += a;
    density_ = area > 0 ? side * std::sqrt(kUsual / area) : 1;
  }

  PlaneCharts operator()(const SurfaceCharts& charts) && {
    for (std::uint32_t c = 0; c < charts.ends.size(); ++c)
      cut({charts.triangles.begin() + charts.begin_of(c),
           charts.triangles.begin() + charts.ends[c]});
    for (Piece& piece : std::exchange(pieces_, {}))
      uncover(std::move(piece), 0);
    for (const Piece& piece : pieces_) {
      result_.planes.push_back(piece.plane);
      result_.charts.triangles.insert(result_.charts.triangles.end(), piece.triangles.begin(),
                                      piece.triangles.end());
      result_.charts.ends.push_back(static_cast<std::uint32_t>(result_.charts.triangles.size()));
    }
    return std::move(result_);
  }

 private:
  struct Piece {
    std::vector<std::uint32_t> triangles;
    ChartPlane plane;
  };

  Piece piece(std::vector<std::uint32_t> triangles) const {
    const ChartPlane plane = project(positions_, triangles_, faces_, triangles);
    return {std::move(triangles), plane};
  }
  Vec3d position(std::uint32_t triangle, std::size_t corner) const {
    return to_double(positions_[raw(triangles_[triangle][corner])]);
  }
  /// The texels of a chart's rectangle, gutter and all.
  double texels_of(const ChartPlane& plane) const {
    const double width = plane.width * density_ + 2 * kBakeGutter;
    const double height = plane.height * density_ + 2 * kBakeGutter;
    return (width + kBakeAlignment / 2.0) * (height + kBakeAlignment / 2.0);
  }
  bool is_full(const Piece& whole, double texels) const {
    double covered = 0;
    for (const std::uint32_t t : whole.triangles)
      covered += faces_.areas[t] * std::max(dot(faces_.normals[t], whole.plane.normal), 0.0);
    return covered * density_ * density_ >= kFullEnough * texels;
  }

  /// Appends its pieces, and returns their texels.
  double cut(std::vector<std::uint32_t> triangles) {
    Piece whole = piece(std::move(triangles));
    const double texels = texels_of(whole.plane);
    const bool fits = texels <= kLargest / kUsual * double(side_) * side_;
    const bool stays = whole.triangles.size() < kFewest || is_full(whole, texels);
    if (auto [first, second] = stays ? Halves{} : halves(whole);
        !first.empty() && !second.empty()) {
      const std::size_t count = pieces_.size();
      const double cut_texels = cut(std::move(first)) + cut(std::move(second));
      if (!fits || cut_texels <= kSaves * texels)
        return cut_texels;
      pieces_.resize(count);
    }
    pieces_.push_back(std::move(whole));
    return texels;
  }

  using Halves = std::pair<std::vector<std::uint32_t>, std::vector<std::uint32_t>>;

  /// By the middles of the triangles, across the longer side.
  Halves halves(const Piece& whole) const {
    const double middle = whole.plane.low_x + whole.plane.width / 2;
    Halves result;
    for (const std::uint32_t t : whole.triangles) {
      const Vec3d at = (position(t, 0) + position(t, 1) + position(t, 2)) * (1.0 / 3);
      (dot(at, whole.plane.x) < middle ? result.first : result.second).push_back(t);
    }
    return result;
  }

  /// Appends the piece without the triangles that leave it, then the pieces that these make.
  void uncover(Piece whole, int round) {
    const std::vector<std::uint32_t> leaving = find_leaving(whole);
    if (leaving.empty()) {
      pieces_.push_back(std::move(whole));
      return;
    }
    std::erase_if(whole.triangles, [&](std::uint32_t t) { return leaves_[t]; });
    const std::vector<std::vector<std::uint32_t>> groups = connected(leaving, round + 1 < kRounds);
    for (const std::uint32_t t : leaving)
      leaves_[t] = false;
    if (!whole.triangles.empty())
      pieces_.push_back(piece(std::move(whole.triangles)));
    for (const std::vector<std::uint32_t>& group : groups)
      uncover(piece(group), round + 1);
  }

  /// Marks them as well.
  std::vector<std::uint32_t> find_leaving(const Piece& whole) {
    constexpr double kMostSide = 4096;
    const double longest = std::max(whole.plane.width, whole.plane.height);
    const double scale = longest * density_ > kMostSide ? kMostSide / longest : density_;
    const auto width = static_cast<std::uint32_t>(whole.plane.width * scale) + 2;
    const auto height = static_cast<std::uint32_t>(whole.plane.height * scale) + 2;
    is_covered_.assign(std::size_t{width} * height, 0);
    std::vector<std::uint32_t> leaving;
    for (const std::uint32_t t : whole.triangles) {
      if (whole.triangles.size() == 1)
        break;
      bool leaves = faces_.areas[t] > 0 && dot(faces_.normals[t], whole.plane.normal) < kLeastSeen;
      std::array<TexelPoint, 3> at;
      for (std::size_t k = 0; k < 3; ++k)
        at[k] = {(dot(position(t, k), whole.plane.x) - whole.plane.low_x) * scale + 0.5,
                 (dot(position(t, k), whole.plane.y) - whole.plane.low_y) * scale + 0.5};
      const RasterTriangle raster(at);
      const auto texel = [&](std::uint32_t x, std::uint32_t y) -> char& {
        return is_covered_[std::size_t{y} * width + x];
      };
      if (!leaves)
        raster.for_each(width, height, [&](std::uint32_t x, std::uint32_t y, double, double) {
          leaves = leaves || texel(x, y) != 0;
        });
      if (!leaves)
        raster.for_each(width, height,
                        [&](std::uint32_t x, std::uint32_t y, double, double) { texel(x, y) = 1; });
      if (leaves)
        leaving.push_back(t);
      leaves_[t] = leaves;
    }
    return leaving;
  }

  /// Groups of marked triangles that share edges; each alone if they must not be together.
  std::vector<std::vector<std::uint32_t>> connected(const std::vector<std::uint32_t>& marked,
                                                    bool together) {
    std::vector<std::vector<std::uint32_t>> groups;
    std::vector<bool>& is_open = leaves_;
    for (const std::uint32_t first : marked) {
      if (!is_open[first])
        continue;
      is_open[first] = false;
      std::vector<std::uint32_t>& group = groups.emplace_back(1, first);
      for (std::size_t i = 0; together && i < group.size(); ++i) {
        for (const std::uint32_t other : faces_.across[group[i]]) {
          if (other != kNoFace && is_open[other]) {
            is_open[other] = false;
            group.push_back(other);
          }
        }
      }
    }
    return groups;
  }

  std::span<const Vec3f> positions_;
  std::span<const TileTriangle> triangles_;
  const Faces& faces_;
  std::vector<bool> leaves_;
  std::uint32_t side_;
  double density_ = 1;
  std::vector<char> is_covered_;
  std::vector<Piece> pieces_;
  PlaneCharts result_;
};

}  // namespace

PlaneCharts refined(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles,
                    const Faces& faces, const SurfaceCharts& charts, std::uint32_t side) {
  return Refiner(positions, triangles, faces, side)(charts);
}

}  // namespace meshhier::texture
