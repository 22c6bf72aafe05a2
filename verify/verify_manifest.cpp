// Compares the manifest with facts that follow from tiles, index and itself.
#include "base/bounds.h"
#include "base/error.h"
#include "config/config.h"
#include "config/partition_size.h"
#include "config/placement.h"
#include "export/manifest_config.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "storage/format/object_facts.h"
#include "storage/format/sealed_json.h"
#include "storage/io/json_text.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::verifying {
namespace {

using Json = nlohmann::ordered_json;

/// Adds problems that start with the manifest's file.
class ManifestProblems {
 public:
  explicit ManifestProblems(const VerifyJob& job)
      : job_(job), path_(storage::manifest_path(job.reader.directory())) {}

  void require(bool holds, const std::string& problem) const {
    if (!holds)
      job_.problems.add(path_.string() + ": " + problem);
  }
  template <class Value>
  void compare(std::string_view what, const Value& told, const Value& found) const {
    require(told == found, fmt::format("{} is {}, expected {}", what, told, found));
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  const VerifyJob& job_;
  std::filesystem::path path_;
};

/// Checks that the manifest, written again, is the same text: nothing has been added, renamed, or
/// is of another type.
void check_form(const VerifyJob& job, const ManifestProblems& problems) {
  const auto file = job.files.open(problems.path());
  problems.require(storage::read_sealed_text(*file) == storage::to_json_text(job.reader.manifest()),
                   "has a key that is not known, or a value in another form than it is written in");
}

void check_levels(const VerifyJob& job, const ManifestProblems& problems) {
  Json expected = Json::array();
  for (const storage::LevelSummary& level :
       storage::summarize_levels(job.tree(), job.reader.records()))
    expected.push_back(storage::to_json(level));
  problems.require(storage::json_text(job.reader.manifest().levels) == storage::json_text(expected),
                   "\"levels\" is not what the index adds up to");
}

/// The first key, dotted, whose value is not that of `whole`; "" if there is none.
std::string first_difference(const Json& part, const Json& whole, const std::string& path) {
  if (!part.is_object() || !whole.is_object())
    return storage::json_text(part) == storage::json_text(whole) ? "" : path;
  for (const auto& [key, value] : part.items()) {
    const std::string here = path.empty() ? key : path + '.' + key;
    const auto found = whole.find(key);
    const std::string difference =
        found == whole.end() ? here : first_difference(value, *found, here);
    if (!difference.empty())
      return difference;
  }
  return "";
}

/// Checks that the rest of the manifest agrees with the config. Older programs wrote fewer keys, of
/// which nothing is required.
class ConfigAgreement {
 public:
  ConfigAgreement(const storage::Manifest& manifest, const config::Config& config,
                  const ManifestProblems& problems)
      : manifest_(manifest), config_(config), problems_(problems) {}

  void check() const {
    check_partitions();
    check_compression();
    check_normals();
    check_pictures();
    check_first_sight();
    check_place();
    problems_.compare("licence", manifest_.licence, config_.licence);
  }

 private:
  bool says(const char* pointer) const {
    return manifest_.config.contains(Json::json_pointer(pointer));
  }

  void check_partitions() const {
    const SourceSummary& source = manifest_.source;
    const std::uint64_t most = config::partition_vertices(
        config_, source.places, source.textures ? source.textures->texels : 0);
    const std::uint64_t partitions =
        config_.partition.count.value_or((source.places - 1) / most + 1);
    if (says("/partition/count") || says("/partition/vertices"))
      problems_.compare("partitions", std::uint64_t{manifest_.partition_count}, partitions);
  }

  void check_compression() const {
    if (says("/storage/compression")) {
      problems_.compare("storage.compression", storage::row_of(manifest_.compression).name,
                        storage::row_of(config_.storage.compression).name);
    }
  }

  void check_normals() const {
    const SourceSummary& source = manifest_.source;
    const bool may_have_some = config_.storage.normals != config::Normals::none;
    problems_.require(!manifest_.computed_normals || may_have_some,
                      "\"storage.normals\" are computed, but \"config\" asks for none");
    if (says("/storage/normals")) {
      const bool is_unlit = manifest_.textures && manifest_.textures->unlit;
      const bool needs_normals =
          may_have_some && !source.attributes.normals && source.triangles > 0 && !is_unlit;
      problems_.require(manifest_.computed_normals || !needs_normals,
                        "\"config\" asks for normals, but \"storage.normals\" are not computed");
    }
    problems_.require(!manifest_.normal_maps || config::makes_maps(config_.storage.normals),
                      "there are normal maps, but \"config\" asks for none");
    if (says("/normal_map/format")) {
      problems_.require(
          !manifest_.normal_maps || *manifest_.normal_maps == config_.normal_map.format,
          "\"storage.normal_map\" is not that of \"config.normal_map\"");
    }
  }

  void check_pictures() const {
    if (!says("/texture/format") || !manifest_.textures)
      return;
    // Until version 12 pictures stayed as "texture" says, whatever "storage.normals" was.
    const bool is_as_before =
        !manifest_.has_relief() && manifest_.textures == config_.texture.format;
    problems_.require(*manifest_.textures == config_.picture_format() || is_as_before,
                      "\"storage.texture\" is not that of \"config.texture\"");
    problems_.require(config_.texture.use, "there are textures, but \"config\" asks for none");
  }

  void check_first_sight() const {
    if (says("/preview"))
      problems_.compare("the existence of \"preview\"", manifest_.preview.has_value(),
                        config_.preview);
    const auto standpoint = config_.first_view.standpoint();
    problems_.require(!standpoint || manifest_.first_view == standpoint,
                      "\"first_view\" is not that of \"config\"");
    if (says("/up"))
      problems_.compare("up", name_of(manifest_.up), name_of(config_.up_axis()));
  }

  void check_place() const {
    const BoundsD& bounds = manifest_.source.bounds;
    problems_.require(manifest_.units == (config_.units ? config_.units : manifest_.source.units),
                      "\"units\" are not those of \"config\" or the source");
    if (config_.placement.crs) {
      problems_.require(
          manifest_.transform && config::fits_map(config_, bounds, *manifest_.transform),
          "\"transform\" is not near that of \"config.placement\"");
    } else if (says("/placement")) {
      problems_.require(manifest_.transform == config::tileset_transform(config_, bounds),
                        "\"transform\" is not that of \"config.placement\"");
    }
    if (says("/tileset/pixels")) {
      problems_.require(manifest_.tileset_pixels == config_.tileset.pixels,
                        "\"tileset.pixels\" are not those of \"config\"");
    }
  }

  const storage::Manifest& manifest_;
  const config::Config& config_;
  const ManifestProblems& problems_;
};

/// The config is one that builds, and its values are written as a build writes them.
void check_config(const VerifyJob& job, const ManifestProblems& problems) {
  const storage::Manifest& manifest = job.reader.manifest();
  try {
    const config::Config config = exporting::config_of(manifest);
    const std::string wrong = first_difference(manifest.config, config::resolved_json(config), "");
    problems.require(wrong.empty(), fmt::format("\"config.{}\" is not what a build writes", wrong));
    ConfigAgreement(manifest, config, problems).check();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage)
      throw;
    problems.require(false, error.what());
  }
}

/// Returns how far rounding may move the partitions' box from the input's. Near 0 floats have a
/// smallest step.
double bounds_slack(const storage::Manifest& manifest, const BoundsD& box) {
  const double rounding = manifest.quantization ? manifest.quantization->worst_rounding : 0;
  if (manifest.origin == Vec3d{} && !manifest.source.double_precision)
    return rounding;
  const Vec3d from_origin = box.max - manifest.origin;
  const Vec3d to_origin = box.min - manifest.origin;
  return rounding + 0x1p-23 * std::max(length(from_origin), length(to_origin)) +
         0x1p-50 * length(manifest.origin) + std::numeric_limits<float>::denorm_min();
}

void check_bounds(const VerifyJob& job, const ManifestProblems& problems) {
  const storage::Manifest& manifest = job.reader.manifest();
  BoundsD found;
  for (const TileRecord& record : job.reader.records()) {
    if (!job.tree().is_partition(record.node))
      continue;
    found.add(to_double(record.bounds.min) + manifest.origin);
    found.add(to_double(record.bounds.max) + manifest.origin);
  }
  const double slack = bounds_slack(manifest, found);
  const auto is_near = [&](Vec3d a, Vec3d b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}) <= slack;
  };
  const BoundsD& told = manifest.source.bounds;
  problems.require(is_near(told.min, found.min) && is_near(told.max, found.max),
                   "\"source.bounds\" are not those of the partitions");
}

void check_totals(const VerifyJob& job, const ManifestProblems& problems) {
  const storage::Manifest& manifest = job.reader.manifest();
  std::uint64_t bytes = manifest.index_bytes + manifest.outline_bytes + manifest.tileset_bytes +
                        (manifest.preview ? manifest.preview->bytes : 0) +
                        storage::object_file_bytes(manifest.objects);
  std::uint64_t triangles = 0;
  for (const TileRecord& record : job.reader.records()) {
    bytes += record.file_bytes;
    if (job.tree().is_partition(record.node))
      triangles += std::uint64_t{record.interior_count} + record.drawn_border_count;
  }
  problems.compare("total_bytes", manifest.total_bytes, bytes);
  problems.compare("the number of triangles of the source", manifest.source.triangles, triangles);
}

/// Checks the counts of all files that were imported.
void check_import(const VerifyJob& job, const ManifestProblems& problems) {
  const SourceSummary& source = job.reader.manifest().source;
  if (source.files.empty())
    return;
  std::uint64_t bytes = 0;
  for (const SourceFile& file : source.files)
    bytes += file.bytes;
  problems.compare("source.file_bytes", source.file_bytes, bytes);
}

/// Returns the number of sectors that a config asks for, else the default.
std::uint32_t wanted_sectors(const Json& config) {
  constexpr std::uint64_t kMost = 65536;
  const Json::json_pointer place("/outline/sectors");
  const bool is_told = config.contains(place) && config.at(place).is_number_unsigned();
  const std::uint64_t told = is_told ? config.at(place).get<std::uint64_t>() : 0;
  return told > 0 && told <= kMost ? static_cast<std::uint32_t>(told)
                                   : config::OutlineConfig{}.sectors;
}

}  // namespace

void verify_manifest(const VerifyJob& job) {
  const ManifestProblems problems(job);
  check_form(job, problems);
  check_levels(job, problems);
  check_config(job, problems);
  check_bounds(job, problems);
  check_totals(job, problems);
  check_import(job, problems);
}

void verify_outline(const VerifyJob& job, const Outline& outline) {
  const ManifestProblems problems(job);
  const storage::Manifest& manifest = job.reader.manifest();
  const OutlineReport& told = manifest.outline;
  if (told.sector_level > raw(job.tree().depth())) {
    problems.require(false, "the outline's sectors are of a level that is not there");
  } else {
    const std::uint32_t nodes = job.tree().node_count(static_cast<Level>(told.sector_level));
    const std::uint32_t wanted = wanted_sectors(manifest.config);
    problems.require(
        told.sector_count == nodes || told.sector_count == outline_sectors(nodes, wanted),
        "the outline's sectors are not the nodes of their level, nor equal parts of these");
  }
  problems.require(
      told.polylines_dropped <= told.polylines_found &&
          told.polylines_found - told.polylines_dropped == outline.polyline_count(),
      fmt::format("{} lines found and {} dropped, but the outline has {}", told.polylines_found,
                  told.polylines_dropped, outline.polyline_count()));
  problems.require(told.tolerance >= 0, "the outline's tolerance is negative");
}

void verify_vertex_counts(const VerifyJob& job, const PartitionTotals& found) {
  const ManifestProblems problems(job);
  const SourceSummary& told = job.reader.manifest().source;
  problems.compare("source.vertices", told.vertices, job.tree().vertex_count() + found.copies);
  problems.compare("source.unreferenced_vertices", told.unreferenced_vertices, found.unreferenced);
}

}  // namespace meshhier::verifying
