// The files that a build writes besides its hierarchy: its account, and the note on its input.
#pragma once

#include "app/build_arguments.h"
#include "app/command.h"
#include "config/config.h"
#include "pipeline/build_report.h"
#include "storage/io/output_file.h"

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <vector>

namespace meshhier::app {

/// All that it is given must outlive it.
class BuildFiles {
 public:
  /// Throws Error(usage) if both would be one file.
  BuildFiles(const BuildArguments& arguments, const config::Config& config,
             const Environment& environment);

  /// To be called before the build. Throws as OutputFile, and Error(exists) for a file in the
  /// note's place that is no note.
  void begin();
  std::vector<std::filesystem::path> paths() const;
  /// Writes them, when all is done: a build that is killed leaves none for an unfinished hierarchy.
  void write(const pipeline::BuildReport& report);
  /// Returns where texts for people go: not to the account's place.
  std::ostream& text_stream() const;

 private:
  const BuildArguments& arguments_;
  const config::Config& config_;
  const Environment& environment_;
  std::optional<storage::OutputFile> stats_;
};

}  // namespace meshhier::app
