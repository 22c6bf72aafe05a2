// The file "mesh" imported, and what it became read again.
#pragma once

#include "import/input_files.h"
#include "support/memory_files.h"

#include <string>

namespace meshhier::tests::fuzz {

/// Files that meshes may name as their pictures: "a.png", "t.1001.png", "b/C d.png".
void put_pictures(MemoryFiles& files);

/// Imports "mesh" and returns the PLY; with little memory, so that all is spooled and merged.
/// Throws Violation if a promise of the import is broken.
std::string imported(MemoryFiles& files, bool weld,
                     importing::Textures textures = importing::Textures::use);
std::string imported(MemoryFiles& files, const importing::InputUse& use);

}  // namespace meshhier::tests::fuzz
