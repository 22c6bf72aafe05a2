// The one way in which mesh readers tell of failures: file, place, what was found and what was
// expected.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// Returns "PATH: MESSAGE".
std::string file_message(const std::filesystem::path& path, const std::string& message);
/// Throws Error(input) with that message.
[[noreturn]] void fail_file(const std::filesystem::path& path, const std::string& message);
/// Throws Error(input): "PATH: byte OFFSET: MESSAGE". The first byte of a file is 0.
[[noreturn]] void fail_at_byte(const std::filesystem::path& path, std::uint64_t offset,
                               const std::string& message);
/// Returns "PATH: line LINE: MESSAGE". The first line of a file is 1.
std::string line_message(const std::filesystem::path& path, std::uint64_t line,
                         const std::string& message);
/// Throws Error(input) with that message.
[[noreturn]] void fail_at_line(const std::filesystem::path& path, std::uint64_t line,
                               const std::string& message);

/// Makes text of a file fit for a message: in quotes, at most 40 bytes, '?' for all that is not
/// ASCII.
std::string in_quotes(std::string_view text);
/// Does the same for a word that should be a number; tells if it has a decimal comma.
std::string number_in_quotes(std::string_view word);

}  // namespace meshhier::mesh_io
