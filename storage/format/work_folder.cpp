#include "storage/format/work_folder.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"

#include <random>
#include <utility>

namespace meshhier::storage {

WorkFolder::WorkFolder(FileSystem& files, const std::filesystem::path& output)
    : files_(files), path_(verify_scratch_path(output, std::random_device()())) {
  while (!lock_)  // `clean` may take it for one that was left, but not again and again
    lock_ = take_work(files_, path_);
}

WorkFolder::~WorkFolder() {
  try {
    remove_work(files_, path_, std::move(lock_));
  } catch (const Error&) {  // `clean` finds it
  }
}

}  // namespace meshhier::storage
