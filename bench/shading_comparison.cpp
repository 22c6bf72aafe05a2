#include "bench/shading_comparison.h"

#include "base/angle.h"
#include "compare/cut_surface.h"
#include "execution/cancel.h"
#include "execution/parallel.h"
#include "hierarchy/attributes.h"
#include "hierarchy/cut.h"
#include "hierarchy/frame.h"
#include "images/image_codec.h"
#include "inspection/shown_tiles.h"
#include "render/directions.h"
#include "render/raster.h"
#include "render/scene.h"
#include "render/shade.h"
#include "render/tile_facets.h"
#include "storage/io/json_text.h"

#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::bench {
namespace {

using Json = nlohmann::ordered_json;
using render::NormalKind;

// ---- differences ---------------------------------------------------------------------------

/// Takes directions of length 1.
double degrees_between(Vec3f a, Vec3f b) {
  constexpr double kDegrees = 57.29577951308232;
  const Vec3d u = to_double(a), v = to_double(b);
  return kDegrees * angle_of(dot(u, v), length(cross(u, v)));
}

/// Takes screen values; the shares are those of ITU-R BT.709.
double luminance(const std::uint8_t* rgba) {
  return 0.2126 * rgba[0] + 0.7152 * rgba[1] + 0.0722 * rgba[2];
}

struct DrawnPicture {
  render::Raster raster;
  images::Image picture;
};

class DifferenceSum {
 public:
  void add(const DrawnPicture& a, const DrawnPicture& b) {
    add_normals(a.raster, b.raster);
    add_pixels(a.picture, b.picture);
  }

  void add(const DifferenceSum& other) {
    degrees_ += other.degrees_;
    samples_ += other.samples_;
    squares_ += other.squares_;
    pixels_ += other.pixels_;
  }

  /// Returns 0 if there is nothing to compare.
  ShadingDifference mean() const {
    ShadingDifference result;
    if (samples_ > 0)
      result.degrees = degrees_ / static_cast<double>(samples_);
    if (pixels_ > 0)
      result.luminance = std::sqrt(squares_ / static_cast<double>(pixels_));
    return result;
  }

 private:
  void add_normals(const render::Raster& a, const render::Raster& b) {
    for (std::size_t i = 0; i < a.samples().size(); ++i) {
      const render::Sample &one = a.samples()[i], &other = b.samples()[i];
      if (one.covered() && other.covered()) {
        degrees_ += degrees_between(one.normal, other.normal);
        ++samples_;
      }
    }
  }

  void add_pixels(const images::Image& a, const images::Image& b) {
    for (std::size_t i = 0; i < a.texels.size(); i += 4) {
      if (a.texels[i + 3] == 255 && b.texels[i + 3] == 255) {
        const double off = luminance(&a.texels[i]) - luminance(&b.texels[i]);
        squares_ += off * off;
        ++pixels_;
      }
    }
  }

  double degrees_ = 0, squares_ = 0;
  std::uint64_t samples_ = 0, pixels_ = 0;
};

// ---- one view ------------------------------------------------------------------------------

struct LevelSums {
  std::uint64_t triangles = 0;
  DifferenceSum own, facets;

  void add(const LevelSums& other) {
    own.add(other.own);
    facets.add(other.facets);
  }
};

struct ViewResult {
  std::vector<LevelSums> levels;
  std::vector<NamedPicture> pictures;
};

/// One level, drawn in both ways.
struct DrawnLevel {
  std::uint64_t triangles = 0;
  DrawnPicture own, facets;
};

DrawnPicture shaded(render::Raster raster) {
  images::Image picture = render::shade(raster);
  return {std::move(raster), std::move(picture)};
}

DrawnLevel draw_level(const storage::HierarchyReader& reader, const render::Camera& camera,
                      Level level) {
  const AttributeLayout without_colours{.normals = reader.tile_format().attributes.normals};
  inspection::ShownTiles surface(reader, Cut::of_level(reader.tree(), level));
  render::Raster own(camera), facets(camera);
  std::uint64_t triangles = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const inspection::ShownTile shown = surface.load(i);
    render::scene_tile(shown.tile, without_colours, shown.border).draw(own);
    facets.draw(render::facets_of(shown.tile, without_colours, shown.border, NormalKind::facets));
    triangles += shown.tile.mesh.interior.size() + shown.border.size();
  }
  return {triangles, shaded(std::move(own)), shaded(std::move(facets))};
}

render::Camera camera_of(const storage::HierarchyReader& reader, const render::View& view,
                         std::uint32_t size) {
  return {view, stored_box(reader.manifest()), render::Framing{.width = size, .height = size}};
}

/// All views have this in common.
struct Job {
  const storage::HierarchyReader& reader;
  const ShadingOptions& options;
  std::vector<Level> levels;
  std::vector<render::View> views;
  bool pictures = false;
};

ViewResult measure_view(const Job& job, std::size_t number) {
  const render::Camera camera = camera_of(job.reader, job.views[number], job.options.size);
  ViewResult result;
  const auto keep = [&](const std::string& what, const DrawnPicture& drawn) {
    if (job.pictures) {
      result.pictures.push_back({fmt::format("view{}_{}.png", number + 1, what),
                                 images::encode_image(drawn.picture, ImageFormat::png, 100)});
    }
  };
  const DrawnPicture original = draw_level(job.reader, camera, job.reader.tree().depth()).own;
  keep("original", original);
  for (const Level level : job.levels) {
    const DrawnLevel drawn = draw_level(job.reader, camera, level);
    keep(fmt::format("level{}_own", raw(level)), drawn.own);
    keep(fmt::format("level{}_facets", raw(level)), drawn.facets);
    LevelSums& sums = result.levels.emplace_back();
    sums.triangles = drawn.triangles;
    sums.own.add(original, drawn.own);
    sums.facets.add(original, drawn.facets);
  }
  return result;
}

// ---- all views -----------------------------------------------------------------------------

std::string kind_of_normals(const storage::HierarchyReader& reader) {
  const Tree& tree = reader.tree();
  if (!reader.read_tile(tree.tile_node(tree.root())).shading.normals.empty())
    return "computed";
  return reader.tile_format().attributes.normals ? "given" : "none";
}

Json json_of(const ShadingDifference& difference) {
  return {{"degrees", difference.degrees}, {"luminance", difference.luminance}};
}

}  // namespace

ShadingComparison compare_shading(const storage::HierarchyReader& reader,
                                  const ShadingOptions& options,
                                  const std::function<void(const NamedPicture&)>& sink) {
  const Job job{reader, options, levels_of(reader.tree(), options.level),
                render::views_around(options.views, up_of(reader.manifest())),
                static_cast<bool>(sink)};
  std::vector<LevelSums> sums(job.levels.size());
  execution::ordered_for(
      job.views.size(), comparing::tiles_in_flight(), execution::CancelToken{},
      [&](std::size_t view) { return measure_view(job, view); },
      [&](std::size_t, const ViewResult& result) {
        for (const NamedPicture& picture : result.pictures)
          sink(picture);
        for (std::size_t i = 0; i < sums.size(); ++i) {
          sums[i].triangles = result.levels[i].triangles;
          sums[i].add(result.levels[i]);
        }
      });
  ShadingComparison comparison{kind_of_normals(reader), options, {}};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    comparison.rows.push_back(
        {job.levels[i], sums[i].triangles, sums[i].own.mean(), sums[i].facets.mean()});
  }
  return comparison;
}

std::string markdown(const std::string& name, const ShadingComparison& comparison) {
  const ShadingOptions& options = comparison.options;
  std::string text = fmt::format(
      "### {}: {} views of {} x {} pixels, normals: {}\n\n"
      "| level | triangles | degrees, own normals | facets | luminance, own normals | facets |\n"
      "|---:|---:|---:|---:|---:|---:|\n",
      name, options.views, options.size, options.size, comparison.normals);
  for (const ShadingRow& row : comparison.rows) {
    text += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", raw(row.level),
                        row.triangles, row.own.degrees, row.facets.degrees, row.own.luminance,
                        row.facets.luminance);
  }
  return text;
}

std::string json_text(const std::string& name, const ShadingComparison& comparison) {
  Json levels = Json::array();
  for (const ShadingRow& row : comparison.rows) {
    levels.push_back({{"level", raw(row.level)},
                      {"triangles", row.triangles},
                      {"own", json_of(row.own)},
                      {"facets", json_of(row.facets)}});
  }
  const Json object{{"hierarchy", name},
                    {"normals", comparison.normals},
                    {"views", comparison.options.views},
                    {"size", comparison.options.size},
                    {"levels", std::move(levels)}};
  return storage::json_text(object, {.indent = 2}) + "\n";
}

}  // namespace meshhier::bench
