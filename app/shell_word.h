// Words of a command line as a person would type them.
#pragma once

#include <string>
#include <string_view>

namespace meshhier::app {

/// Returns a text that a shell reads back as `word`: the word itself if it is plain, else in
/// quotes. Control characters are escaped ($'...' of bash and zsh), so that a terminal shows them.
std::string shell_word(std::string_view word);

}  // namespace meshhier::app
