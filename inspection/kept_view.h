// The view that a hierarchy keeps: what it is, and another one in its place.
#pragma once

#include "hierarchy/model_view.h"
#include "storage/io/file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace meshhier::inspection {

/// Returns the view that a hierarchy keeps; empty: none. Throws Error(io | corrupt).
ModelView kept_view(storage::FileSystem& files, const std::filesystem::path& hierarchy);

/// Gives it another one, as storage::replace_view().
void keep_view(storage::FileSystem& files, const std::filesystem::path& hierarchy,
               const ModelView& view);

/// What a link of the page shows, and the keys in it that no view has.
struct LinkedView {
  ModelView view;
  std::vector<std::string> others{};
};
/// `first`: the view that the model is seen first with. Throws Error(usage) if it has no #.
LinkedView view_of_link(const std::string& link, const ModelView& first = {});

/// Returns a view as a config has it, without a line's end: "{}" of none.
std::string view_text(const ModelView& view);

}  // namespace meshhier::inspection
