// Whether a build is due: what is there already may be what it would make.
#pragma once

#include "config/config.h"
#include "pipeline/plan/stage_context.h"
#include "storage/io/file.h"

#include <filesystem>
#include <string>

namespace meshhier::pipeline {

/// Returns the place of the note on the input of a config's output: beside that, hidden.
std::filesystem::path input_note_path(const config::Config& config, storage::FileSystem& files);

/// Returns why a build is due, in words that follow "is built, as "; empty if the output was made
/// of the input by the config and this program. `note`: what the build of it noted of its input,
/// and is to be read; it gets the times of files that were touched and are the same.
///
/// Reads the manifest, the index, what the input's files name, and files that were touched since.
/// Without a note, only a PLY that is read in place can be known, by reading it. Throws
/// Error(exists) if what is there is nothing that a build with `force` would replace, and as
/// open_input().
std::string reason_to_build(const config::Config& config, const std::filesystem::path& note,
                            const BuildEnvironment& environment);

}  // namespace meshhier::pipeline
