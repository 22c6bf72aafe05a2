// The JSON of a file of any size, character by character, for a parser that keeps nothing.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::mesh_io {

/// The characters of the JSON of a glTF, GLB or other file. Texts are cut to 8 KiB, and the JSON
/// ends at a number or word that is longer than 1 KiB, so no token takes much memory.
class JsonCharacters {
 public:
  explicit JsonCharacters(InputStream& stream);

  /// Returns the next character; -1 at the end. Throws as InputStream::read().
  int next();

 private:
  int next_stored();
  bool load();

  InputStream& stream_;
  std::uint64_t left_ = UINT64_MAX;  ///< bytes left of the JSON chunk of a GLB
  std::vector<std::byte> block_;
  std::size_t at_ = 0;
  bool in_text_ = false, escaped_ = false, kept_ = false;
  std::size_t token_ = 0;
};

}  // namespace meshhier::mesh_io
