#include "storage/format/level_summary.h"

#include "hierarchy/cut.h"
#include "storage/format/tile_plan.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// Returns the range of one count of each record. It makes two passes, as the squares of large
/// counts would not fit.
template <class Count>
CountRange range_of(std::span<const TileRecord> records, const Count& count) {
  if (records.empty())
    return {};
  CountRange range{UINT64_MAX, 0};
  std::uint64_t sum = 0;
  for (const TileRecord& record : records) {
    range.min = std::min<std::uint64_t>(range.min, count(record));
    range.max = std::max<std::uint64_t>(range.max, count(record));
    sum += count(record);
  }
  const auto n = static_cast<double>(records.size());
  range.mean = static_cast<double>(sum) / n;
  double squares = 0;
  for (const TileRecord& record : records) {
    const double off = static_cast<double>(count(record)) - range.mean;
    squares += off * off;
  }
  range.deviation = std::sqrt(squares / n);
  return range;
}

std::uint64_t vertex_count(const TileRecord& record) {
  return record.own_count;
}

std::uint64_t file_bytes(const TileRecord& record) {
  return record.file_bytes;
}

std::uint64_t triangle_count(const TileRecord& record) {
  return std::uint64_t{record.interior_count} + record.border_count;
}

std::uint64_t drawn_count(const TileRecord& record) {
  return std::uint64_t{record.interior_count} + record.drawn_border_count;
}

std::uint64_t texel_count(const TileRecord& record) {
  return std::uint64_t{record.image_width} * record.image_height;
}

/// Returns a / b; 0 if b is 0.
double quotient(std::uint64_t a, std::uint64_t b) {
  return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b);
}

LevelSummary summarize(Level level, Level last, std::span<const TileRecord> records) {
  LevelSummary summary;
  summary.level = level;
  summary.tiles = static_cast<std::uint32_t>(records.size());
  std::uint64_t triangles = 0, border = 0;
  for (const TileRecord& record : records) {
    triangles += triangle_count(record);
    border += record.border_count;
    summary.vertices_total += record.own_count;
    summary.bytes_total += record.file_bytes;
    summary.copies_total += record.copy_count;
    summary.splits_total += record.split_count;
    summary.triangles_total += drawn_count(record);
    summary.error_max = std::max(summary.error_max, record.error);
    summary.bound_max = std::max(summary.bound_max, record.bound);
    summary.torn_total += record.torn_count;
    summary.forced_total += record.forced_count;
    if (level != last && record.own_count != record.target_count)
      ++summary.off_target;
  }
  summary.vertices = range_of(records, vertex_count);
  summary.triangles = range_of(records, triangle_count);
  summary.bytes = range_of(records, file_bytes);
  summary.border_ratio = quotient(border, triangles);
  summary.pictures = summarize_pictures(records);
  summary.shown_tiles = summary.tiles;
  summary.shown_triangles = summary.triangles_total;
  return summary;
}

/// Adds to the level above the last the partitions that it shows, too.
void add_partitions(const Tree& tree, std::span<const TileRecord> partitions, LevelSummary& above) {
  for (const TileRecord& record : partitions) {
    if (!tree.stands_for_parent(record.node))
      continue;
    ++above.shown_tiles;
    above.shown_triangles += triangle_count(record);
    if (record.border_count > 0)
      above.shown_exact = false;
  }
}

/// Returns the value that a share of the ascending values does not exceed (nearest rank).
double quantile(std::span<const float> ascending, double share) {
  const auto rank =
      static_cast<std::size_t>(std::ceil(share * static_cast<double>(ascending.size())));
  return double{ascending[std::max<std::size_t>(rank, 1) - 1]};
}

}  // namespace

std::vector<LevelSummary> summarize_levels(const Tree& tree, std::span<const TileRecord> records) {
  std::vector<LevelSummary> levels;
  std::size_t begin = 0;
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    std::size_t end = begin;
    while (end < records.size() && raw(records[end].node.level) == level)
      ++end;
    const auto of_level = records.subspan(begin, end - begin);
    levels.push_back(summarize(static_cast<Level>(level), tree.depth(), of_level));
    if (level > 0 && level == raw(tree.depth())) {
      add_partitions(tree, of_level, levels[static_cast<std::size_t>(level) - 1]);
    }
    begin = end;
  }
  return levels;
}

double SizeSummary::bytes_per_vertex() const {
  return quotient(bytes, vertices);
}
double SizeSummary::bytes_per_triangle() const {
  return quotient(bytes, triangles);
}
double SizeSummary::raw_ratio() const {
  return quotient(bytes, raw_bytes);
}

SizeSummary summarize_sizes(std::span<const TileRecord> records, const TileFormat& format) {
  using storage::TilePart;
  SizeSummary sizes;
  sizes.tile_bytes = range_of(records, file_bytes);
  for (const TileRecord& record : records) {
    storage::TileShape shape;
    shape.own = record.own_count;
    shape.ghosts = record.ghost_count;
    shape.copies = record.copy_count;
    shape.splits = record.split_count;
    shape.computed_normals = format.computed_normals;
    shape.textures = format.textures;
    shape.screen_colours = format.screen_colours;
    shape.normal_maps = format.normal_maps;
    const std::uint64_t texels = texel_count(record);
    shape.image.bytes = format.textures ? texels * 3 : 0;
    shape.normal_map.bytes = record.has_normal_map ? texels * 3 : 0;
    shape.interior = record.interior_count;
    shape.border = record.border_count;
    const storage::TilePlan plan(shape, format.attributes);
    for (const TilePart part :
         {TilePart::position, TilePart::normal, TilePart::tangent, TilePart::colour,
          TilePart::texcoord, TilePart::map_texcoord, TilePart::interior, TilePart::border,
          TilePart::values, TilePart::image, TilePart::normal_map})
      sizes.raw_bytes += plan[part].bytes();
    sizes.bytes += record.file_bytes;
    sizes.vertices += record.own_count;
    sizes.triangles += drawn_count(record);
  }
  return sizes;
}

nlohmann::ordered_json to_json(const SizeSummary& s) {
  return {{"bytes", s.bytes},
          {"bytes_mean", s.tile_bytes.mean},
          {"bytes_deviation", s.tile_bytes.deviation},
          {"raw_bytes", s.raw_bytes},
          {"bytes_per_vertex", s.bytes_per_vertex()},
          {"bytes_per_triangle", s.bytes_per_triangle()},
          {"raw_ratio", s.raw_ratio()}};
}

PictureSummary summarize_pictures(std::span<const TileRecord> records) {
  PictureSummary pictures;
  std::uint64_t width = 0, height = 0, measured = 0;
  double texel = 0;
  for (const TileRecord& record : records) {
    pictures.tiles += record.image_width > 0 ? 1 : 0;
    pictures.texels += texel_count(record);
    width += record.image_width;
    height += record.image_height;
    measured += record.texel > 0 ? 1 : 0;
    texel += double{record.texel};
  }
  pictures.width = quotient(width, pictures.tiles);
  pictures.height = quotient(height, pictures.tiles);
  pictures.texel = measured > 0 ? texel / static_cast<double>(measured) : 0;
  return pictures;
}

double PictureSummary::texels_mean() const {
  return quotient(texels, tiles);
}

nlohmann::ordered_json to_json(const PictureSummary& s) {
  return {{"tiles", s.tiles},      {"texels", s.texels},      {"texels_mean", s.texels_mean()},
          {"width_mean", s.width}, {"height_mean", s.height}, {"texel_mean", s.texel}};
}

CompactnessSummary summarize_compactness(const Tree& tree, std::span<const TileRecord> records) {
  std::vector<float> values;
  double sum = 0;
  for (const TileRecord& record : records) {
    if (!tree.is_partition(record.node) || !(record.compactness > 0))
      continue;
    values.push_back(record.compactness);
    sum += double{record.compactness};
  }
  if (values.empty())
    return {};
  std::sort(values.begin(), values.end());
  return {static_cast<std::uint32_t>(values.size()), sum / static_cast<double>(values.size()),
          quantile(values, 0.5), quantile(values, 0.95)};
}

ForcedCollapses summarize_forced_collapses(std::span<const TileRecord> records,
                                           std::uint64_t source_places) {
  ForcedCollapses forced;
  for (const TileRecord& record : records)
    forced.vertices += std::uint64_t{record.torn_count} + record.forced_count;
  forced.share = quotient(forced.vertices, source_places);
  return forced;
}

std::string forced_collapses_text(const ForcedCollapses& forced) {
  if (!forced.is_many())
    return "";
  return fmt::format(
      "warning: {} vertices ({:.1f} % of the input's) went by tearing the surface or without care "
      "for it: coarse levels show it badly. Are neighbouring triangles joined by common "
      "vertices?\n",
      forced.vertices, 100 * forced.share);
}

nlohmann::ordered_json to_json(const ForcedCollapses& forced) {
  return {{"vertices", forced.vertices}, {"share", forced.share}};
}

nlohmann::ordered_json to_json(const LevelSummary& s) {
  nlohmann::ordered_json json{{"level", raw(s.level)},
                              {"tiles", s.tiles},
                              {"vertices_min", s.vertices.min},
                              {"vertices_mean", s.vertices.mean},
                              {"vertices_max", s.vertices.max},
                              {"vertices_total", s.vertices_total},
                              {"copies_total", s.copies_total},
                              {"splits_total", s.splits_total},
                              {"triangles_min", s.triangles.min},
                              {"triangles_mean", s.triangles.mean},
                              {"triangles_max", s.triangles.max},
                              {"triangles_total", s.triangles_total},
                              {"bytes_min", s.bytes.min},
                              {"bytes_mean", s.bytes.mean},
                              {"bytes_deviation", s.bytes.deviation},
                              {"bytes_max", s.bytes.max},
                              {"bytes_total", s.bytes_total},
                              {"border_ratio", s.border_ratio},
                              {"error_max", s.error_max},
                              {"bound_max", s.bound_max},
                              {"torn_vertices", s.torn_total},
                              {"forced_vertices", s.forced_total},
                              {"off_target", s.off_target},
                              {"shown_tiles", s.shown_tiles},
                              {"shown_triangles", s.shown_triangles},
                              {"shown_triangles_exact", s.shown_exact}};
  if (s.pictures.tiles > 0)
    json["pictures"] = to_json(s.pictures);
  return json;
}

nlohmann::ordered_json to_json(const TileRecord& r) {
  const auto corner = [](Vec3f p) { return nlohmann::ordered_json::array({p.x, p.y, p.z}); };
  return {{"node", to_text(r.node)},
          {"vertices", r.own_count},
          {"vertices_asked_for", r.target_count},
          {"boundary_vertices", r.boundary_count},
          {"ghosts", r.ghost_count},
          {"copies", r.copy_count},
          {"splits", r.split_count},
          {"interior_triangles", r.interior_count},
          {"border_triangles", r.border_count},
          {"drawn_border_triangles", r.drawn_border_count},
          {"bounds", {{"min", corner(r.bounds.min)}, {"max", corner(r.bounds.max)}}},
          {"torn_vertices", r.torn_count},
          {"forced_vertices", r.forced_count},
          {"error", r.error},
          {"bound", r.bound},
          {"compactness", r.compactness},
          {"image_width", r.image_width},
          {"image_height", r.image_height},
          {"texel", r.texel},
          {"bytes", r.file_bytes}};
}

}  // namespace meshhier::storage
