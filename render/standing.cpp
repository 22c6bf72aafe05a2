#include "render/standing.h"

#include "base/named_value.h"

#include <array>

namespace meshhier::render {
namespace {

using Rows = std::array<Vec3d, 3>;

/// The turns that bring an axis to y.
constexpr std::array kTurns{NamedValue{"x", Rows{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}},
                            NamedValue{"y", Rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
                            NamedValue{"z", Rows{{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}}},
                            NamedValue{"-x", Rows{{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}},
                            NamedValue{"-y", Rows{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}},
                            NamedValue{"-z", Rows{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}}};

}  // namespace

Standing::Standing(std::string_view up, UpAxis of_file, double stretch)
    : rows_(
          value_named(kTurns, up)
              .value_or(*value_named(kTurns, std::string_view(of_file == UpAxis::z ? "z" : "y")))),
      stretch_(stretch) {}

BoundsD Standing::upright(const BoundsD& box) const {
  BoundsD all;
  for (unsigned corner = 0; corner < 8 && !box.empty(); ++corner) {
    all.add(upright(Vec3d{(corner & 1) != 0 ? box.max.x : box.min.x,
                          (corner & 2) != 0 ? box.max.y : box.min.y,
                          (corner & 4) != 0 ? box.max.z : box.min.z}));
  }
  return all;
}

Vec3f Standing::upright_normal(Vec3f normal) const {
  const Vec3d n = to_double(normal);
  return to_float({dot(rows_[0], n), dot(rows_[1], n) / stretch_, dot(rows_[2], n)});
}

void Standing::stand(SceneTile& tile) const {
  for (Facet& facet : tile.facets) {
    for (FacetCorner& corner : facet) {
      corner.position = to_float(upright(to_double(corner.position)));
      corner.normal = upright_normal(corner.normal);
    }
  }
  for (Skin& skin : tile.skins) {
    for (Vec3f& tangent : skin.tangents)
      tangent = to_float(upright(to_double(tangent)));
  }
}

}  // namespace meshhier::render
