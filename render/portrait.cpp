#include "render/portrait.h"

#include "base/angle.h"
#include "base/bounds.h"
#include "render/distinct_places.h"
#include "render/raster.h"
#include "render/space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

namespace meshhier::render {
namespace {

constexpr double kFullTurn = 6.283185307179586;

/// From this on a surface is open: its area faces one side by so much. Of closed ones it is 0.
constexpr double kOpen = 0.4;
/// The cosine of how far from `up` it may face and is ground: 40 degrees.
constexpr double kUpright = 0.77;

/// Candidates: around the model, and degrees above its equator.
constexpr int kAround = 16;
constexpr std::array kElevations{13.0, 26.0};
constexpr std::array kFromAbove{37.0};  // roofs and streets are seen
constexpr Standpoint kMapView{0, 90};
/// Points hide nothing: they are seen from the front, a little aside and above.
constexpr Standpoint kPointView{30, 20};
/// Where a surface faces is told as a multiple of this, degrees.
constexpr double kAngleStep = 0.25;
/// A surface that hides nothing of itself from above, whatever its height.
constexpr double kMap = 0.8;
/// A surface that is open above and lower than this part of its width is a map.
constexpr double kFlat = 0.15;
/// How much more than the back the front counts.
constexpr double kFrontFavour = 0.05;
/// Their pictures' side. What is smaller than a pixel of it is no form but roughness.
constexpr std::uint32_t kTrialPixels = 80;

/// The facet's normal; its length is twice the area.
Vec3d area_of(const Facet& facet) {
  const Vec3d a = to_double(facet[0].position);
  return cross(to_double(facet[1].position) - a, to_double(facet[2].position) - a);
}

/// Where the surface faces, as a part of its area; none if it has no area.
std::optional<Vec3d> facing_of(std::span<const Facet> facets) {
  Vec3d sum;
  double area = 0;
  for (const Facet& facet : facets) {
    const Vec3d twice = area_of(facet);
    if (!is_finite(twice))
      continue;
    sum = sum + twice;
    area += length(twice);
  }
  return area > 0 ? std::optional(sum * (1 / area)) : std::nullopt;
}

/// Two axes that are level, as `up` has it: the second is the first one, turned left.
struct Level2d {
  Vec3d first, second;
};

/// From above a map has its x to the right: the second axis points up in the picture.
Level2d level_axes(Vec3d up) {
  const Vec3d x = std::abs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d first = unit(x - up * dot(x, up));
  return {first, cross(up, first)};
}

void add_seen(BoundsD& box, Vec3f place, const ViewAxes& axes) {
  const Vec3d p = to_double(place);
  if (is_finite(p))
    box.add(Vec3d{dot(axes.right, p), dot(axes.up, p), dot(axes.back, p)});
}

/// By a view's axes. Empty if no corner is finite.
BoundsD seen_box(std::span<const Facet> facets, const ViewAxes& axes) {
  BoundsD box;
  for (const Facet& facet : facets) {
    for (const FacetCorner& corner : facet)
      add_seen(box, corner.position, axes);
  }
  return box;
}

BoundsD seen_box(std::span<const Vec3f> places, const ViewAxes& axes) {
  BoundsD box;
  for (const Vec3f& place : places)
    add_seen(box, place, axes);
  return box;
}

/// Shows what takes that box of the view, as large as the frame takes it.
Camera camera_on(const BoundsD& seen, const View& view, const ViewAxes& axes,
                 const Framing& framing) {
  if (seen.empty())
    return {view, Vec3d{}, 1, framing};
  const Vec3d middle = (seen.min + seen.max) * 0.5;
  const Vec3d size = seen.max - seen.min;
  const double free = 1 - 2 * framing.margin;
  const double pixel = std::max(size.x / (framing.width * free), size.y / (framing.height * free));
  const Vec3d centre = axes.right * middle.x + axes.up * middle.y + axes.back * middle.z;
  return {view, centre, pixel > 0 ? pixel : 1, framing};
}

/// How high the facets reach, as a part of how wide they do. Requires finite ones.
double height_of(std::span<const Facet> facets, Vec3d up) {
  const auto [first, second] = level_axes(up);
  const BoundsD box = seen_box(facets, {first, up, second});
  const Vec3d size = box.max - box.min;
  return size.y / std::max({size.x, size.z, std::numeric_limits<double>::min()});
}

/// Rates how much of a model's form a picture shows: above all where the surface turns sharply, as
/// a face does and the back of a head does not; then how far it turns in all, and where one part
/// stands before another (decision 031).
double form_in(const Raster& raster) {
  const auto samples = raster.samples();
  const std::size_t columns = raster.columns();
  // The least depth step that stands out, in pixels; what turns further counts no more.
  constexpr double kDepthStep = 3, kMostTurn = 0.7;
  constexpr double kTurnInAll = 0.1, kBefore = 0.05;
  const auto pair = [&](const Sample& a, const Sample& b) {
    if (!a.covered() || !b.covered())
      return 0.0;
    if (std::abs(double{a.depth} - b.depth) > kDepthStep)
      return kBefore;
    const double turn = std::max(1 - dot(to_double(a.normal), to_double(b.normal)), 0.0);
    return std::min(kMostTurn, turn) + kTurnInAll * std::sqrt(2 * turn);
  };
  double form = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % columns + 1 < columns)
      form += pair(samples[i], samples[i + 1]);
    if (i + columns < samples.size())
      form += pair(samples[i], samples[i + columns]);
  }
  return form;
}

/// Favours the front: a model's face is where glTF's +z is, or where y is least if z is up, more
/// often than not.
double favour(const View& view, Vec3d front) {
  return 1 + kFrontFavour * dot(view.direction, front * -1);
}

class BestView {
 public:
  BestView(std::span<const Facet> facets, Vec3d up)
      : facets_(facets),
        distinct_(distinct_places(facets)),
        up_(up),
        front_(level_axes(up).second * -1) {}

  void consider(const Standpoint& from) {
    const View view = view_from(from, up_);
    const ViewAxes axes = axes_of(view);
    Raster raster(camera_on(seen_box(distinct_.places, axes), view, axes,
                            {.width = kTrialPixels, .height = kTrialPixels, .samples = 1}));
    raster.draw(facets_, distinct_);
    const double worth = form_in(raster) * favour(view, front_);
    if (worth > most_) {
      most_ = worth;
      best_ = from;
    }
  }

  const Standpoint& found() const { return best_; }

 private:
  std::span<const Facet> facets_;
  DistinctPlaces distinct_;
  Vec3d up_, front_;
  double most_ = -1;
  Standpoint best_;
};

/// How far around shows more than how far above: that is tried from where it is best.
Standpoint best_view(std::span<const Facet> facets, Vec3d up, std::span<const double> elevations) {
  BestView best(facets, up);
  for (int i = 0; i < kAround; ++i)
    best.consider({360 * (i + 0.5) / kAround, elevations[0]});
  for (const double elevation : elevations.subspan(1))
    best.consider({best.found().azimuth, elevation});
  return best.found();
}

double in_steps(double radians) {
  return std::floor(radians / kFullTurn * 360 / kAngleStep + 0.5) * kAngleStep;
}

/// From where a surface is seen that faces there.
Standpoint facing(Vec3d direction, Vec3d up) {
  const auto [right, behind] = level_axes(up);
  const double x = dot(direction, right), front = -dot(direction, behind), y = dot(direction, up);
  const double azimuth = in_steps(angle_of(front, std::abs(x)));
  const double elevation = in_steps(angle_of(std::sqrt(x * x + front * front), std::abs(y)));
  return {x < 0 && azimuth > 0 ? 360 - azimuth : azimuth, y < 0 ? -elevation : elevation};
}

}  // namespace

Standpoint portrait_from(std::span<const Facet> facets, Vec3d up) {
  const Vec3d upward = unit(up);
  const std::optional<Vec3d> faces = facing_of(facets);
  if (!faces)
    return facets.empty() || height_of(facets, upward) > kFlat ? kPointView : kMapView;
  if (length(*faces) <= kOpen)
    return best_view(facets, upward, kElevations);
  if (dot(unit(*faces), upward) <= kUpright)
    return facing(unit(*faces), upward);
  if (length(*faces) < kMap && height_of(facets, upward) > kFlat)
    return best_view(facets, upward, kFromAbove);
  return kMapView;
}

View view_from(const Standpoint& from, Vec3d up) {
  const Vec3d upward = unit(up);
  const auto [right, behind] = level_axes(upward);
  const UnitTurn around = turn_by(from.azimuth / 360 * kFullTurn);
  const UnitTurn raised = turn_by(from.elevation / 360 * kFullTurn);
  const Vec3d level = right * around.sine - behind * around.cosine;
  return {(level * raised.cosine + upward * raised.sine) * -1,
          upward * raised.cosine - level * raised.sine};
}

Camera portrait_camera(std::span<const Facet> facets, const View& view, const Framing& framing) {
  const ViewAxes axes = axes_of(view);
  return camera_on(seen_box(facets, axes), view, axes, framing);
}

}  // namespace meshhier::render
