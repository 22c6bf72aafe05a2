// One side of a comparison: a hierarchy, or a mesh, of which one is built for as long as it takes.
#pragma once

#include "app/command.h"
#include "app/hierarchy_place.h"
#include "compare/compare.h"
#include "execution/progress.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::app {

class ComparedHierarchy {
 public:
  /// A hierarchy of a mesh lies in TMPDIR, else /tmp, until the end of this object. All must
  /// outlive it. Throws as HierarchyPlace, config::load_named() and pipeline::build_hierarchy().
  ComparedHierarchy(Environment& environment, const std::string& name, const WebOptions& web,
                    std::uint64_t memory_budget, execution::Progress& progress);

  comparing::ComparedPlace place() const;
  /// All files that were read: the hierarchy, or the mesh and the files that belong to it.
  const std::vector<std::filesystem::path>& read() const { return read_; }
  /// Returns HierarchyPlace::account().
  std::string account() const { return given_.account(); }

 private:
  /// A temporary folder that goes with its object.
  class BuiltFolder {
   public:
    BuiltFolder();
    BuiltFolder(const BuiltFolder&) = delete;
    BuiltFolder& operator=(const BuiltFolder&) = delete;
    ~BuiltFolder();
    std::filesystem::path hierarchy() const { return path_ / "mesh.hier"; }

   private:
    std::filesystem::path path_;
  };

  void build(const std::string& mesh, std::uint64_t memory_budget, execution::Progress& progress);

  Environment& environment_;
  HierarchyPlace given_;
  std::optional<BuiltFolder> folder_;  ///< only if a hierarchy was built
  std::vector<std::filesystem::path> read_;
};

}  // namespace meshhier::app
