// Commands that make a file of one hierarchy: they end alike.
#pragma once

#include "app/command.h"
#include "app/hierarchy_place.h"
#include "execution/progress.h"

#include <functional>
#include <string>
#include <vector>

namespace meshhier::app {

/// What such a command reads and writes.
struct FileJob {
  const std::string& hierarchy;
  const WebOptions& web;
  std::vector<std::string> outputs;  ///< one or two, the main one first; empty names are none
};

/// Makes the files and returns a text for people.
using MakeFile = std::function<std::string(const HierarchyPlace& place, execution::Progress&)>;

/// Opens the hierarchy, calls `make`, and tells its text and what was fetched: on standard output
/// unless that is an output. Returns 0. Throws Error(usage) if an output would be shown on a
/// terminal, and what HierarchyPlace and `make` throw.
int write_file(const FileJob& job, execution::ProgressMode mode, Environment& environment,
               const MakeFile& make);

}  // namespace meshhier::app
