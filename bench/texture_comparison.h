// Measures how far pictures of each level of a textured hierarchy are from pictures of its input,
// seen from where the level's error is one pixel (as Lindstrom & Turk, Image-driven simplification,
// 2000, measure meshes).
#pragma once

#include "bench/level_pictures.h"
#include "bench/textured_mesh.h"
#include "hierarchy/ids.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::bench {

struct TextureOptions {
  std::optional<Level> level{};  ///< none: all
  std::uint32_t size = 1024;     ///< largest side of a picture, pixels; larger ones show the middle
  std::uint32_t views = 6;       ///< from all around, at least one
};

struct TextureRow {
  Level level{};
  double error = 0;  ///< the largest of its tiles
  double texel = 0;  ///< mean side of its pictures' texels on the surface, weighted by triangles
  double pixel = 0;  ///< the length of a pixel: the error, but no less than a texel of the input
  std::uint32_t width = 0, height = 0;  ///< size of the largest of its views
  /// Peak signal-to-noise ratio of sRGB values over all pixels that both cover whole; the least of
  /// the views, and their mean. None if they share no pixel; infinite if all are equal.
  std::optional<double> least{}, mean{};
};

struct TextureComparison {
  TextureOptions options;
  double input_texel = 0;
  std::vector<TextureRow> rows;
};

/// Draws both with the same samples: as many that one covers two texels of the input at most, as
/// far as a picture may have that many. Unlit. `input`: relative to the hierarchy's origin. `sink`,
/// if there is one, gets pictures of the input and of the level side by side. Parallel by views; a
/// pure function of hierarchy, input and options. Throws Error(usage) if there is no such level, or
/// if the hierarchy has no textures, Error(io | corrupt | input).
TextureComparison compare_textures(const storage::HierarchyReader& reader,
                                   const TexturedMesh& input, const TextureOptions& options,
                                   const std::function<void(const NamedPicture&)>& sink = {});

/// Returns decibels; none without pixels, infinite if there is no difference. Pictures of one size
/// and 4 channels.
std::optional<double> peak_ratio(const images::Image& a, const images::Image& b);

/// A table in Markdown below a heading.
std::string markdown(const std::string& name, const TextureComparison& comparison);
/// Returns one object, for programs; a ratio that is none or infinite is null.
std::string json_text(const std::string& name, const TextureComparison& comparison);

}  // namespace meshhier::bench
