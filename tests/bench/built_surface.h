// Hierarchies to measure.
#pragma once

#include "bench/generator.h"
#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <memory>

namespace meshhier::bench {

/// A built hierarchy of a generated surface, in 11 partitions: some nodes are early.
class BuiltSurface {
 public:
  explicit BuiltSurface(const SurfaceOptions& surface,
                        config::Normals normals = config::Normals::smooth) {
    const auto path = directory_.path() / "mesh.ply";
    write_ply(*files_, {path}, *make_surface(surface));
    config::Config config = tests::quick_config();
    config.input = path;
    config.output = directory_.path() / "mesh.hier";
    config.partition.count = 11;
    config.simplify.vertices = 300;
    config.storage.normals = normals;
    execution::NoProgress progress;
    const execution::CancelToken cancel;
    pipeline::build_hierarchy(config, {}, {*files_, progress, cancel});
    reader_ = std::make_unique<storage::HierarchyReader>(*files_, config.output);
  }

  const storage::HierarchyReader& reader() const { return *reader_; }

 private:
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::unique_ptr<storage::HierarchyReader> reader_;
};

}  // namespace meshhier::bench
