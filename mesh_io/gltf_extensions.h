// Extensions that a glTF file may require.
#pragma once

#include <span>
#include <string_view>

namespace meshhier::mesh_io {

struct GltfExtension {
  std::string_view name;  ///< one that ends in "_" stands for all that begin so
  std::string_view reason;
};

/// Those that are read, with what they are.
std::span<const GltfExtension> read_extensions();
/// Those that are passed over, as they change nothing of the triangles, their places, colours and
/// pictures; with what they change.
std::span<const GltfExtension> harmless_extensions();

/// Whether it is one of these. A file that requires another one may mean something else than what
/// would be read of it.
bool may_be_required(std::string_view extension);

}  // namespace meshhier::mesh_io
