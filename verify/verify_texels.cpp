// Triangles of both sides meet by a hash of their corners' positions, in an external sort; then
// they come tile by tile. Each texel of the input whose centre lies in a triangle is looked up
// where the tile has it.
#include "verify/verify_texels.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/srgb.h"
#include "hierarchy/drawing_rule.h"
#include "hierarchy/shown_corners.h"
#include "images/image_store.h"
#include "images/material_texels.h"
#include "import/mesh_input.h"
#include "import/open_picture.h"
#include "partition/external_sort.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

using images::Image;
using images::Material;

/// Root mean square of a channel's difference, of 255: that of a picture of something else is
/// larger, that of the same one smaller with any quality that is of use.
constexpr double kMostDifference = 25.5;
constexpr std::uint64_t kMostTexels = std::uint64_t{kMaxImageSide} * kMaxImageSide;
/// A triangle has no more of the input's texels on a side, or the tile shows it by fewer.
constexpr double kMostSide = kMaxImageSide;
/// Twice that of a triangle which has a texel's centre in it at most by chance, texels squared.
constexpr double kLeastArea = 1e-3;

struct TriangleKey {
  std::uint64_t a = 0, b = 0;
  friend auto operator<=>(const TriangleKey&, const TriangleKey&) = default;
};

/// Returns the index of the least corner.
std::size_t first_corner(const std::array<Vec3f, 3>& corners) {
  const auto flat = [&](std::size_t k) {
    return std::tuple(corners[k].x, corners[k].y, corners[k].z);
  };
  std::size_t first = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (flat(k) < flat(first))
      first = k;
  }
  return first;
}

TriangleKey key_of(const std::array<Vec3f, 3>& corners, std::size_t first) {
  std::array<Vec3f, 4> turned{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f p = corners[(first + k) % 3];
    turned[k] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // -0 is 0
  }
  TriangleKey key;
  key.a = storage::checksum(std::as_bytes(std::span(turned)));
  turned[3].x = 1;
  key.b = storage::checksum(std::as_bytes(std::span(turned)));
  return key;
}

constexpr std::uint32_t kOfInput = UINT32_MAX;

/// A triangle of the input, or one that a partition draws.
struct EitherTriangle {
  TriangleKey key;
  std::uint32_t tile = kOfInput;  ///< kOfInput: none
  std::uint32_t number = 0;       ///< the triangle's in its tile, or that of the input's material
  std::array<Vec2f, 3> texcoords{};  ///< from the least corner on
};
struct ByKey {
  auto operator()(const EitherTriangle& t) const { return std::pair(t.key.a, t.key.b); }
};

/// The picture that a triangle of a tile should show.
struct Expected {
  std::uint32_t tile = 0, triangle = 0;
  std::uint32_t material = 0;
  std::array<Vec2f, 3> source, shown;
};
struct ByTile {
  std::uint64_t operator()(const Expected& e) const {
    return std::uint64_t{e.tile} << 32 | e.triangle;
  }
};
using ExpectedSort = partition::ExternalSort<Expected, ByTile>;

/// Triangles as a partition shows them.
class TileTriangles {
 public:
  explicit TileTriangles(const PublishedTile& tile) : tile_(tile) {}

  std::array<Vec3f, 3> positions(const TileTriangle& triangle) const {
    return {position(raw(triangle[0])), position(raw(triangle[1])), position(raw(triangle[2]))};
  }
  Vec2f texcoord(TileVertex corner) const { return tile_.shading.texcoords[raw(corner)]; }

 private:
  Vec3f position(std::uint32_t v) const {
    const TileMesh& mesh = tile_.mesh;
    const std::size_t places = mesh.vertices.size();
    if (v >= places + mesh.copies.size())
      v = tile_.shading.split_of[v - places - mesh.copies.size()];
    return v < places ? mesh.vertices.positions[v] : mesh.copies.vertices.positions[v - places];
  }

  const PublishedTile& tile_;
};

using Point = std::array<double, 2>;

/// Texels of a picture.
std::array<Point, 3> in_texels(const std::array<Vec2f, 3>& texcoords, std::uint32_t width,
                               std::uint32_t height) {
  std::array<Point, 3> points;
  for (std::size_t k = 0; k < 3; ++k)
    points[k] = {static_cast<double>(texcoords[k].u) * width,
                 static_cast<double>(texcoords[k].v) * height};
  return points;
}

/// Returns twice the area of a triangle, with its orientation.
double area_of(const std::array<Point, 3>& p) {
  return (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
}

/// Weights of the corners at a point of a triangle of the plane.
std::array<double, 3> weights_at(const std::array<Point, 3>& p, double area, double x, double y) {
  const double px = x - p[0][0], py = y - p[0][1];
  const double b = (px * (p[2][1] - p[0][1]) - py * (p[2][0] - p[0][0])) / area;
  const double c = ((p[1][0] - p[0][0]) * py - (p[1][1] - p[0][1]) * px) / area;
  return {1 - b - c, b, c};
}

/// Sums of a comparison.
struct Comparison {
  std::uint64_t texels = 0;
  std::uint64_t unequal = 0;
  std::uint64_t reduced = 0;  ///< triangles that a coarser level of their picture shows
  double squared = 0;         ///< sum over all channels

  void add(const Comparison& other) {
    texels += other.texels;
    unequal += other.unequal;
    reduced += other.reduced;
    squared += other.squared;
  }
  /// Returns the root mean square, in steps of 0 to 255.
  double difference() const {
    return texels > 0 ? std::sqrt(squared / (3 * static_cast<double>(texels))) : 0;
  }
  void add(const std::uint8_t* a, const std::uint8_t* b) {
    ++texels;
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      sum += (a[c] - b[c]) * (a[c] - b[c]);
    squared += sum;
    unequal += sum > 0 ? 1 : 0;
  }
};

}  // namespace

struct TexelCheck::Impl {
  Impl(const VerifyJob& verify_job, const importing::MeshInput& input)
      : job(verify_job),
        format(job.reader.manifest().textures.value_or(TextureFormat{})),
        materials(input.materials()),
        picture_scratch(
            job.scratch.beside((job.scratch.path().filename().string() + "-pictures").c_str())),
        pictures(picture_scratch, job.options.memory_budget / 16),
        triangles(job.scratch, job.options.memory_budget / 8) {}

  /// All pictures; those that cannot be decoded are their materials' colours if the build was to
  /// ignore them.
  void decode() {
    const auto& config = job.reader.manifest().config;
    const bool may_be_broken = config.value("missing_images", "") == "ignore";
    for (const images::ImageSource& source : materials.images) {
      store_of.emplace_back();
      try {
        const auto reader = importing::open_picture(source, job.files);
        pictures.add(*reader, [&](std::uint64_t) { job.cancel.check(); });
        store_of.back() = static_cast<std::uint32_t>(pictures.size() - 1);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::input)
          throw;
        if (!may_be_broken)
          job.problems.add(error.what());
      }
    }
  }

  void add_partitions() {
    for (std::uint32_t i = 0; i < job.tree().partition_count(); ++i) {
      job.cancel.check();
      if (const auto tile = job.tiles.find({job.tree().depth(), i}))
        add_drawn(*tile);
    }
  }

  void add_drawn(const PublishedTile& tile) {
    if (tile.image.empty())
      return;
    const TileTriangles shown(tile);
    std::uint32_t number = 0;
    const auto add = [&](const TileTriangle& triangle) {
      const std::array<Vec3f, 3> corners = shown.positions(triangle);
      const std::size_t first = first_corner(corners);
      EitherTriangle either{key_of(corners, first), tile.node.index, number++, {}};
      for (std::size_t k = 0; k < 3; ++k)
        either.texcoords[k] = shown.texcoord(triangle[(first + k) % 3]);
      triangles.add(either);
    };
    for (const TileTriangle& triangle : shown_interior(tile))
      add(triangle);
    const auto before = [&](std::size_t ghost) {
      return draws_before(tile.node, tile.mesh.ghosts[ghost].tile, tile.node.level);
    };
    const std::vector<TileTriangle> border = shown_border(tile);
    for (std::size_t i = 0; i < border.size(); ++i) {
      if (draws(tile.mesh, tile.mesh.border[i], before))
        add(border[i]);
    }
  }

  /// Joins triangles of one key, if there is one on each side; of several nobody can say which is
  /// which.
  void join(ExpectedSort& expected) {
    triangles.sort();
    std::vector<EitherTriangle> group;
    const auto finish = [&] {
      if (group.size() == 2 && group[0].tile != group[1].tile &&
          (group[0].tile == kOfInput || group[1].tile == kOfInput)) {
        const bool is_swapped = group[0].tile == kOfInput;
        const EitherTriangle& tile = group[is_swapped ? 1 : 0];
        const EitherTriangle& input = group[is_swapped ? 0 : 1];
        expected.add({tile.tile, tile.number, input.number, input.texcoords, tile.texcoords});
      }
      group.clear();
    };
    triangles.for_each_block([&](std::span<const EitherTriangle> block) {
      job.cancel.check();
      for (const EitherTriangle& triangle : block) {
        if (!group.empty() && group[0].key != triangle.key)
          finish();
        if (group.size() < 3)
          group.push_back(triangle);
      }
    });
    finish();
  }

  void compare_all(ExpectedSort& expected) {
    std::optional<std::uint32_t> tile;
    Image image;
    bool exact = false;
    Comparison of_tile;
    const auto finish = [&] {
      if (tile)
        judge(*tile, exact, of_tile);
      all.add(std::exchange(of_tile, {}));
    };
    expected.sort();
    expected.for_each_block([&](std::span<const Expected> block) {
      job.cancel.check();
      for (const Expected& one : block) {
        if (tile != one.tile) {
          finish();
          tile = one.tile;
          const auto found = job.tiles.find({job.tree().depth(), one.tile});
          image = found ? decoded(*found) : Image{};
          exact = found && is_exact(found->image.format, format.quality);
        }
        if (image.width > 0)
          compare(one, image, of_tile);
      }
    });
    finish();
  }

  /// Returns an empty picture if it cannot be decoded; that is told where tiles are verified.
  Image decoded(const PublishedTile& tile) const {
    try {
      return images::decode_image(tile.image.bytes, "", kMostTexels);
    } catch (const Error&) {
      return {};
    }
  }

  void compare(const Expected& one, const Image& image, Comparison& result) {
    const Material& material = materials.materials.at(one.material);
    const auto shown = in_texels(one.shown, image.width, image.height);
    if (!material.image || !store_of[*material.image])
      return compare_colour(material, shown, image, result);
    const std::uint32_t picture = *store_of[*material.image];
    const images::ImageInfo& info = pictures.info(picture);
    const auto source = in_texels(one.source, info.width, info.height);
    const double area = area_of(source);
    const auto [left, right] = std::minmax({source[0][0], source[1][0], source[2][0]});
    const auto [top, bottom] = std::minmax({source[0][1], source[1][1], source[2][1]});
    if (std::abs(area) < kLeastArea || std::uint64_t{info.width} * info.height == 1)
      return;
    const bool is_copied = std::abs(area_of(shown)) > 0.5 * std::abs(area) &&
                           right - left < kMostSide && bottom - top < kMostSide;
    if (!is_copied) {
      ++result.reduced;
      return;
    }
    const double x0 = std::floor(left), y0 = std::floor(top);
    Image texels(static_cast<std::uint32_t>(std::ceil(right) - x0) + 1,
                 static_cast<std::uint32_t>(std::ceil(bottom) - y0) + 1, 3);
    shown_texels(one.material, picture)
        .read(0, static_cast<std::int64_t>(x0), static_cast<std::int64_t>(y0), texels.width,
              texels.height, texels, 0, 0);
    for (std::uint32_t y = 0; y < texels.height; ++y) {
      for (std::uint32_t x = 0; x < texels.width; ++x) {
        const auto w = weights_at(source, area, x0 + x + 0.5, y0 + y + 0.5);
        if (std::ranges::min(w) < 1e-6)
          continue;
        const double sx = w[0] * shown[0][0] + w[1] * shown[1][0] + w[2] * shown[2][0];
        const double sy = w[0] * shown[0][1] + w[1] * shown[1][1] + w[2] * shown[2][1];
        result.add(texel_at(image, sx, sy), texels.at(x, y));
      }
    }
  }

  /// Returns the texels of a material whose picture has that number in the store.
  const images::MaterialTexels& shown_texels(std::uint32_t number, std::uint32_t picture) {
    const auto found = texels_of_material.find(number);
    if (found != texels_of_material.end())
      return found->second;
    Material material = materials.materials.at(number);
    material.image = picture;
    return texels_of_material.try_emplace(number, material, pictures).first->second;
  }

  static void compare_colour(const Material& material, const std::array<Point, 3>& shown,
                             const Image& image, Comparison& result) {
    std::array<std::uint8_t, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c)
      colour[c] = screen_byte(material.colour[c]);
    result.add(texel_at(image, (shown[0][0] + shown[1][0] + shown[2][0]) / 3,
                        (shown[0][1] + shown[1][1] + shown[2][1]) / 3),
               colour.data());
  }

  static const std::uint8_t* texel_at(const Image& image, double x, double y) {
    const auto within = [](double value, std::uint32_t size) {
      return static_cast<std::uint32_t>(std::clamp(value, 0.0, size - 1.0));
    };
    return image.at(within(x, image.width), within(y, image.height));
  }

  void judge(std::uint32_t tile, bool exact, const Comparison& found) const {
    const bool is_wrong = exact ? found.unequal > 0 : found.difference() > kMostDifference;
    if (!is_wrong)
      return;
    job.problems.add(fmt::format(
        "partition {} shows other texels than the input: {} of {} differ, by {:.1f} of 255", tile,
        found.unequal, found.texels, found.difference()));
  }

  const VerifyJob& job;
  const TextureFormat format;
  const images::MaterialList& materials;
  storage::ScratchFile picture_scratch;
  images::ImageStore pictures;
  std::vector<std::optional<std::uint32_t>> store_of;  ///< for each picture its number in the store
  std::map<std::uint32_t, images::MaterialTexels> texels_of_material;
  partition::ExternalSort<EitherTriangle, ByKey> triangles;
  Comparison all;
};

TexelCheck::TexelCheck(const VerifyJob& job, const importing::MeshInput& input)
    : impl_(std::make_unique<Impl>(job, input)) {}

TexelCheck::~TexelCheck() = default;

void TexelCheck::add(const Triangle<InputCorner>& triangle) {
  const std::array<Vec3f, 3> corners{triangle[0].position, triangle[1].position,
                                     triangle[2].position};
  const std::size_t first = first_corner(corners);
  EitherTriangle either{key_of(corners, first), kOfInput, triangle[0].material, {}};
  for (std::size_t k = 0; k < 3; ++k)
    either.texcoords[k] = triangle[(first + k) % 3].texcoord;
  impl_->triangles.add(either);
}

void TexelCheck::compare() {
  impl_->decode();
  impl_->add_partitions();
  ExpectedSort expected(impl_->job.scratch, impl_->job.options.memory_budget / 8);
  impl_->join(expected);
  impl_->compare_all(expected);
  const Comparison& all = impl_->all;
  const std::string same =
      all.texels == 0 ? "nothing is known of their pictures"
      : all.unequal == 0
          ? "all equal"
          : fmt::format("{} of them not equal, off by {:.2f} of 255 (root mean square)",
                        all.unequal, all.difference());
  const std::string reduced = all.reduced == 0 ? ""
                                               : fmt::format("; {} shown by fewer texels",
                                                             counted(all.reduced, "triangles"));
  impl_->job.checks.push_back(fmt::format("input: {} compared with those of the partitions, {}{}",
                                          counted(all.texels, "texels"), same, reduced));
}

}  // namespace meshhier::verifying
