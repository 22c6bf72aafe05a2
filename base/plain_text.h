// Text that nobody vouches for, made fit for a message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace meshhier {

/// `text` on one line, which a terminal shows as it is: control characters become '?'; of more than
/// `most_bytes` the beginning and "..." remain, cut between UTF-8 characters.
std::string plain_text(std::string_view text, std::size_t most_bytes);

/// The singular of English words that count things: "split vertex" of "split vertices". Words end
/// in "ices", "ies" or "s", or have no plural.
std::string singular(std::string_view words);

/// "1 vertex", "2 vertices".
std::string counted(std::uint64_t count, std::string_view plural);

/// "600 vertices", "600 vertices at 578 places" if some lie where others do.
std::string counted_vertices(std::uint64_t vertices, std::uint64_t places);

/// Makes a JSON library's message about a text that is none fit for people: "line 3, column 5:
/// syntax error ..." of "[json.exception.parse_error.101] parse error at line 3, column 5: syntax
/// error ...".
std::string json_fault(std::string_view message);

}  // namespace meshhier
