#include "export/clip_part.h"

#include "export/clipped_corner.h"
#include "export/triangle_clipper.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace meshhier::exporting {
namespace {

class PartClipper {
 public:
  PartClipper(const CutPart& part, const AttributeRules& rules, const Region& region,
              Clipping clipping)
      : part_(part),
        region_(region),
        clipping_(clipping),
        channels_(static_cast<std::size_t>(part.vertices.channels)),
        mixer_(rules, channels_),
        clipper_(region, mixer_),
        numbers_(part.vertices.size(), kNoPlace) {}

  CutPart run() {
    std::vector<ClippedPolygon> kept;
    for (const auto& triangle : part_.triangles) {
      if (!region_.takes(part_.vertices.attributes_of(triangle[0])))
        continue;
      for (ClippedPolygon& piece : kept_of(corners_of(triangle))) {
        for (const ClippedCorner& corner : piece)
          use(corner);
        kept.push_back(std::move(piece));
      }
    }
    begin();
    for (const ClippedPolygon& polygon : kept)
      add(polygon);
    if (!made_.triangles.empty())
      made_.image = part_.image;
    return std::move(made_);
  }

 private:
  std::vector<ClippedPolygon> kept_of(ClippedPolygon triangle) const {
    if (clipping_ != Clipping::whole_triangles)
      return clipper_.pieces(std::move(triangle));
    std::vector<ClippedPolygon> whole;
    if (clipper_.touches(triangle))
      whole.push_back(std::move(triangle));
    return whole;
  }

  ClippedPolygon corners_of(const Triangle<std::uint32_t>& triangle) const {
    ClippedPolygon corners;
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

  void add(const ClippedPolygon& polygon) {
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
  const Region& region_;
  Clipping clipping_;
  std::size_t channels_;
  CornerMixer mixer_;
  TriangleClipper clipper_;
  std::vector<std::uint32_t> numbers_;  ///< new numbers of the part's vertices; kNoPlace: not used
  std::unordered_map<std::string, std::uint32_t> cuts_;
  CutPart made_;
};

}  // namespace

CutPart clip_part(const CutPart& part, const AttributeRules& rules, const Region& region,
                  Clipping clipping) {
  return PartClipper(part, rules, region, clipping).run();
}

}  // namespace meshhier::exporting
