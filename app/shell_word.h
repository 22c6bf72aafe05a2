// Words of a command line as a person would type them.
#pragma once

#include <string>
#include <string_view>

namespace meshhier::app {

/// `word` as a shell reads it back: as it is if it is plain, else in quotes. Control characters
/// are escaped ($'...' of bash and zsh), so that a terminal shows them.
std::string shell_word(std::string_view word);

}  // namespace meshhier::app
