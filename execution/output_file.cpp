#include "execution/output_file.h"

#include "hierarchy/error.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::execution {

namespace fs = std::filesystem;

void require_place(storage::FileSystem& files, const fs::path& output) {
  if (output.filename().empty() || output.filename() == "." || output.filename() == "..") {
    throw Error(ErrorCode::usage,
                fmt::format("output \"{}\": expected the name of a file", output.string()));
  }
  const fs::path directory = output.parent_path();
  if (directory.empty() || files.exists(directory))
    return;
  throw Error(ErrorCode::io, fmt::format("cannot write {}: there is no directory {}",
                                         output.string(), directory.string()));
}

void require_apart(storage::FileSystem& files, const fs::path& output, const fs::path& directory,
                   const std::string& what) {
  const fs::path file = files.canonical(output);
  const fs::path read = files.canonical(directory);
  if (std::mismatch(read.begin(), read.end(), file.begin(), file.end()).first != read.end())
    return;
  throw Error(ErrorCode::usage, fmt::format("the output {} lies in {} {}", output.string(), what,
                                            directory.string()));
}

}  // namespace meshhier::execution
