// What a file holds, by its content: what the rows of formats.h look at.
#pragma once

#include "mesh_io/formats.h"
#include "storage/io/file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// The start of a file, unpacked, and what was found out of it.
class MeshContent {
 public:
  /// `file` must outlive this. Throws Error(io), and Error(input) if it is damaged gzip.
  explicit MeshContent(const storage::File& file);

  const storage::File& file() const { return file_; }
  bool is_gzip() const { return is_gzip_; }
  /// At most 64 KiB: comments may come before the first word of a text, some have licences there.
  std::string_view start() const { return start_; }
  /// The first word that is in no comment.
  std::string_view first_word() const;
  /// Whether all is text, up to zeros that fill it up.
  bool is_text() const;
  bool begins_as_object() const;
  /// Which of both an object of JSON is, wherever the keys stand that tell: a glTF has meshes or
  /// what belongs to them; a tileset a "root" beside its "asset", or a geometric error. One without
  /// any is a glTF if its first key is one of glTF's. It is read up to these keys, once.
  std::optional<MeshKind> kind_of_json();
  /// The bytes that it has as a binary STL, by the count of its facets.
  std::optional<std::uint64_t> stl_bytes() const;

 private:
  std::optional<MeshKind> look_into_json() const;

  const storage::File& file_;
  bool is_gzip_;
  std::string start_;
  std::optional<std::optional<MeshKind>> kind_of_json_;
};

/// As a PLY begins, also behind blanks or in capitals.
bool begins_as_ply(std::string_view start);
/// A binary STL has the size that its count of facets says. Where that cannot be told (it is
/// packed), or where more follows, it is likely if the first bytes are no text, and if its first
/// facets have numbers as meshes have.
Certainty look_for_binary_stl(MeshContent& content);

}  // namespace meshhier::mesh_io
