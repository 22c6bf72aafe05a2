// Files that operating systems and unpackers leave in folders: they do not belong to a hierarchy,
// and do no harm.
#pragma once

#include <string_view>

namespace meshhier::storage {

/// Whether a file or directory of that relative name ("tiles/.DS_Store") is one that a file
/// manager, a network file system or an unpacker makes by itself: `.DS_Store`, `Thumbs.db`,
/// `desktop.ini`, `._NAME`, `.nfs0123abcd`; what is below `__MACOSX`, `@eaDir`, `.AppleDouble`; and
/// the index of an archive, `@3dtilesIndex1@`, which an unpacker takes for a file as others.
bool is_system_file(std::string_view name);

}  // namespace meshhier::storage
