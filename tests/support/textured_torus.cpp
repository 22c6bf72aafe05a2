#include "tests/support/textured_torus.h"

#include "images/image_codec.h"

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ostream.h>

namespace meshhier::tests {
namespace {

constexpr std::uint32_t kPatchQuads = 8;
constexpr std::uint32_t kMargin = 4;
constexpr std::uint32_t kPictures = 2;
constexpr double kRadius = 3, kTube = 1;

/// `around` and `across` go from 0 to 1.
Vec3d torus_point(double around, double across) {
  const double a = 2 * std::numbers::pi * around;
  const double b = 2 * std::numbers::pi * across;
  const double r = kRadius + kTube * std::cos(b);
  return {r * std::cos(a), r * std::sin(a), kTube * std::sin(b)};
}

class TorusMaker {
 public:
  TorusMaker(std::uint32_t around, std::uint32_t across, std::uint32_t quad_texels)
      : around_(around), across_(across), texels_(quad_texels) {
    const std::uint32_t charts = around * across;
    columns_ = static_cast<std::uint32_t>(std::ceil(std::sqrt((charts + 1) / kPictures)));
    const std::uint32_t rows = (charts / kPictures + columns_) / columns_;
    for (std::uint32_t i = 0; i < kPictures; ++i)
      torus_.pictures.emplace_back(columns_ * cell(), rows * cell(), 3);
  }

  TexturedTorus operator()() && {
    for (std::uint32_t i = 0; i < around_; ++i) {
      for (std::uint32_t j = 0; j < across_; ++j)
        add_patch(i, j);
    }
    return std::move(torus_);
  }

 private:
  struct Patch {
    std::uint32_t i, j, picture, x, y;  // x, y: of its cell, texels
    bool turned;
  };

  std::uint32_t cell() const { return kPatchQuads * texels_ + 2 * kMargin; }

  /// `s`, `t`: in quads, from the corner of the patch; beyond it for the margin.
  Vec3d point(const Patch& patch, double s, double t) const {
    return torus_point((patch.i * kPatchQuads + s) / (around_ * kPatchQuads),
                       (patch.j * kPatchQuads + t) / (across_ * kPatchQuads));
  }

  void add_patch(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t number = i * across_ + j;
    const std::uint32_t place = number / kPictures;
    const Patch patch{i,
                      j,
                      number % kPictures,
                      place % columns_ * cell(),
                      place / columns_ * cell(),
                      number % 3 == 1};
    paint(patch);
    for (std::uint32_t s = 0; s < kPatchQuads; ++s) {
      for (std::uint32_t t = 0; t < kPatchQuads; ++t) {
        add_triangle(patch, {{{s, t}, {s + 1, t}, {s + 1, t + 1}}});
        add_triangle(patch, {{{s, t}, {s + 1, t + 1}, {s, t + 1}}});
      }
    }
  }

  void paint(const Patch& patch) {
    for (std::uint32_t y = 0; y < cell(); ++y) {
      for (std::uint32_t x = 0; x < cell(); ++x) {
        double s = (x + 0.5 - kMargin) / texels_;
        double t = (y + 0.5 - kMargin) / texels_;
        if (patch.turned)
          std::swap(s, t);
        const std::array<double, 3> colour = torus_colour(point(patch, s, t));
        std::uint8_t* texel = torus_.pictures[patch.picture].at(patch.x + x, patch.y + y);
        for (std::size_t c = 0; c < 3; ++c)
          texel[c] = static_cast<std::uint8_t>(std::lround(colour[c]));
      }
    }
  }

  void add_triangle(const Patch& patch,
                    const std::array<std::array<std::uint32_t, 2>, 3>& corners) {
    TexturedTriangle triangle;
    triangle.picture = patch.picture;
    const images::Image& picture = torus_.pictures[patch.picture];
    for (std::size_t k = 0; k < 3; ++k) {
      // One coordinate around the torus at its seam, so that places are one.
      const std::uint32_t s = (patch.i * kPatchQuads + corners[k][0]) % (around_ * kPatchQuads);
      const std::uint32_t t = (patch.j * kPatchQuads + corners[k][1]) % (across_ * kPatchQuads);
      triangle.corners[k].position =
          to_float(torus_point(static_cast<double>(s) / (around_ * kPatchQuads),
                               static_cast<double>(t) / (across_ * kPatchQuads)));
      const std::uint32_t x = kMargin + corners[k][patch.turned ? 1 : 0] * texels_;
      const std::uint32_t y = kMargin + corners[k][patch.turned ? 0 : 1] * texels_;
      triangle.corners[k].texcoord = {
          static_cast<float>((patch.x + x) / static_cast<double>(picture.width)),
          static_cast<float>((patch.y + y) / static_cast<double>(picture.height))};
    }
    torus_.triangles.push_back(triangle);
  }

  std::uint32_t around_, across_, texels_, columns_ = 0;
  TexturedTorus torus_;
};

void write_picture(const images::Image& picture, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = images::encode_image(picture, ImageFormat::png, 90);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

std::array<double, 3> torus_colour(Vec3d p) {
  return {128 + 90 * std::sin(2 * p.x), 128 + 80 * std::sin(2.5 * p.y + 1),
          128 + 100 * std::sin(3 * p.z + 0.5 * p.x)};
}

TexturedTorus make_textured_torus(std::uint32_t patches_around, std::uint32_t patches_across,
                                  std::uint32_t quad_texels) {
  return TorusMaker(patches_around, patches_across, quad_texels)();
}

std::filesystem::path write_obj(const TexturedTorus& torus,
                                const std::filesystem::path& directory) {
  std::ofstream mtl(directory / "torus.mtl");
  for (std::size_t i = 0; i < torus.pictures.size(); ++i) {
    write_picture(torus.pictures[i], directory / fmt::format("picture_{}.png", i));
    fmt::print(mtl, "newmtl skin_{0}\nmap_Kd picture_{0}.png\n", i);
  }
  std::ofstream obj(directory / "torus.obj");
  fmt::print(obj, "mtllib torus.mtl\n");
  std::map<std::tuple<float, float, float>, std::size_t> places;
  const auto place = [&](Vec3f p) {
    const auto [found, is_new] = places.try_emplace({p.x, p.y, p.z}, places.size() + 1);
    if (is_new)
      fmt::print(obj, "v {} {} {}\n", p.x, p.y, p.z);
    return found->second;
  };
  for (std::uint32_t picture = 0; picture < torus.pictures.size(); ++picture) {
    fmt::print(obj, "usemtl skin_{}\n", picture);
    for (const TexturedTriangle& triangle : torus.triangles) {
      if (triangle.picture != picture)
        continue;
      std::array<std::size_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = place(triangle.corners[k].position);
        const Vec2f at = triangle.corners[k].texcoord;
        fmt::print(obj, "vt {:.9} {:.9}\n", at.u, 1 - static_cast<double>(at.v));
      }
      fmt::print(obj, "f {}/-3 {}/-2 {}/-1\n", corners[0], corners[1], corners[2]);
    }
  }
  return directory / "torus.obj";
}

}  // namespace meshhier::tests
