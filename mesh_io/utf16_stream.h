// Texts in UTF-16 as UTF-8.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// Hands on the content of another stream: in UTF-8 without the mark, if that begins with the byte
/// order mark of UTF-16; else as it is. Halves of characters become U+FFFD. Throws Error(input) if
/// a UTF-16 text has an odd number of bytes.
class Utf16Stream final : public InputStream {
 public:
  /// Both must outlive it; `path`: for messages.
  Utf16Stream(InputStream& stream, const std::filesystem::path& path);

  std::size_t read(std::span<std::byte> to) override;

 private:
  void fill();
  void append(char32_t character);

  InputStream& stream_;
  const std::filesystem::path& path_;
  bool is_utf16_ = false;
  bool is_big_endian_ = false;
  std::vector<std::byte> ready_;  ///< to be handed out, from taken_ on
  std::size_t taken_ = 0;
  std::optional<char32_t> high_;  ///< the first half of a character
};

}  // namespace meshhier::mesh_io
