// OSGB tiles as glTF files: several are read at once, and told one by one.
//
// Idea. Files wait in a line, in the order of the tree:
//
//   told | L16_0  L16_1  L16_2        the first ones that nobody has read are read in parallel
//   told | L16_0  L17_00  L17_01  L16_1  L16_2     the files that each names come behind it
//
// What has been read is told as soon as nothing before it has still to be read.
//
// Invariant. Files are told depth first, whatever the number of threads, and a failure is told when
// its file's turn comes.
//
// Cost. Besides those in flight, the line holds the meshes of about as many files for each level of
// the tree, in spools.
#pragma once

#include "execution/cancel.h"
#include "execution/memory_gate.h"
#include "import/gltf_import.h"
#include "import/input_files.h"
#include "mesh_io/gltf_file.h"
#include "mesh_io/gltf_transform.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::importing {

/// What there is to know of a tile of the input with all finer files that it names.
struct OsgbFacts {
  CompanionFiles tiles{};  ///< finer files that were read, and places of missing ones
  std::vector<SourceCount> counts{};
  std::vector<std::string> warnings{};
};

/// What an import does with OSGB files.
struct OsgbUse {
  /// Makes a mesh of a file's glTF at its place; pictures lie in the OSGB. In parallel.
  std::function<std::unique_ptr<MeshApart>(mesh_io::GltfFile&, const mesh_io::GltfTransform&)> read;
  std::function<void(std::unique_ptr<MeshApart>)> add;      ///< takes the next mesh
  std::function<void(std::size_t, const OsgbFacts&)> told;  ///< all of tile i was added
  std::function<void(std::uint64_t)> advance;               ///< a file of so many bytes was told
};

/// The means that files are read with. `room`: its content and place are not asked.
struct OsgbRoom {
  const mesh_io::GltfRoom& room;
  execution::MemoryGate& gate;
  const execution::CancelToken& cancel;
};

/// Reads tiles and the finer files that they name, and tells of them in order. Throws as
/// mesh_io::OsgbTiles; Error(input) if files name each other in a circle, or more than 2^20 are
/// shown.
void import_osgb(std::span<const InputFileFacts> tiles, const OsgbRoom& room, const OsgbUse& use);

}  // namespace meshhier::importing
