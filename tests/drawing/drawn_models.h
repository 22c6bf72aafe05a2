// Small hierarchies on the disk, and drawings of them.
#pragma once

#include "base/error.h"
#include "config/config.h"
#include "drawing/drawing.h"
#include "pipeline/build.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace meshhier::drawing {

class DrawnModels : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return directory_.path() / name; }

  void build(const tests::TestMesh& mesh, std::optional<Unit> unit = Unit::m,
             UpAxis up = UpAxis::z) {
    tests::write_ply(mesh, path("mesh.ply"));
    config::Config config = tests::quick_config();
    config.input = path("mesh.ply");
    config.output = path("mesh.hier");
    config.up = up;
    config.units = unit;
    config.partition.vertices = 150;
    build(config);
  }
  void build(const config::Config& config) {
    execution::NoProgress progress;
    pipeline::build_hierarchy(config, {.force = true},
                              {*files_, progress, execution::CancelToken()});
  }

  /// Returns what the drawing says for people.
  std::string make(DrawingOptions options, const std::string& name) {
    options.output = path(name);
    options.format = name.substr(name.rfind('.') + 1);
    options.replace = true;
    execution::NoProgress progress;
    return draw(*files_, path("mesh.hier"), options, progress, execution::CancelToken());
  }
  /// Returns the file.
  std::string drawn(const DrawingOptions& options, const std::string& name) {
    make(options, name);
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string refusal(const DrawingOptions& options, const std::string& name,
                      ErrorCode code = ErrorCode::usage) {
    try {
      make(options, name);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_FALSE(std::filesystem::exists(path(name)));
      return error.what();
    }
    ADD_FAILURE() << "nothing failed";
    return "";
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

}  // namespace meshhier::drawing
