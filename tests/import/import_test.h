// The common parts of tests of imports: files in the folder "w" of a memory, and their imported
// meshes.
#pragma once

#include "base/error.h"
#include "import/imported.h"
#include "tests/support/error_message.h"
#include "tests/support/memory_files.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::tests {

class ImportTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& content) {
    files_.put(std::filesystem::path("w") / name, content);
  }
  Imported import_file(const std::string& name, const ImportHow& how = {}) {
    return import_files(files_, std::filesystem::path("w") / name, how);
  }
  /// The message of the Error(input) that the import of a file throws; empty if there is none.
  std::string failure_of_file(const std::string& name) {
    return tests::error_message(ErrorCode::input, [&] { import_file(name); });
  }

  MemoryFiles files_;
};

}  // namespace meshhier::tests
