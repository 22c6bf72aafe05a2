#include "texture/chart_refining.h"

#include "texture/chart_overlap.h"
#include "texture/chart_projection.h"
#include "texture/texel_raster.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
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
/// The texels of a cut that does not pay, and the most that one may have which must be.
constexpr double kNoCut = std::numeric_limits<double>::infinity();
constexpr double kAnyCut = std::numeric_limits<double>::max();
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
        project_(positions, triangles, faces),
        vertices_(positions.size(), triangles),
        find_overlap_(triangles, faces),
        places_(positions.size()),
        is_second_(triangles.size()),
        leaves_(triangles.size()),
        side_(side) {
    middles_.reserve(triangles.size());
    for (const TileTriangle& t : triangles)
      middles_.push_back((position(t[0]) + position(t[1]) + position(t[2])) * (1.0 / 3));
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

  Piece piece(std::vector<std::uint32_t> triangles) {
    const ChartPlane plane = project_(triangles);
    return {std::move(triangles), plane};
  }
  Vec3d position(TileVertex vertex) const { return to_double(positions_[raw(vertex)]); }
  /// The texels of a chart's rectangle, gutter and all.
  double texels_of(const ChartPlane& plane) const {
    const double width = plane.width * density_ + 2 * kBakeGutter;
    const double height = plane.height * density_ + 2 * kBakeGutter;
    return (width + kBakeAlignment / 2.0) * (height + kBakeAlignment / 2.0);
  }
  /// Returns how few texels pieces may have that cover so many, if none covers itself: a square's.
  static double least_texels(double covered) {
    constexpr double kAround = 2 * kBakeGutter + kBakeAlignment / 2.0;
    const double side = std::sqrt(covered) + kAround;
    return side * side;
  }

  /// Appends its pieces, and returns their texels.
  double cut(std::vector<std::uint32_t> triangles) {
    Piece whole = piece(std::move(triangles));
    const double texels = texels_of(whole.plane);
    const bool fits = texels <= kLargest / kUsual * double(side_) * side_;
    const double most = fits ? kSaves * texels : kAnyCut;
    const std::size_t count = pieces_.size();
    const double cut_texels = cut_in_two(whole, texels, most);
    if (cut_texels <= most)
      return cut_texels;
    pieces_.resize(count);
    pieces_.push_back(std::move(whole));
    return texels;
  }

  /// Appends the pieces of both halves, and returns their texels; infinity if a cut does not pay:
  /// it leaves more than `most`, or nothing on one side.
  double cut_in_two(const Piece& whole, double texels, double most) {
    if (whole.triangles.size() < kFewest)
      return kNoCut;
    const std::array<double, 2> covered = choose_halves(whole);
    if (covered[0] + covered[1] >= kFullEnough * texels ||
        least_texels(covered[0]) + least_texels(covered[1]) > most)
      return kNoCut;
    auto [first, second] = halves(whole);
    if (first.empty() || second.empty())
      return kNoCut;
    const double texels_of_first = cut(std::move(first));
    if (texels_of_first + least_texels(covered[1]) > most)
      return kNoCut;
    return texels_of_first + cut(std::move(second));
  }

  using Halves = std::pair<std::vector<std::uint32_t>, std::vector<std::uint32_t>>;

  Halves halves(const Piece& whole) const {
    const std::size_t count = whole.triangles.size();
    Halves result{std::vector<std::uint32_t>(count), std::vector<std::uint32_t>(count)};
    std::size_t first = 0, second = 0;
    for (const std::uint32_t t : whole.triangles) {  // into both: without a branch
      result.first[first] = result.second[second] = t;
      first += is_second_[t] == 0 ? 1 : 0;
      second += is_second_[t] != 0 ? 1 : 0;
    }
    result.first.resize(first);
    result.second.resize(second);
    return result;
  }

  /// Chooses sides by the middles of the triangles, across the longer side. Returns the texels that
  /// those of each side cover.
  std::array<double, 2> choose_halves(const Piece& whole) {
    const double middle = whole.plane.low_x + whole.plane.width / 2;
    std::array<double, 2> covered{};
    for (const std::uint32_t t : whole.triangles) {
      is_second_[t] = dot(middles_[t], whole.plane.x) < middle ? 0 : 1;
      covered[is_second_[t] != 0 ? 1 : 0] +=
          faces_.areas[t] * std::max(dot(faces_.normals[t], whole.plane.normal), 0.0);
    }
    return {covered[0] * density_ * density_, covered[1] * density_ * density_};
  }

  /// Appends the piece without the triangles that leave it, then the pieces that these make.
  void uncover(Piece whole, int round) {
    const std::vector<std::uint32_t> leaving = find_leaving(whole);
    if (leaving.empty()) {
      pieces_.push_back(std::move(whole));
      return;
    }
    std::erase_if(whole.triangles, [&](std::uint32_t t) { return leaves_[t] != 0; });
    const std::vector<std::vector<std::uint32_t>> groups = connected(leaving, round + 1 < kRounds);
    for (const std::uint32_t t : leaving)
      leaves_[t] = 0;
    if (!whole.triangles.empty())
      pieces_.push_back(piece(std::move(whole.triangles)));
    for (const std::vector<std::uint32_t>& group : groups)
      uncover(piece(group), round + 1);
  }

  /// Marks them as well.
  std::vector<std::uint32_t> find_leaving(const Piece& whole) {
    if (whole.triangles.size() == 1)
      return {};
    const TexelRange all = place(whole);
    std::vector<std::uint32_t> staying, leaving;
    staying.reserve(whole.triangles.size());
    for (const std::uint32_t t : whole.triangles) {
      leaves_[t] =
          faces_.areas[t] > 0 && dot(faces_.normals[t], whole.plane.normal) < kLeastSeen ? 1 : 0;
      if (leaves_[t] == 0)
        staying.push_back(t);
    }
    if (const TexelRange range = find_overlap_(staying, places_, all); range.left < range.right)
      leave_covered(staying, range);
    if (std::ranges::any_of(whole.triangles, [&](std::uint32_t t) { return leaves_[t] != 0; }))
      std::ranges::copy_if(whole.triangles, std::back_inserter(leaving),
                           [&](std::uint32_t t) { return leaves_[t] != 0; });
    return leaving;
  }

  /// Finds the places of a piece's vertices, and returns the texels that it has.
  TexelRange place(const Piece& whole) {
    constexpr double kMostSide = 4096;
    const ChartPlane& plane = whole.plane;
    const double longest = std::max(plane.width, plane.height);
    const double scale = longest * density_ > kMostSide ? kMostSide / longest : density_;
    for (const std::uint32_t v : vertices_.of(whole.triangles)) {
      const Vec3d at = to_double(positions_[v]);
      places_[v] = FixedTexelPoint::of({(dot(at, plane.x) - plane.low_x) * scale + 0.5,
                                        (dot(at, plane.y) - plane.low_y) * scale + 0.5});
    }
    return {0, 0, static_cast<std::uint32_t>(plane.width * scale) + 2,
            static_cast<std::uint32_t>(plane.height * scale) + 2};
  }

  /// Marks the triangles that cover texels of the range which others before them cover.
  void leave_covered(std::span<const std::uint32_t> triangles, const TexelRange& range) {
    const std::size_t width = range.right - range.left;
    is_covered_.assign(width * (range.bottom - range.top), 0);
    for (const std::uint32_t t : triangles) {
      const TileTriangle& corners = triangles_[t];
      const RasterTriangle raster(
          std::array{places_[raw(corners[0])], places_[raw(corners[1])], places_[raw(corners[2])]});
      const auto each_row = [&](const auto& visit) {
        raster.for_each_span(range, [&](std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
          visit(is_covered_.begin() +
                    static_cast<std::ptrdiff_t>((y - range.top) * width + begin - range.left),
                end - begin);
        });
      };
      each_row([&](auto row, std::uint32_t count) {
        if (std::any_of(row, row + count, [](char is_covered) { return is_covered != 0; }))
          leaves_[t] = 1;
      });
      if (leaves_[t] == 0)
        each_row([&](auto row, std::uint32_t count) { std::fill_n(row, count, 1); });
    }
  }

  /// Groups of marked triangles that share edges; each alone if they must not be together.
  std::vector<std::vector<std::uint32_t>> connected(const std::vector<std::uint32_t>& marked,
                                                    bool together) {
    std::vector<std::vector<std::uint32_t>> groups;
    std::vector<char>& is_open = leaves_;
    for (const std::uint32_t first : marked) {
      if (is_open[first] == 0)
        continue;
      is_open[first] = 0;
      std::vector<std::uint32_t>& group = groups.emplace_back(1, first);
      for (std::size_t i = 0; together && i < group.size(); ++i) {
        for (const std::uint32_t other : faces_.across[group[i]]) {
          if (other != kNoFace && is_open[other] != 0) {
            is_open[other] = 0;
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
  ChartProjector project_;
  ChartVertices vertices_;
  ChartOverlap find_overlap_;
  std::vector<Vec3d> middles_;           ///< of triangles
  std::vector<FixedTexelPoint> places_;  ///< of a piece's vertices
  std::vector<char> is_second_;          ///< which half of a piece triangles are of
  std::vector<char> leaves_;
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
