#include "inspection/kept_view.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/format/archive_files.h"
#include "storage/format/load_manifest.h"
#include "storage/format/view_edit.h"
#include "storage/format/view_keys.h"
#include "storage/format/view_link.h"
#include "storage/io/json_text.h"

#include <cstddef>

#include <fmt/format.h>

namespace meshhier::inspection {

ModelView kept_view(storage::FileSystem& files, const std::filesystem::path& hierarchy) {
  const storage::HierarchyFiles place(files, hierarchy);
  return storage::load_manifest(place.files(), hierarchy).view;
}

void keep_view(storage::FileSystem& files, const std::filesystem::path& hierarchy,
               const ModelView& view) {
  storage::replace_view(files, hierarchy, view);
}

LinkedView view_of_link(const std::string& link, const ModelView& first) {
  constexpr std::size_t kShownBytes = 200;
  if (const auto read = storage::parse_view_link(link))
    return {storage::over_first(*read, first), read->others};
  throw Error(
      ErrorCode::usage,
      fmt::format("--link: expected an address of the page with a #, or the part from there "
                  "on, found \"{}\"",
                  plain_text(link, kShownBytes)));
}

std::string view_text(const ModelView& view) {
  return storage::json_text(storage::view_json(view), {.indent = 2});
}

}  // namespace meshhier::inspection
