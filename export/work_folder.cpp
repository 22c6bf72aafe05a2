#include "export/work_folder.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"

#include <random>

namespace meshhier::exporting {

WorkFolder::WorkFolder(storage::FileSystem& files, const std::filesystem::path& output)
    : files_(files), path_(storage::verify_scratch_path(output, std::random_device()())) {
  files_.make_directories(path_);
}

WorkFolder::~WorkFolder() {
  try {
    files_.remove_all(path_);
  } catch (const Error&) {  // `clean` finds it
  }
}

}  // namespace meshhier::exporting
