#include "storage/format/load_manifest.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/format/sealed_json.h"
#include "storage/io/file.h"

#include <fmt/format.h>

namespace meshhier::storage {

void require_manifest(FileSystem& files, const std::filesystem::path& hierarchy) {
  const std::filesystem::path path = manifest_path(hierarchy);
  if (files.exists(path))
    return;
  throw Error(ErrorCode::io, fmt::format("{}: not a hierarchy: there is no {}", hierarchy.string(),
                                         files.exists(hierarchy) ? path.filename().string()
                                                                 : "such file or directory"));
}

Manifest load_manifest(FileSystem& files, const std::filesystem::path& hierarchy) {
  require_manifest(files, hierarchy);
  const std::filesystem::path path = manifest_path(hierarchy);
  return parse_manifest(read_sealed_text(*files.open(path)), path.string());
}

}  // namespace meshhier::storage
