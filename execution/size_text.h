// Sizes and times as people write them: "512MiB", "1.5 GiB", "3.2 s".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::execution {

/// Parses a number of bytes: a decimal number, perhaps with a fraction, and a unit or none (bytes).
/// Units: B; KiB MiB GiB TiB and K M G T, powers of 1024; kB MB GB TB, powers of 1000; case does
/// not matter, spaces may stand between. A fraction of a byte is cut off. Returns nothing if the
/// text is anything else, negative, or 2^53 bytes (8 PiB) and more.
std::optional<std::uint64_t> parse_size(std::string_view text);

/// The syntax of parse_size(), for error messages.
inline constexpr std::string_view kSizeSyntax =
    R"(a size such as "512MiB" or "2GiB", or a number of bytes)";

/// Returns a text that parse_size() reads back exactly, in MB or the largest binary unit that
/// divides it: "1GiB", "1536MiB", "5MB", "1000". Requires less than 2^53 bytes.
std::string exact_size_text(std::uint64_t bytes);

/// Returns a size for people, in three digits: "1.46 GiB", "980 B".
std::string rounded_size_text(std::uint64_t bytes);

/// Returns a time for people: "3.2 s", "1 min 30 s", "2 h 00 min".
std::string duration_text(double seconds);

}  // namespace meshhier::execution
