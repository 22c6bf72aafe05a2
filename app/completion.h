// The suggestions of a shell for the word that is being typed. They are found by walking the
// parser, so that no list can fall behind it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace meshhier::app {

struct Suggestion {
  std::string word;
  std::string meaning;  ///< one line; may be empty
};

struct Completion {
  std::vector<Suggestion> suggestions;  ///< all begin with the word that is being typed
  bool takes_files = false;             ///< files may stand here, too
};

/// Returns the suggestions. `words`: those behind the program's name up to the cursor; the last
/// one, perhaps empty, is being typed.
Completion complete(const CLI::App& parser, const std::vector<std::string>& words);

}  // namespace meshhier::app
