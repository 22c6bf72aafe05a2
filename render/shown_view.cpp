#include "render/shown_view.h"

#include "base/named_value.h"
#include "base/number_text.h"
#include "base/srgb.h"
#include "render/interior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

namespace meshhier::render {
namespace {

constexpr std::array kRigs{
    NamedValue{"studio", RigName::studio}, NamedValue{"raking", RigName::raking},
    NamedValue{"flat", RigName::flat},     NamedValue{"sun", RigName::sun},
    NamedValue{"relief", RigName::studio}, NamedValue{"matcap", RigName::studio}};

Vec3d triple(std::span<const double> numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

std::string_view name_of_light(const ModelView& view) {
  return std::string_view(view.light).substr(0, view.light.find(','));
}

/// The angles behind a light's name: "sun,0.5,1".
std::optional<LightAngles> key_of(const ModelView& view) {
  const std::string& text = view.light;
  const std::size_t first = text.find(',');
  if (first == std::string::npos)
    return std::nullopt;
  const auto angles = parse_numbers(std::string_view(text).substr(first + 1));
  return angles && angles->size() == 2 ? std::optional(LightAngles{(*angles)[0], (*angles)[1]})
                                       : std::nullopt;
}

/// A colour of that hue, saturation and lightness (HSL), 0 to 1 each, as light.
Vec3f light_of_hue(double hue, double saturation, double lightness) {
  const double spread = saturation * std::min(lightness, 1 - lightness);
  const auto part = [&](double turn) {
    const double k = std::fmod(turn + hue * 12, 12);
    const double value = lightness - spread * std::max(-1.0, std::min({k - 3, 9 - k, 1.0}));
    return static_cast<float>(light_of(value));
  };
  return {part(0), part(8), part(4)};
}

/// The light that each tile has in place of its colours, if colours show the partition.
Vec3f partition_colour(NodeId node) {
  constexpr double kGolden = 0.618034;  // colours of neighbours lie far apart
  return light_of_hue(std::fmod(node.index * kGolden + raw(node.level) * 0.13, 1), 0.55, 0.6);
}

/// A floor at `from` is drawn whole, a ceiling at `to` not at all, however their heights are
/// rounded.
void add_storey(double from, double to, Vec3d upwards, double origin,
                std::vector<HalfSpace>& kept) {
  constexpr double kHair = 1e-3;  // part of the range that both cuts are lower than its ends
  const double hair = kHair * (to - from);
  kept.push_back({upwards * -1, origin - from + hair});
  kept.push_back({upwards, to - hair - origin});
}

}  // namespace

Standing standing_of(const ModelView& view, UpAxis of_file) {
  return {view.up, of_file, view.stretch.value_or(1)};
}

std::optional<Pose> pose_of(const ModelView& view) {
  if (view.camera.size() != 6)
    return std::nullopt;
  const std::span<const double> numbers(view.camera);
  return Pose{triple(numbers.first(3)), triple(numbers.last(3))};
}

std::vector<HalfSpace> kept_of(const ModelView& view, Vec3d upwards, Vec3d origin) {
  std::vector<HalfSpace> kept;
  if (view.cut.size() == 4) {
    const Vec3d normal = triple(view.cut);
    kept.push_back({normal * -1, view.cut[3] + dot(normal, origin)});
  } else if (view.box.size() == 6) {
    const std::span<const double> numbers(view.box);
    const auto sides = half_spaces_of(
        BoundsD{triple(numbers.first(3)) - origin, triple(numbers.last(3)) - origin});
    kept.assign(sides.begin(), sides.end());
  }
  if (view.storey.size() == 2)
    add_storey(view.storey[0], view.storey[1], upwards, dot(upwards, origin), kept);
  return kept;
}

Rays rays_of(const ModelView& view) {
  return view.projection == "parallel" ? Rays::parallel : Rays::meet_in_the_eye;
}

bool looks_in(const ModelView& view, const TileMesh& root, Vec3d upwards) {
  return view.dollhouse == "auto" ? is_interior(root, upwards) : view.dollhouse == "on";
}

std::optional<AttributeColours> attribute_of(const ModelView& view, const SourceSummary& source) {
  const std::vector<ScalarAttribute>& all = source.attributes.values;
  if (view.colours != "attribute" || all.empty())
    return std::nullopt;
  const auto found = std::ranges::find(all, view.attribute, &ScalarAttribute::name);
  AttributeColours colours{found == all.end() ? all.front().name : view.attribute,
                           ramp_named(view.ramp)};
  if (view.range.size() == 2)
    colours.range = std::array{view.range[0], view.range[1]};
  colours.tolerance = view.tolerance;
  colours.hidden = view.hidden;
  return colours;
}

ModelView known_view(ModelView view, const SourceSummary& source) {
  if (view.colours == "attribute" && source.attributes.values.empty())
    view.colours = ModelView{}.colours;
  return view;
}

bool shows_own(const ModelView& view) {
  return view.colours == ModelView{}.colours;
}

void add_to_look(const ModelView& view, const PublishedTile& root, const Standing& standing,
                 Look& look) {
  look.up = UpAxis::y;
  look.terrain = terrain_of(root, standing.upwards());
  look.stretch = standing.stretch();
  look.rig = value_named(kRigs, name_of_light(view));
  look.key = key_of(view);
  look.is_flat = view.shading == "flat";
  look.has_cavities = view.cavities;
  look.has_pictures = look.has_pictures && view.texture && shows_own(view);
  look.takes_heights = shows_own(view);
  if (view.relight || !look.has_pictures)
    look.light = Light::lamps;
  if (view.colours == "height")
    look.heights = heights_of(root.mesh, look.terrain ? look.terrain->along : standing.upwards());
}

void paint(const ModelView& view, const std::optional<AttributePainter>& painter,
           PublishedTile& tile) {
  if (painter)
    painter->paint(tile);
  else if (!shows_own(view) || !view.texture)
    drop_pictures(tile);
}

void paint(const ModelView& view, const std::optional<AttributePainter>& painter, NodeId node,
           SceneTile& tile) {
  if (painter && !view.hidden.empty())
    drop_hidden(tile);
  if (painter || view.colours != "partition")
    return;
  for (Facet& facet : tile.facets) {
    for (FacetCorner& corner : facet)
      corner.colour = partition_colour(node);
  }
}

AttributeLayout painted_layout(const ModelView& view,
                               const std::optional<AttributePainter>& painter,
                               AttributeLayout layout) {
  if (painter)
    return painter->layout();
  if (!shows_own(view))
    layout.colour = ColourType::none;
  return layout;
}

std::vector<Facet> Placement::upright(std::span<const Facet> facets) const {
  SceneTile tile;
  tile.facets.assign(facets.begin(), facets.end());
  standing_.stand(tile);
  return std::move(tile.facets);
}

Sight Placement::look_from(const Pose& pose, Rays rays, const Framing& framing) {
  if (rays == Rays::parallel)
    return {parallel_camera(pose, framing), parallel_axes(pose)};
  perspective_.emplace(pose, framing);
  return {perspective_->camera(), perspective_->axes()};
}

void Placement::hide_backs(const Sight& sight) {
  viewer_ = perspective_ ? Viewer{perspective_->eye()} : Viewer{sight.axes.back, true};
}

void Placement::place(SceneTile& tile) const {
  clip(tile, kept_);
  standing_.stand(tile);
  if (viewer_)
    drop_backs(tile, *viewer_);
  if (perspective_)
    perspective_->project(tile);
}

Bounds Placement::box_of(const Bounds& box) const {
  if (box.empty())
    return box;
  const BoundsD upright = standing_.upright(BoundsD{to_double(box.min), to_double(box.max)});
  if (!perspective_)
    return {to_float(upright.min), to_float(upright.max)};
  return perspective_->sees(upright) ? perspective_->projected(upright) : Bounds{};
}

std::string not_drawn(const ModelView& view) {
  const std::string_view light = name_of_light(view);
  const bool is_cut = !view.cut.empty() || !view.box.empty();
  const std::array all{std::pair{view.wires, "wires"},
                       std::pair{view.points, "points"},
                       std::pair{view.outline, "the outline"},
                       std::pair{view.isolines && view.colours == "attribute", "isolines"},
                       std::pair{view.occlusion, "occlusion"},
                       std::pair{view.colours == "error", "the colours of errors"},
                       std::pair{light == "matcap" || light == "relief",
                                 "that light, for which it has the studio's"},
                       std::pair{is_cut && view.caps, "the caps of cuts"},
                       std::pair{!view.measure.empty(), "measured points"},
                       std::pair{!view.pick.empty(), "the picked point"},
                       std::pair{!view.object.empty(), "the mark of the picked object"}};
  std::string names;
  for (const auto& [is_there, name] : all) {
    if (is_there)
      names.append(names.empty() ? "" : ", ").append(name);
  }
  return names;
}

}  // namespace meshhier::render
