#include "storage/work_directory.h"

#include "hierarchy/error.h"
#include "storage/layout.h"

#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {

bool check_output(FileSystem& files, const std::filesystem::path& output, bool replace,
                  const char* state) {
  if (!files.exists(output))
    return false;
  if (!replace) {
    throw Error(ErrorCode::exists,
                fmt::format("{} {}; --force replaces it", output.string(), state));
  }
  if (!files.exists(manifest_path(output))) {
    throw Error(ErrorCode::exists,
                fmt::format("{} is not a hierarchy (it has no {}), so --force does not replace it",
                            output.string(), manifest_path({}).string()));
  }
  return true;
}

WorkDirectory::WorkDirectory(FileSystem& files, std::filesystem::path output, bool replace)
    : files_(files),
      output_(std::move(output)),
      path_(work_path(output_)),
      temporary_(temporary_path(path_)),
      replace_(replace) {
  check_output(files_, output_, replace_);
  for (auto parent = output_.parent_path(); !parent.empty() && !files_.exists(parent);
       parent = parent.parent_path()) {
    made_parent_ = parent;
  }
  files_.remove_all(path_);
  files_.make_directories(temporary_);
}

WorkDirectory::~WorkDirectory() {
  if (published_)
    return;
  try {
    files_.remove_all(path_);
    if (!made_parent_.empty() && files_.list(made_parent_).empty())
      files_.remove_all(made_parent_);
  } catch (const Error&) {  // the failure that brought us here is the one to report
  }
}

void WorkDirectory::publish() {
  files_.remove_all(temporary_);
  files_.sync_tree(path_);
  const std::filesystem::path old = replaced_path(output_);
  const bool replacing = check_output(files_, output_, replace_, "appeared during the build");
  if (replacing) {
    files_.remove_all(old);
    files_.rename(output_, old);
  }
  bool renamed = false;
  try {
    files_.rename(path_, output_);
    renamed = true;
    files_.sync_tree(output_);
  } catch (const Error&) {
    if (renamed)
      files_.rename(output_, path_);
    if (replacing)
      files_.rename(old, output_);
    throw;
  }
  published_ = true;
  files_.remove_all(old);
}

}  // namespace meshhier::storage
