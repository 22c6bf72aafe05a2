#include "inspection/clip_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

namespace meshhier::inspection {
namespace {

constexpr std::size_t kNewVertex = std::numeric_limits<std::size_t>::max();

/// All that a vertex has. A hundred bytes: polygons are small.
struct ClippedCorner {
  std::size_t vertex = kNewVertex;  ///< of the part
  Vec3f position;
  std::array<float, kMaxChannels> attributes{};
  Vec3f normal;
  Vec2f texcoord;
};

auto key_of(const ClippedCorner& c) {
  return std::tie(c.position.x, c.position.y, c.position.z, c.attributes, c.normal.x, c.normal.y,
                  c.normal.z, c.texcoord.u, c.texcoord.v);
}

float between(float a, float b, double t) {
  return static_cast<float>(a + (double{b} - a) * t);
}

Vec3f between(Vec3f a, Vec3f b, double t) {
  return {between(a.x, b.x, t), between(a.y, b.y, t), between(a.z, b.z, t)};
}

Vec3f unit(Vec3f v, Vec3f otherwise) {
  const Vec3d wide = to_double(v);
  const double size = length(wide);
  return size > 0 ? to_float(wide * (1 / size)) : otherwise;
}

/// On the side of a box exactly.
Vec3f on_side(Vec3f p, const HalfSpace& half) {
  const Vec3d& n = half.normal;
  const auto is_axis = [](double a, double b, double c) {
    return std::abs(a) == 1 && b == 0 && c == 0;
  };
  if (is_axis(n.x, n.y, n.z))
    p.x = static_cast<float>(n.x * half.offset);
  else if (is_axis(n.y, n.x, n.z))
    p.y = static_cast<float>(n.y * half.offset);
  else if (is_axis(n.z, n.x, n.y))
    p.z = static_cast<float>(n.z * half.offset);
  return p;
}

class PartClipper {
 public:
  PartClipper(const CutPart& part, const AttributeLayout& layout, const ConvexRegion& region,
              Clipping clipping)
      : part_(part),
        layout_(layout),
        region_(region),
        clipping_(clipping),
        light_(layout),
        channels_(static_cast<std::size_t>(part.vertices.channels)),
        numbers_(part.vertices.size(), kNoPlace) {}

  CutPart run() {
    std::vector<std::vector<ClippedCorner>> kept;
    for (const auto& triangle : part_.triangles) {
      std::vector<ClippedCorner> polygon = clipped(triangle);
      if (polygon.size() < 3)
        continue;
      if (clipping_ == Clipping::whole_triangles)
        polygon = corners_of(triangle);
      for (const ClippedCorner& corner : polygon)
        use(corner);
      kept.push_back(std::move(polygon));
    }
    begin();
    for (const std::vector<ClippedCorner>& polygon : kept)
      add(polygon);
    if (!made_.triangles.empty())
      made_.image = part_.image;
    return std::move(made_);
  }

 private:
  std::vector<ClippedCorner> corners_of(const Triangle<std::uint32_t>& triangle) const {
    std::vector<ClippedCorner> corners;
    for (const std::uint32_t vertex : triangle) {
      ClippedCorner& corner = corners.emplace_back();
      corner.vertex = vertex;
      corner.position = part_.vertices.positions[vertex];
      std::ranges::copy(part_.vertices.attributes_of(vertex), corner.attributes.begin());
      if (!part_.normals.empty())
        corner.normal = part_.normals[vertex];
      if (!part_.texcoords.empty())
        corner.texcoord = part_.texcoords[vertex];
    }
    return corners;
  }

  /// Sutherland & Hodgman, Reentrant Polygon Clipping (1974).
  std::vector<ClippedCorner> clipped(const Triangle<std::uint32_t>& triangle) const {
    std::vector<ClippedCorner> polygon = corners_of(triangle), next;
    for (const HalfSpace& half : region_.half_spaces()) {
      next.clear();
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const ClippedCorner& from = polygon[i];
        const ClippedCorner& to = polygon[(i + 1) % polygon.size()];
        const double a = half.beyond(to_double(from.position));
        const double b = half.beyond(to_double(to.position));
        if (a <= 0)
          next.push_back(from);
        if ((a < 0 && b > 0) || (a > 0 && b < 0))
          next.push_back(cut(from, to, half));
      }
      std::swap(polygon, next);
    }
    return polygon;
  }

  /// The same from both sides: from the lesser end.
  ClippedCorner cut(const ClippedCorner& one, const ClippedCorner& other,
                    const HalfSpace& half) const {
    const bool in_order = key_of(one) < key_of(other);
    const ClippedCorner& from = in_order ? one : other;
    const ClippedCorner& to = in_order ? other : one;
    const double a = half.beyond(to_double(from.position)), b = half.beyond(to_double(to.position));
    const double t = a / (a - b);
    ClippedCorner made;
    made.position = on_side(between(from.position, to.position, t), half);
    mix_attributes(from, to, t, made);
    made.normal = unit(between(from.normal, to.normal, t), from.normal);
    made.texcoord = {between(from.texcoord.u, to.texcoord.u, t),
                     between(from.texcoord.v, to.texcoord.v, t)};
    return made;
  }

  /// Colours by their light.
  void mix_attributes(const ClippedCorner& from, const ClippedCorner& to, double t,
                      ClippedCorner& made) const {
    for (std::size_t c = 0; c < channels_; ++c) {
      const float a = from.attributes[c], b = to.attributes[c];
      made.attributes[c] = light_.has(c)
                               ? static_cast<float>(light_.number(
                                     light_.light(a) + (light_.light(b) - light_.light(a)) * t))
                               : between(a, b, t);
    }
    normalize_average(layout_, std::span(made.attributes).first(channels_));
    if (layout_.colour == ColourType::none || layout_.colour == ColourType::f32)
      return;
    const auto colour = std::span(made.attributes)
                            .subspan(static_cast<std::size_t>(layout_.colour_offset()),
                                     static_cast<std::size_t>(layout_.colour_channels()));
    std::ranges::transform(colour, colour.begin(), [](float x) { return std::round(x); });
  }

  void use(const ClippedCorner& corner) {
    if (corner.vertex != kNewVertex)
      numbers_[corner.vertex] = 0;
  }

  /// The vertices of the part that are used.
  void begin() {
    made_.vertices.channels = part_.vertices.channels;
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < numbers_.size(); ++v) {
      if (numbers_[v] == kNoPlace)
        continue;
      numbers_[v] = count++;
      made_.vertices.append(part_.vertices.positions[v], part_.vertices.attributes_of(v));
      made_.places.push_back(part_.places[v]);
      if (!part_.normals.empty())
        made_.normals.push_back(part_.normals[v]);
      if (!part_.texcoords.empty())
        made_.texcoords.push_back(part_.texcoords[v]);
    }
  }

  void add(const std::vector<ClippedCorner>& polygon) {
    std::vector<std::uint32_t> numbers;
    for (const ClippedCorner& corner : polygon)
      numbers.push_back(corner.vertex == kNewVertex ? number_of(corner) : numbers_[corner.vertex]);
    for (std::size_t i = 1; i + 1 < numbers.size(); ++i) {
      const Triangle<std::uint32_t> t{numbers[0], numbers[i], numbers[i + 1]};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
        made_.triangles.push_back(t);
    }
  }

  std::uint32_t number_of(const ClippedCorner& corner) {
    std::string key(sizeof(corner.position) + sizeof(corner.attributes) + sizeof(corner.normal) +
                        sizeof(corner.texcoord),
                    '\0');
    char* to = key.data();
    const auto put = [&](const auto& value) {
      std::memcpy(to, &value, sizeof(value));
      to += sizeof(value);
    };
    put(corner.position);
    put(corner.attributes);
    put(corner.normal);
    put(corner.texcoord);
    const auto next = static_cast<std::uint32_t>(made_.vertices.size());
    const auto [place, is_new] = cuts_.try_emplace(std::move(key), next);
    if (is_new) {
      made_.vertices.append(corner.position, std::span(corner.attributes).first(channels_));
      made_.places.push_back(kNoPlace);
      if (!part_.normals.empty())
        made_.normals.push_back(corner.normal);
      if (!part_.texcoords.empty())
        made_.texcoords.push_back(corner.texcoord);
    }
    return place->second;
  }

  const CutPart& part_;
  const AttributeLayout& layout_;
  const ConvexRegion& region_;
  Clipping clipping_;
  ColourLight light_;
  std::size_t channels_;
  std::vector<std::uint32_t> numbers_;  ///< of the part's vertices; kNoPlace: not used
  std::unordered_map<std::string, std::uint32_t> cuts_;
  CutPart made_;
};

}  // namespace

CutPart clip_part(const CutPart& part, const AttributeLayout& layout, const ConvexRegion& region,
                  Clipping clipping) {
  return PartClipper(part, layout, region, clipping).run();
}

}  // namespace meshhier::inspection
