// Text that nobody vouches for, made fit for a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace meshhier {

/// `text` on one line, which a terminal shows as it is: control characters become '?'; of more than
/// `most_bytes` the beginning and "..." remain, cut between UTF-8 characters.
std::string plain_text(std::string_view text, std::size_t most_bytes);

}  // namespace meshhier
