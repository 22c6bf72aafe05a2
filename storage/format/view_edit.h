// Changes how a finished hierarchy is shown first: the only change that one takes.
//
// The manifest gets another text, and so another checksum, which names the build; no other file is
// touched, and none tells of the view. The new text takes the place of the old one by a rename:
// readers have the one or the other.
#pragma once

#include "hierarchy/model_view.h"
#include "storage/io/file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::storage {

/// Returns a manifest's text with that view instead of its own; none if it is empty. All else stays
/// as it is. Throws as parse_manifest(), and Error(usage) if the view names an attribute that the
/// hierarchy does not have.
std::string with_view(const std::string& manifest_text, const ModelView& view,
                      const std::string& name);

/// Gives a hierarchy's directory that view. Returns the name of the build that it has now. `build`:
/// the one that it must have; none: any. Throws Error(usage) for an archive; Error(locked) if
/// another process is changing it; Error(exists) if it is another build; as with_view(); Error(io).
std::string replace_view(FileSystem& files, const std::filesystem::path& hierarchy,
                         const ModelView& view,
                         const std::optional<std::string>& build = std::nullopt);

}  // namespace meshhier::storage
