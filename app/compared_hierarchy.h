// What compare is given: a hierarchy, or a mesh, of which one is built for as long as it takes.
#pragma once

#include "app/command.h"
#include "app/hierarchy_place.h"
#include "execution/progress.h"
#include "inspection/compare.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::app {

class ComparedHierarchy {
 public:
  /// A hierarchy of a mesh lies in TMPDIR, else /tmp, until the end of this object. All must
  /// outlive it. Throws as HierarchyPlace, config::load_named() and pipeline::build_hierarchy().
  ComparedHierarchy(Environment& environment, const std::string& name, const WebOptions& web,
                    std::uint64_t memory_budget, execution::Progress& progress);
  ComparedHierarchy(const ComparedHierarchy&) = delete;
  ComparedHierarchy& operator=(const ComparedHierarchy&) = delete;
  ~ComparedHierarchy();

  inspection::ComparedPlace place() const;
  /// As HierarchyPlace.
  std::string account() const { return given_.account(); }

 private:
  void build(const std::string& mesh, std::uint64_t memory_budget, execution::Progress& progress);

  Environment& environment_;
  HierarchyPlace given_;
  std::optional<std::filesystem::path> folder_;  ///< of what was built
};

}  // namespace meshhier::app
