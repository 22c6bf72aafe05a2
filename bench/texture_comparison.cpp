#include "bench/texture_comparison.h"

#include "base/error.h"
#include "compare/cut_surface.h"
#include "execution/cancel.h"
#include "execution/parallel.h"
#include "hierarchy/cut.h"
#include "images/image_codec.h"
#include "inspection/shown_tiles.h"
#include "render/camera.h"
#include "render/directions.h"
#include "render/mip_texture.h"
#include "render/raster.h"
#include "render/shade.h"
#include "render/tile_facets.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::bench {
namespace {

using RatioJson = nlohmann::ordered_json;

/// A sample covers so many texels of the input along each axis: two levels up in its pyramid still
/// keep charts apart that have gutters of four texels.
constexpr double kTexelsASample = 2;
/// A picture's side has so many samples at most: 1 GB.
constexpr std::uint32_t kMostSamples = 6144;
constexpr std::uint32_t kLeastSamples = 2;

// ---- a level seen from afar ----------------------------------------------------------------

/// A level as the index tells it.
struct LevelFacts {
  Level level{};
  double error = 0, texel = 0;
};

LevelFacts facts_of(const storage::HierarchyReader& reader, Level level) {
  LevelFacts facts{level};
  double triangles = 0;
  const Cut cut = Cut::of_level(reader.tree(), level);
  for (const NodeId node : cut.nodes()) {
    const TileRecord& record = reader.record(node);
    const double share = record.interior_count + record.drawn_border_count;
    facts.error = std::max<double>(facts.error, record.error);
    facts.texel += record.texel * share;
    triangles += share;
  }
  facts.texel = triangles > 0 ? facts.texel / triangles : 0;
  return facts;
}

/// All views and levels have this in common.
struct TextureJob {
  const storage::HierarchyReader& reader;
  const TexturedMesh& input;
  const TextureOptions& options;
  double input_texel = 0;
  std::vector<LevelFacts> levels;
  std::vector<render::View> views;
  bool pictures = false;

  double pixel(const LevelFacts& level) const {
    const double pixel = std::max(level.error, input_texel);
    return pixel > 0 ? pixel : reader.manifest().source.diagonal() / options.size;
  }
};

std::uint32_t pixels_for(double extent, double pixel, std::uint32_t most) {
  const double wanted = std::ceil(extent / pixel) + 2;
  return wanted < most ? static_cast<std::uint32_t>(wanted) : most;
}

render::Framing framing_for(const TextureJob& job, const render::View& view, double pixel) {
  const BoundsD box = stored_box(job.reader.manifest());
  const auto [across, upright] = render::extent_of(box, render::axes_of(view));
  render::Framing framing{.width = pixels_for(across, pixel, job.options.size),
                          .height = pixels_for(upright, pixel, job.options.size)};
  const std::uint32_t most =
      std::max(kLeastSamples, kMostSamples / std::max(framing.width, framing.height));
  const double wanted =
      job.input_texel > 0 ? std::ceil(pixel / (kTexelsASample * job.input_texel)) : 0;
  framing.samples = static_cast<std::uint32_t>(std::clamp<double>(wanted, kLeastSamples, most));
  return framing;
}

/// Returns the vertex nearest to the middle of the picture: there is something to see there.
Vec3d middle_vertex(const TexturedMesh& mesh, const render::ViewAxes& axes, Vec3d centre) {
  Vec3d nearest = centre;
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3f position : mesh.positions) {
    const Vec3d off = to_double(position) - centre;
    const double x = dot(off, axes.right), y = dot(off, axes.up);
    if (x * x + y * y < least) {
      least = x * x + y * y;
      nearest = to_double(position);
    }
  }
  return nearest;
}

render::Camera camera_for(const TextureJob& job, const render::View& view, double pixel) {
  const render::Framing framing = framing_for(job, view, pixel);
  const BoundsD box = stored_box(job.reader.manifest());
  const Vec3d centre = (box.min + box.max) * 0.5;
  const bool is_cut = std::max(framing.width, framing.height) == job.options.size;
  return {view, is_cut ? middle_vertex(job.input, render::axes_of(view), centre) : centre, pixel,
          framing};
}

void draw_tile(const inspection::ShownTile& shown, render::Raster& raster) {
  const TileImage& image = shown.tile.image;
  if (image.empty())
    return;
  const std::uint64_t texels = std::uint64_t{image.width} * image.height;
  const render::MipTexture texture(
      images::decode_image(image.bytes, "the picture of a tile", texels),
      {Wrap::clamp, Wrap::clamp});
  const auto facets = render::facets_of(shown.tile, {}, shown.border, render::NormalKind::facets);
  const auto skins = render::skins_of(shown.tile, {}, texture, shown.border);
  for (std::size_t i = 0; i < facets.size(); ++i)
    raster.draw(facets[i], skins[i]);
}

images::Image picture_of_level(const TextureJob& job, const render::Camera& camera, Level level) {
  render::Raster raster(camera);
  inspection::ShownTiles surface(job.reader, Cut::of_level(job.reader.tree(), level));
  for (std::size_t i = 0; i < surface.size(); ++i)
    draw_tile(surface.load(i), raster);
  return render::shade(raster, {.kind = render::Light::none});
}

images::Image picture_of_input(const TextureJob& job, const render::Camera& camera) {
  render::Raster raster(camera);
  job.input.draw(raster);
  return render::shade(raster, {.kind = render::Light::none});
}

// ---- one view ------------------------------------------------------------------------------

images::Image side_by_side(const images::Image& left, const images::Image& right) {
  images::Image both(left.width + right.width, left.height, 4);
  for (std::uint32_t y = 0; y < both.height; ++y) {
    std::copy_n(left.at(0, y), std::size_t{4} * left.width, both.at(0, y));
    std::copy_n(right.at(0, y), std::size_t{4} * right.width, both.at(left.width, y));
  }
  return both;
}

struct LevelView {
  std::uint32_t width = 0, height = 0;
  std::optional<double> ratio{};
};

struct TextureViewResult {
  std::vector<LevelView> levels;
  std::vector<NamedPicture> pictures;
};

TextureViewResult measure_textures(const TextureJob& job, std::size_t number) {
  TextureViewResult result;
  for (const LevelFacts& level : job.levels) {
    const render::Camera camera = camera_for(job, job.views[number], job.pixel(level));
    const images::Image input = picture_of_input(job, camera);
    const images::Image shown = picture_of_level(job, camera, level.level);
    result.levels.push_back({input.width, input.height, peak_ratio(input, shown)});
    if (job.pictures) {
      result.pictures.push_back(
          {fmt::format("view{}_level{}.png", number + 1, raw(level.level)),
           images::encode_image(side_by_side(input, shown), ImageFormat::png, 100)});
    }
  }
  return result;
}

// ---- all views -----------------------------------------------------------------------------

/// A level's ratios, one after another.
struct RatioSum {
  double sum = 0, least = std::numeric_limits<double>::infinity();
  int count = 0;

  void add(const std::optional<double>& ratio) {
    if (!ratio)
      return;
    sum += *ratio;
    least = std::min(least, *ratio);
    ++count;
  }
  void tell(TextureRow& row) const {
    if (count > 0) {
      row.least = least;
      row.mean = sum / count;
    }
  }
};

std::vector<LevelFacts> facts_of_levels(const storage::HierarchyReader& reader,
                                        const std::optional<Level>& asked) {
  std::vector<LevelFacts> facts;
  for (const Level level : levels_of(reader.tree(), asked))
    facts.push_back(facts_of(reader, level));
  return facts;
}

std::string ratio_text(const std::optional<double>& ratio) {
  return !ratio ? "none" : std::isinf(*ratio) ? "equal" : fmt::format("{:.2f}", *ratio);
}

RatioJson ratio_json(const std::optional<double>& ratio) {
  return ratio && std::isfinite(*ratio) ? RatioJson(*ratio) : RatioJson();
}

}  // namespace

std::optional<double> peak_ratio(const images::Image& a, const images::Image& b) {
  std::uint64_t squares = 0, pixels = 0;
  for (std::size_t i = 0; i < a.texels.size(); i += 4) {
    if (a.texels[i + 3] != 255 || b.texels[i + 3] != 255)
      continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const int off = a.texels[i + c] - b.texels[i + c];
      squares += static_cast<std::uint64_t>(off * off);
    }
    ++pixels;
  }
  if (pixels == 0)
    return std::nullopt;
  if (squares == 0)
    return std::numeric_limits<double>::infinity();
  const double mean = static_cast<double>(squares) / (3.0 * static_cast<double>(pixels));
  return 10 * std::log10(255.0 * 255.0 / mean);
}

TextureComparison compare_textures(const storage::HierarchyReader& reader,
                                   const TexturedMesh& input, const TextureOptions& options,
                                   const std::function<void(const NamedPicture&)>& sink) {
  if (!reader.manifest().textures)
    throw Error(ErrorCode::usage, reader.directory().string() + " has no textures to compare");
  const TextureJob job{reader,
                       input,
                       options,
                       input.texel(),
                       facts_of_levels(reader, options.level),
                       render::views_around(options.views, up_of(reader.manifest())),
                       static_cast<bool>(sink)};
  TextureComparison comparison{options, job.input_texel, {}};
  for (const LevelFacts& level : job.levels)
    comparison.rows.push_back({level.level, level.error, level.texel, job.pixel(level)});
  std::vector<RatioSum> sums(job.levels.size());
  execution::ordered_for(
      job.views.size(), execution::useful_blocks(UINT64_MAX, 1), execution::CancelToken{},
      [&](std::size_t view) { return measure_textures(job, view); },
      [&](std::size_t, const TextureViewResult& result) {
        for (const NamedPicture& picture : result.pictures)
          sink(picture);
        for (std::size_t i = 0; i < sums.size(); ++i) {
          TextureRow& row = comparison.rows[i];
          row.width = std::max(row.width, result.levels[i].width);
          row.height = std::max(row.height, result.levels[i].height);
          sums[i].add(result.levels[i].ratio);
        }
      });
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i].tell(comparison.rows[i]);
  return comparison;
}

std::string markdown(const std::string& name, const TextureComparison& comparison) {
  std::string text = fmt::format(
      "### {}: {} views, a texel of the input is {:.4g}\n\n"
      "| level | error | texel | a pixel | picture | dB, least | mean |\n"
      "|---:|---:|---:|---:|---:|---:|---:|\n",
      name, comparison.options.views, comparison.input_texel);
  for (const TextureRow& row : comparison.rows) {
    text += fmt::format("| {} | {:.4g} | {:.4g} | {:.4g} | {} x {} | {} | {} |\n", raw(row.level),
                        row.error, row.texel, row.pixel, row.width, row.height,
                        ratio_text(row.least), ratio_text(row.mean));
  }
  return text;
}

std::string json_text(const std::string& name, const TextureComparison& comparison) {
  RatioJson levels = RatioJson::array();
  for (const TextureRow& row : comparison.rows) {
    levels.push_back({{"level", raw(row.level)},
                      {"error", row.error},
                      {"texel", row.texel},
                      {"pixel", row.pixel},
                      {"width", row.width},
                      {"height", row.height},
                      {"least_db", ratio_json(row.least)},
                      {"mean_db", ratio_json(row.mean)}});
  }
  const RatioJson object{{"hierarchy", name},
                         {"views", comparison.options.views},
                         {"input_texel", comparison.input_texel},
                         {"levels", std::move(levels)}};
  return storage::json_text(object, {.indent = 2}) + "\n";
}

}  // namespace meshhier::bench
