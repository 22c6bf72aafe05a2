// Finds the viewer's page.
#pragma once

#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <filesystem>
#include <memory>
#include <string>

namespace meshhier::app {

struct ViewerPlace {
  std::unique_ptr<storage::Folder> folder;  ///< null: it is nowhere
  std::string missing;                      ///< then says what is missing, and what makes it
};

/// Finds the page. `asked`: --viewer; if it is empty, the page is where scripts/install puts it, or
/// else where the source tree of this program has it. Throws Error(io) if `asked` has no page.
ViewerPlace find_viewer(storage::FileSystem& files, const std::filesystem::path& asked);

/// Says what a server does all the same.
inline constexpr const char* kServedWithoutPage =
    "models.json and the models' files are served without it.";

/// Returns the text for those who ask a server for a missing page: it does not tell where things
/// lie on this machine.
std::string page_without_viewer();

}  // namespace meshhier::app
