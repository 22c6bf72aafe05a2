// Whether a build is due: what is there already may be what it would make.
#pragma once

#include "config/config.h"
#include "pipeline/plan/stage_context.h"
#include "storage/io/file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::pipeline {

/// Returns the place of the note on the input of a config's output: beside that, hidden.
std::filesystem::path input_note_path(const config::Config& config, storage::FileSystem& files);

/// Returns where a note of that name lies: behind a link, unless it is in the place of
/// input_note_path(), where nobody has named it, and a link may be anybody's.
std::filesystem::path followed_note(const config::Config& config,
                                    const std::filesystem::path& named, storage::FileSystem& files);

/// Returns the state of the hierarchy in the place of a config's output: another one as soon as it
/// is made anew. Nothing if there is none. Throws Error(io).
std::optional<storage::FileIdentity> state_of_output(const config::Config& config,
                                                     storage::FileSystem& files);

/// Returns why a build is due, in words that follow "is built, as "; empty if the output was made
/// of the input by the config and this program. `named`: the file of what the build of it noted of
/// its input, as followed_note() has it; it gets the times of files that were touched and are the
/// same.
///
/// Reads the manifest, the index, what the input's files name, and files that were touched since.
/// Without a note, only a PLY that is read in place can be known, by reading it. Throws
/// Error(exists) if what is there is nothing that a build with `force` would replace, and as
/// open_input().
std::string reason_to_build(const config::Config& config, const std::filesystem::path& named,
                            const BuildEnvironment& environment);

}  // namespace meshhier::pipeline
