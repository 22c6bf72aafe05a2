// Walks the commands and arguments of the parser, in the order in which --help lists them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace meshhier::app {

/// Returns the commands that --help lists.
std::vector<const CLI::App*> commands_of(const CLI::App& parser);

/// All arguments of a command that --help lists, those of its option groups included.
struct Arguments {
  std::vector<const CLI::Option*> positionals;
  std::vector<const CLI::Option*> options;  ///< flags too
};
Arguments arguments_of(const CLI::App& command);

/// Returns the words that an option takes as they are: those of "auto|bar|json|none", or of the
/// check of a value that is one of a few. Words in capitals stand for something else and are left
/// out.
std::vector<std::string> choices_of(const CLI::Option& option);

bool takes_value(const CLI::Option& option);

/// The use of the files that an argument names.
enum class FileUse { none, read, written };
/// Returns an argument's use, by the name of its type, and by its own name if it is written.
/// Requires that `option` belongs to a command that writes: positionals of others may be anything.
FileUse file_use_of(const CLI::Option& option);
/// Returns the paths that arguments of that use were given; addresses are none.
std::vector<std::filesystem::path> files_named(const CLI::App& command, FileUse use);

}  // namespace meshhier::app
