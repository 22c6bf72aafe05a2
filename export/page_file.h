// One HTML file with the viewer and as much of a hierarchy as fits.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/page_story.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace meshhier::exporting {

struct PageOptions {
  std::filesystem::path output;
  bool replace = false;             ///< takes the place of a file that is there
  std::uint64_t size = 15'000'000;  ///< bytes of the file, at the most: what mail takes, where an
                                    ///< attachment grows by a third and 20 to 25 MB are allowed
  std::string link;                 ///< address of the whole hierarchy; empty: none
  std::string name;                 ///< name of the model
  bool looks_for_story = false;     ///< a story beside the hierarchy becomes part of the page
  OpenPicture open_picture{};       ///< opens pictures of the story; required if it looks for one
  std::vector<std::filesystem::path> inputs{};  ///< files and folders that stay, too
};

/// Writes `viewer` (viewer/vite.single.config.ts) with the manifest, the root and more tiles:
/// always both children of the node with the largest error, as long as they fit. Without a link
/// tiles are packed, and where not all fit, their positions are rounded if that is at most half of
/// the error of what is shown, or if the page is nearer to the original that way. Holds a tile and
/// the story. Deterministic. The output appears complete or not at all. Returns lines for people,
/// which say what is in the page, what is not, and what would change that; warns of pictures that
/// are left out. Throws Error(usage) if not even the root fits, Error(exists | io | corrupt), the
/// last for a story that is no JSON object, too.
std::string write_page(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                       const std::string& viewer, const PageOptions& options,
                       execution::Progress& progress, const execution::CancelToken& cancel);

}  // namespace meshhier::exporting
