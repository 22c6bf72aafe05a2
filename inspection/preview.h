// Draws a picture of any level or cut of a hierarchy, tile by tile.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "export/cut_by_error.h"
#include "hierarchy/frame.h"
#include "hierarchy/ids.h"
#include "hierarchy/standpoint.h"
#include "hierarchy/texture.h"
#include "inspection/object_colours.h"
#include "render/attribute_painter.h"
#include "storage/io/file.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

namespace meshhier::inspection {

using render::AttributeColours;

/// The part that is drawn: a level, the cut in a text file, or tiles by their error.
using PreviewSelection = std::variant<Level, std::filesystem::path, exporting::LargestError>;

inline constexpr std::uint32_t kMostPreviewPixels = 8192;  ///< the longest side

struct PreviewOptions {
  std::filesystem::path output;
  bool replace = false;
  ImageFormat format = ImageFormat::png;      ///< png or webp
  std::uint32_t width = 1600, height = 1000;  ///< 1 to kMostPreviewPixels
  /// None: a cut whose errors are a quarter of a pixel at most.
  std::optional<PreviewSelection> selection;
  std::optional<Standpoint> view;  ///< none: the first view
  /// A link of the page, whose view is drawn; empty: the hierarchy's own.
  std::string link{};
  std::optional<UpAxis> up;                               ///< none: as the hierarchy says
  std::optional<std::array<std::uint8_t, 3>> background;  ///< none: transparent
  std::optional<AttributeColours> attribute{};  ///< none: colours and pictures of the input
  /// Colours by a property of objects; not with `attribute`.
  std::optional<ObjectColouring> objects{};
  exporting::RegionRequest region{};  ///< the picture shows this piece alone
  std::uint64_t memory_budget = std::uint64_t{1} << 30;
};

/// Writes the picture and returns a text that says what it shows, and what colours of objects mean.
/// The output appears complete or not at all. Throws Error(usage | exists | input | io | corrupt),
/// and Error(budget) if the picture does not fit the memory.
std::string make_picture(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                         const PreviewOptions& options, execution::Progress& progress,
                         const execution::CancelToken& cancel);

}  // namespace meshhier::inspection
