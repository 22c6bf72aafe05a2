#include "base/plain_text.h"
#include "execution/size_text.h"
#include "hierarchy/attributes.h"
#include "hierarchy/cut.h"
#include "images/formats.h"
#include "import/import_input.h"
#include "inspection/inspect.h"
#include "inspection/inspected.h"
#include "storage/format/level_summary.h"
#include "storage/format/source_values.h"
#include "storage/format/view_keys.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::inspection {
namespace {

using Json = nlohmann::ordered_json;

double ratio(std::uint64_t a, std::uint64_t b) {
  return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b);
}

/// Returns "1,234,567".
std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t i = digits.size(); i > 3; i -= 3)
    digits.insert(i - 3, 1, ',');
  return digits;
}

/// Returns "1,234 vertices", "1 vertex".
std::string grouped(std::uint64_t number, std::string_view plural) {
  return grouped(number) + ' ' + (number == 1 ? singular(plural) : std::string(plural));
}

/// A manifest's own words, which anyone may have written.
std::string shown(const std::string& text) {
  constexpr std::size_t kLongest = 255;  // longest, as that of a file's name
  return plain_text(text, kLongest);
}

/// Returns "1,234 vertices", "1,234 vertices at 1,000 places" if some lie where others do.
std::string vertices_text(const SourceSummary& source) {
  const std::string vertices = grouped(source.vertices, "vertices");
  return source.places == source.vertices
             ? vertices
             : fmt::format("{} at {}", vertices, grouped(source.places, "places"));
}

/// Returns a text about the input's textures.
std::string textures_text(const SourceTextures& t) {
  const std::string missing =
      t.missing_images > 0 ? fmt::format(" ({} missing)", grouped(t.missing_images)) : "";
  return fmt::format("{}, {}{}, {}", grouped(t.materials, "materials"),
                     grouped(t.images, "pictures"), missing, grouped(t.texels, "texels"));
}

/// The first of their names: ": 1 door, 2 roof, ...".
std::string names_text(const std::vector<ValueStatistics::LabelCount>& labels) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> names;
  for (const auto& [label, vertices, name] : labels) {
    if (!name.empty() && names.size() == kMost) {
      names.emplace_back("...");
      break;
    }
    if (!name.empty())
      names.push_back(fmt::format("{} {}", label, shown(name)));
  }
  return names.empty() ? "" : fmt::format(": {}", fmt::join(names, ", "));
}

/// Returns a text about one of the values that vertices have.
std::string value_text(const ScalarAttribute& attribute, const ValueStatistics& values) {
  std::string text =
      fmt::format("  {:<10} {} {}, {} to {}", shown(attribute.name), name_of(attribute.type),
                  name_in(kValueKinds, kind_of(attribute)), values.min, values.max);
  if (!values.labels.empty())
    text += ", " + counted(values.labels.size(), "labels") + names_text(values.labels);
  if (values.missing > 0)
    text += fmt::format(", missing at {}", grouped(values.missing, "vertices"));
  return text + '\n';
}

/// Returns a text about the objects: "objects      100,000, with height (number)".
std::string objects_text(const storage::ObjectsSummary& objects) {
  std::vector<std::string> properties, shown_by_level;
  for (const auto& [name, type] : objects.table.properties)
    properties.push_back(fmt::format("{} ({})", shown(name), name_of(type)));
  for (const std::uint64_t count : objects.shown)
    shown_by_level.push_back(grouped(count));
  return fmt::format("objects      {}{}{}; shown by level, from the root down: {}{}\n",
                     grouped(objects.table.objects), properties.empty() ? "" : ", with ",
                     fmt::join(properties, ", "), fmt::join(shown_by_level, "  "),
                     objects.are_in_tiles ? "; tiles have tables of them" : "");
}

std::string source_text(const storage::Manifest& manifest) {
  const SourceSummary& s = manifest.source;
  const BoundsD& b = s.bounds;
  std::string text =
      fmt::format("source       {}, {}: {} ({} of no triangle), {} of {} ({} degenerate dropped)\n",
                  shown(s.file_name), execution::rounded_size_text(s.file_bytes), vertices_text(s),
                  grouped(s.unreferenced_vertices), grouped(s.triangles, "triangles"),
                  grouped(s.faces, "faces"), grouped(s.degenerate_triangles));
  text += fmt::format("bounds       {} {} {} to {} {} {}{}\n", b.min.x, b.min.y, b.min.z, b.max.x,
                      b.max.y, b.max.z, s.double_precision ? ", double precision" : "");
  if (manifest.units)
    text += fmt::format("units        {}\n", name_of(*manifest.units));
  if (manifest.origin != Vec3d{}) {
    const Vec3d& o = manifest.origin;
    text += fmt::format("origin       {} {} {}\n", o.x, o.y, o.z);
  }
  text += fmt::format("attributes   {}\n", attribute_names(s.attributes));
  for (std::size_t i = 0; i < s.values.size(); ++i)
    text += value_text(s.attributes.values[i], s.values[i]);
  if (manifest.objects)
    text += objects_text(*manifest.objects);
  text += fmt::format("normals      {}{}\n", normals_of(manifest),
                      manifest.computed_normals ? ", 8 bits" : "");
  if (s.textures)
    text += "textures     " + textures_text(*s.textures) + '\n';
  for (const SourceFile& file : s.files) {
    text += fmt::format("imported     {}: {}, {}\n", shown(file.name), shown(file.format),
                        execution::rounded_size_text(file.bytes));
  }
  if (!s.counts.empty())
    text += fmt::format("counted      {}\n", shown(importing::counts_text(s.counts)));
  for (std::size_t i = 0; i < s.unused.size(); ++i)
    text += (i == 0 ? "not used     " : ", ") + shown(s.unused[i]);
  text += s.unused.empty() ? "" : "\n";
  return text;
}

/// Adds {"a": {"b": 1}} as "a.b 1".
void add_parameters(const std::string& prefix, const Json& value, std::string& text) {
  if (!value.is_object()) {
    text += fmt::format(
        "{}{} {}", text.empty() ? "" : ", ", prefix,
        shown(value.is_string() ? value.get<std::string>() : storage::json_text(value)));
    return;
  }
  for (const auto& [key, inner] : value.items()) {
    add_parameters(prefix.empty() ? shown(key) : prefix + "." + shown(key), inner, text);
  }
}

std::string partitions_text(const storage::LevelSummary& last,
                            const storage::CompactnessSummary& compactness) {
  std::string text =
      fmt::format("partitions   {} of {} to {}", grouped(last.tiles), grouped(last.vertices.min),
                  grouped(last.vertices.max, "vertices"));
  if (compactness.count > 0) {
    text += fmt::format("; compactness p^2/(4 pi w): mean {:.3f}, median {:.3f}, p95 {:.3f}",
                        compactness.mean, compactness.median, compactness.p95);
  }
  if (compactness.count > 0 && compactness.count < last.tiles) {
    text += fmt::format(" ({} without area left out)", last.tiles - compactness.count);
  }
  return text + "\n";
}

std::string range_text(const storage::CountRange& range) {
  return fmt::format("{:>6} {:>8.0f} {:>6} {:>6}", range.min, range.mean, range.max,
                     fmt::format("{:.0f}%", 100 * range.spread()));
}

std::string level_table(std::span<const storage::LevelSummary> levels, std::optional<Level> only) {
  std::string text = fmt::format(
      "{:>5} {:>7} |{:^29} | {:>9} {:>9} |{:^29} |{:^33} | {:>6} {:>10} {:>10} | {:>6} {:>8} {:>8} "
      "| "
      "{:>13}\n",
      "", "", "vertices a tile", "", "", "triangles a tile", "bytes a file", "", "", "", "off",
      "vertices", "vertices", "triangles");
  constexpr std::string_view kRange = "   min     mean    max spread";
  text += fmt::format(
      "{:>5} {:>7} |{} | {:>9} {:>9} |{} |{} | {:>6} {:>10} {:>10} | {:>6} {:>8} {:>8} | {:>13}\n",
      "level", "tiles", kRange, "copies", "splits", kRange, "     min     mean      max spread",
      "border", "error", "bound", "target", "torn", "forced", "shown");
  for (const storage::LevelSummary& s : levels) {
    if (only && s.level != *only)
      continue;
    const std::string bytes =
        fmt::format("{:>8} {:>8.0f} {:>8} {:>6}", s.bytes.min, s.bytes.mean, s.bytes.max,
                    fmt::format("{:.0f}%", 100 * s.bytes.spread()));
    text += fmt::format(
        "{:>5} {:>7} |{} | {:>9} {:>9} |{} |{} | {:>6} {:>10.4g} {:>10.4g} | {:>6} {:>8} {:>8} | "
        "{:>13}\n",
        raw(s.level), s.tiles, range_text(s.vertices), s.copies_total, s.splits_total,
        range_text(s.triangles), bytes, fmt::format("{:.1f}%", 100 * s.border_ratio), s.error_max,
        s.bound_max, s.off_target, s.torn_total, s.forced_total,
        (s.shown_exact ? "" : "<=") + grouped(s.shown_triangles));
  }
  return text +
         "spread: (max - min) / mean; copies: further vertices where one lies already, with other "
         "attributes; splits: further normals of vertices, at creases, and texture "
         "coordinates\nborder: share of border "
         "triangles; error, bound: the "
         "largest, in input units\ntorn: vertices that went by changing the surface's topology; "
         "forced: without care for the surface, to reach the count\n";
}

std::string gpu_text(double texel, const storage::PictureSummary& pictures) {
  return fmt::format(
      "{} of graphics memory each",
      execution::rounded_size_text(static_cast<std::uint64_t>(texel * pictures.texels_mean())));
}

/// Returns a text about the pictures of all tiles.
std::string pictures_text(const TextureFormat& format, const storage::PictureSummary& pictures) {
  const bool has_quality = !is_exact(format.format, 1);
  return fmt::format("pictures     {}{}, {}: {} of {:.0f} x {:.0f} texels on average, {}\n",
                     row_of(format.format).name,
                     has_quality ? fmt::format(" of quality {}", format.quality) : "",
                     format.unlit ? "unlit" : "lit", grouped(pictures.tiles), pictures.width,
                     pictures.height, gpu_text(gpu_bytes(format), pictures));
}

/// Returns a text about the normal maps of the tiles that have one.
std::string normal_maps_text(const NormalMapFormat& format,
                             const std::vector<TileRecord>& records) {
  std::vector<TileRecord> mapped;
  std::ranges::copy_if(records, std::back_inserter(mapped), &TileRecord::has_normal_map);
  const storage::PictureSummary maps = storage::summarize_pictures(mapped);
  const auto simplified = static_cast<std::uint64_t>(
      std::ranges::count_if(records, [](const TileRecord& r) { return r.error > 0; }));
  return fmt::format(
      "normal maps  {}{}: {} of {} simplified tiles, {:.0f} x {:.0f} on average, {}\n",
      row_of(format.format).name,
      row_of(format.format).graded_maps ? fmt::format(" of quality {}", format.quality) : "",
      grouped(maps.tiles), grouped(simplified), maps.width, maps.height,
      gpu_text(gpu_bytes(format), maps));
}

std::string tile_sizes_text(const storage::CountRange& bytes) {
  return fmt::format("tiles        {} on average, standard deviation {:.2f} of the mean\n",
                     grouped(static_cast<std::uint64_t>(std::llround(bytes.mean)), "bytes"),
                     bytes.variation());
}

std::string storage_text(const storage::Manifest& manifest) {
  std::string text =
      fmt::format("storage      {}, positions ", storage::row_of(manifest.compression).name);
  if (!manifest.quantization)
    return text + "exact\n";
  const storage::Quantization& q = *manifest.quantization;
  return text + fmt::format("on a lattice of {} bits, step {:.4g}, off by {:.4g} at most\n",
                            q.lattice.bits, q.lattice.step, q.worst_rounding);
}

std::string sizes_text(std::string_view what, const storage::SizeSummary& sizes) {
  return fmt::format("{:.2f} bytes a vertex and {:.2f} a triangle in {}, {:.1f}% of raw",
                     sizes.bytes_per_vertex(), sizes.bytes_per_triangle(), what,
                     100 * sizes.raw_ratio());
}

std::string outline_text(const storage::Manifest& manifest) {
  const OutlineReport& o = manifest.outline;
  return fmt::format(
      "outline      {}: {} of level {}, tolerance {:.3g} of the diagonal, {} found, {} dropped to "
      "fit\n",
      grouped(manifest.outline_bytes, "bytes"), grouped(o.sector_count, "sectors"), o.sector_level,
      o.tolerance, grouped(o.polylines_found, "lines"), grouped(o.polylines_dropped));
}

std::string preview_text(const storage::Manifest& manifest) {
  if (!manifest.preview)
    return "preview      none\n";
  const storage::Preview& p = *manifest.preview;
  return fmt::format("preview      {}, {} x {} pixels\n", grouped(p.bytes, "bytes"), p.width,
                     p.height);
}

std::string first_view_text(const storage::Manifest& manifest) {
  if (!manifest.first_view)
    return "first view   none\n";
  const auto& [azimuth, elevation] = *manifest.first_view;
  return fmt::format("first view   azimuth {}, elevation {} degrees\n", azimuth, elevation);
}

/// Returns a line on how it is shown first; nothing if nobody said it.
std::string view_line(const storage::Manifest& manifest) {
  std::string keys;
  const Json view = storage::view_json(manifest.view);
  for (const auto& [key, value] : view.items())
    keys += fmt::format("{}{} {}", keys.empty() ? "" : ", ", key,
                        value.is_string() ? value.get<std::string>() : storage::json_text(value));
  return keys.empty() ? "" : "view         " + shown(keys) + '\n';
}

std::string tileset_text(const storage::Manifest& manifest) {
  return fmt::format("tileset      {} in {}, {} up{}{}\n", grouped(manifest.tileset_bytes, "bytes"),
                     grouped(manifest.tileset_files, "files"), name_of(manifest.up),
                     manifest.transform ? ", placed" : "",
                     manifest.licence.empty() ? "" : ", licence " + shown(manifest.licence));
}

std::string totals_text(const storage::Manifest& manifest,
                        std::span<const storage::LevelSummary> levels, std::uint64_t total_bytes) {
  std::uint64_t tiles = 0, vertices = 0, triangles = 0;
  for (const storage::LevelSummary& s : levels) {
    tiles += s.tiles;
    vertices += s.vertices_total;
    triangles += s.triangles_total;
  }
  const SourceSummary& s = manifest.source;
  return fmt::format(
      "totals       {}, {}: {:.2f} times the input's bytes, {:.1f} bytes a triangle; {} "
      "({:.2f} times the input's), {} ({:.2f} times)\n",
      grouped(tiles, "tiles"), execution::rounded_size_text(total_bytes),
      ratio(total_bytes, s.file_bytes), ratio(total_bytes, s.triangles),
      grouped(vertices, "vertices"), ratio(vertices, s.vertices), grouped(triangles, "triangles"),
      ratio(triangles, s.triangles));
}

std::string picture_text(const TileRecord& r) {
  if (r.image_width == 0)
    return "";
  return fmt::format("; a picture of {} x {} texels of {:.4g}", r.image_width, r.image_height,
                     r.texel);
}

std::string tile_text(const TileRecord& r) {
  return fmt::format(
      "tile {}: {} (asked for {}), {} of them on the boundary, {}{}{}; {} interior and {}, {} of "
      "them drawn here; error {:.4g}, bound {:.4g}{}{}; {}; box {} {} {} to {} {} {}\n",
      to_text(r.node), counted(r.own_count, "vertices"), r.target_count, r.boundary_count,
      counted(r.ghost_count, "ghosts"),
      r.copy_count > 0 ? ", " + counted(r.copy_count, "copies") : "",
      r.split_count > 0 ? ", " + counted(r.split_count, "splits") : "", r.interior_count,
      counted(r.border_count, "border triangles"), r.drawn_border_count, r.error, r.bound,
      r.compactness > 0 ? fmt::format(", compactness {:.3f}", r.compactness) : "", picture_text(r),
      counted(r.file_bytes, "bytes"), r.bounds.min.x, r.bounds.min.y, r.bounds.min.z,
      r.bounds.max.x, r.bounds.max.y, r.bounds.max.z);
}

}  // namespace

std::string inspect_text(storage::FileSystem& files, const std::filesystem::path& directory,
                         const InspectOptions& options) {
  const Inspected inspected(files, directory, options);
  const storage::HierarchyReader& reader = inspected.reader();
  if (options.node)
    return tile_text(reader.record(*options.node));
  const auto levels = inspected.levels();
  if (options.level) {
    std::string text = level_table(levels, options.level);
    for (const TileRecord& record : inspected.records_of(*options.level))
      text += tile_text(record);
    return text;
  }
  const storage::Manifest& manifest = reader.manifest();
  std::string parameters;
  add_parameters("", manifest.config, parameters);
  std::string text = fmt::format("{} (format {}, by {})\n", directory.string(),
                                 manifest.format_version(), shown(manifest.generator));
  text += source_text(manifest);
  text += fmt::format("parameters   {}\n", parameters);
  text += storage_text(manifest);
  text +=
      fmt::format("sizes        {}; {}\n", sizes_text("partitions", inspected.partition_sizes()),
                  sizes_text("all tiles", inspected.all_sizes()));
  text += tile_sizes_text(inspected.all_sizes().tile_bytes);
  if (manifest.textures)
    text += pictures_text(*manifest.textures, inspected.pictures());
  if (manifest.normal_maps)
    text += normal_maps_text(*manifest.normal_maps, reader.records());
  text += partitions_text(levels.back(), inspected.compactness());
  text += outline_text(manifest);
  text += preview_text(manifest);
  text += first_view_text(manifest);
  text += view_line(manifest);
  text += tileset_text(manifest);
  text += totals_text(manifest, levels, inspected.bytes_on_disk());
  text += "\n" + level_table(levels, std::nullopt);
  return text + storage::forced_collapses_text(inspected.forced_collapses());
}

}  // namespace meshhier::inspection
