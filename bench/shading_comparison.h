// Measures how far the shading of each level is from that of the original, in pictures (as
// Lindstrom & Turk, Image-driven simplification, 2000, measure meshes).
#pragma once

#include "bench/level_pictures.h"
#include "hierarchy/ids.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::bench {

struct ShadingOptions {
  std::optional<Level> level{};  ///< none: all
  std::uint32_t size = 512;      ///< side of a picture, pixels, 1 to render::kMostPixels
  std::uint32_t views = 6;       ///< from all around, at least one
};

/// The difference between pictures of a level and of the original, over the pixels that both cover.
struct ShadingDifference {
  double degrees = 0;    ///< mean angle between the normals of a sample
  double luminance = 0;  ///< root mean square difference of pixels, in steps of 0 to 255
};

struct ShadingRow {
  Level level{};
  std::uint64_t triangles = 0;
  ShadingDifference own;     ///< drawn with the tiles' own normals
  ShadingDifference facets;  ///< drawn with those of facets
};

struct ShadingComparison {
  /// The origin of normals of the original and the levels: "computed", "given", or "none", facets.
  std::string normals;
  ShadingOptions options;
  std::vector<ShadingRow> rows;
};

/// Compares each level with the last one, the partitions, drawn with its own normals. Colours are
/// left out. `sink`, if there is one, gets the pictures view by view. Parallel by views, with 100
/// bytes a sample and four samples a pixel for each that is in flight; a pure function of hierarchy
/// and options. Throws Error(usage) if there is no such level, Error(io | corrupt).
ShadingComparison compare_shading(const storage::HierarchyReader& reader,
                                  const ShadingOptions& options,
                                  const std::function<void(const NamedPicture&)>& sink = {});

/// A table in Markdown below a heading.
std::string markdown(const std::string& name, const ShadingComparison& comparison);
/// Returns one object, for programs.
std::string json_text(const std::string& name, const ShadingComparison& comparison);

}  // namespace meshhier::bench
