#include "app/viewer_place.h"

#include "base/error.h"
#include "storage/io/own_program.h"

#include <array>
#include <vector>

#include <fmt/format.h>

namespace meshhier::app {

namespace {

// The places seen from the directory of the program: installed, and built in build/PRESET.
constexpr std::array kPlaces{"../share/meshhier/viewer", "../../viewer/dist/page"};

constexpr const char* kRemedy =
    "The Debian package and the portable program have it. In the source tree, \"npm ci && npm run "
    "build\" in viewer/ makes it, and scripts/install puts it in place. --viewer names another "
    "folder that has it.";

bool has_page(storage::FileSystem& files, const std::filesystem::path& directory) {
  return files.exists(directory / "index.html");
}

}  // namespace

std::string page_without_viewer() {
  return fmt::format("The viewer's page is missing. {} {}", kRemedy, kServedWithoutPage);
}

ViewerPlace find_viewer(storage::FileSystem& files, const std::filesystem::path& asked) {
  if (!asked.empty()) {
    if (!has_page(files, asked)) {
      throw Error(ErrorCode::io,
                  fmt::format("--viewer {}: it has no index.html; \"npm ci && npm run "
                              "build\" in viewer/ makes viewer/dist/page",
                              asked.string()));
    }
    return {storage::open_folder(asked), {}};
  }
  const std::filesystem::path program = storage::own_directory();
  std::vector<std::string> looked_in;
  for (const char* place : kPlaces) {
    const std::filesystem::path directory = (program / place).lexically_normal();
    if (has_page(files, directory))
      return {storage::open_folder(directory), {}};
    looked_in.push_back(directory.string());
  }
  return {nullptr,
          fmt::format("The viewer's page is missing: there is no index.html in {} or {}. {}",
                      looked_in[0], looked_in[1], kRemedy)};
}

}  // namespace meshhier::app
