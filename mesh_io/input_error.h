// How every failure of a mesh reader is told: file, place, what was found and what was expected.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// "PATH: MESSAGE".
std::string file_message(const std::filesystem::path& path, const std::string& message);
/// Throws Error(input) that says so.
[[noreturn]] void fail_file(const std::filesystem::path& path, const std::string& message);
/// Throws Error(input): "PATH: byte OFFSET: MESSAGE". The first byte of a file is 0.
[[noreturn]] void fail_at_byte(const std::filesystem::path& path, std::uint64_t offset,
                               const std::string& message);
/// "PATH: line LINE: MESSAGE". The first line of a file is 1.
std::string line_message(const std::filesystem::path& path, std::uint64_t line,
                         const std::string& message);
/// Throws Error(input) that says so.
[[noreturn]] void fail_at_line(const std::filesystem::path& path, std::uint64_t line,
                               const std::string& message);

/// Text of a file made fit for a message: in quotes, at most 40 bytes, '?' for what is not ASCII.
std::string in_quotes(std::string_view text);
/// The same of what should be a number; says so if it has a decimal comma.
std::string number_in_quotes(std::string_view word);

}  // namespace meshhier::mesh_io
