// The content of a file as the rows of formats.h look at it, to recognise its format.
#pragma once

#include "mesh_io/formats.h"
#include "storage/io/file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// The start of a file, unpacked, and facts that rows find out from it. For one thread.
class MeshContent {
 public:
  /// `file` must outlive this. Throws Error(io), and Error(input) if it is damaged gzip.
  explicit MeshContent(const storage::File& file);

  const storage::File& file() const { return file_; }
  bool is_gzip() const { return is_gzip_; }
  /// Returns at most 64 KiB: comments may come before the first word of a text, some have licences
  /// there.
  std::string_view start() const { return start_; }
  /// Returns the first word that is in no comment.
  std::string_view first_word() const;
  /// Returns whether the start is text, up to zeros that fill it up.
  bool is_text() const;
  bool begins_as_object() const;
  /// Returns whether an object of JSON is a glTF or a tileset, wherever the keys stand that tell: a
  /// glTF has meshes or lists that belong to them; a tileset has a "root" beside its "asset", or a
  /// geometric error. An object without any is a glTF if its first key is one of glTF's. The file
  /// is read up to these keys, once.
  std::optional<MeshKind> kind_of_json();
  /// Returns the bytes that the file would have as a binary STL, by the count of its facets.
  std::optional<std::uint64_t> stl_bytes() const;

 private:
  std::optional<MeshKind> look_into_json() const;

  const storage::File& file_;
  bool is_gzip_;
  std::string start_;
  std::optional<std::optional<MeshKind>> kind_of_json_;
};

/// Returns whether a text begins as a PLY does, also behind blanks or in capitals.
bool begins_as_ply(std::string_view start);
/// Looks for a binary STL, which has the size that its count of facets says. Where that cannot be
/// told (it is packed), or where more follows, it is likely if the first bytes are no text, and if
/// its first facets have numbers as meshes have.
Certainty look_for_binary_stl(MeshContent& content);
/// Files of SRTM have no mark: "N53E027.hgt.gz" is known by its name.
bool is_packed_hgt(const MeshContent& content);

}  // namespace meshhier::mesh_io
