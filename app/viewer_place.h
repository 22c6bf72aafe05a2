// Where the viewer's page lies.
#pragma once

#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <filesystem>
#include <memory>
#include <string>

namespace meshhier::app {

struct ViewerPlace {
  std::unique_ptr<storage::Folder> folder;  ///< null: it is nowhere
  std::string missing;                      ///< then what is missing, and what makes it
};

/// `asked`: --viewer; empty: where scripts/install puts the page, or else where the source tree of
/// this program has it. Throws Error(io) if `asked` has no page.
ViewerPlace find_viewer(storage::FileSystem& files, const std::filesystem::path& asked);

/// What a server does all the same.
inline constexpr const char* kServedWithoutPage =
    "models.json and the models' files are served without it.";

/// The same for who asks a server for the page: not where things lie on this machine.
std::string page_without_viewer();

}  // namespace meshhier::app
