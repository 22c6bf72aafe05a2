// The finest tiles of OSGB files that name each other (PagedLOD).
//
//   Tile.osgb  names  Tile_L16_0.osgb  names  Tile_L17_0.osgb   read: its finest parts
//                                             Tile_L17_1.osgb   missing: the part of L16 stands
#pragma once

#include "mesh_io/gltf_transform.h"
#include "mesh_io/named_files.h"
#include "mesh_io/osgb_file.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// A file that was read, with its finest parts.
struct OsgbShown {
  const std::filesystem::path& path;
  const OsgbFile& file;
  const OsgbTile& tile;
  const GltfTransform& place;  ///< from its coordinates to those of the first file
};

/// Facts of all files together.
struct OsgbCounts {
  std::uint64_t missing = 0;                    ///< files that others name and that are not there
  std::string first_missing{};                  ///< one of them, and the file that names it
  std::vector<std::filesystem::path> sought{};  ///< places where missing ones would be
  std::uint64_t others = 0;                     ///< parts that are no triangles
  std::uint64_t unknown = 0;                    ///< parts of kinds that the library does not know
};

/// Reads files one by one. For one thread.
class OsgbTiles {
 public:
  /// `most_bytes`: memory for a file, and for what is made of it.
  OsgbTiles(storage::FileSystem& files, std::uint64_t most_bytes)
      : files_(files), named_(files), most_bytes_(most_bytes) {}

  /// Visits a file, then the finer ones that it names, in the order of its nodes. A name leads to a
  /// file in the folder of the file that names it, or below; where it leads elsewhere, to the one
  /// of that name beside it. Throws as OsgbFile; Error(input) if files name each other in a circle,
  /// or more than 2^20 are shown.
  void for_each(const std::filesystem::path& path,
                const std::function<void(const OsgbShown&)>& visit);

  /// Returns the finest parts of one file.
  OsgbTile tile(const std::filesystem::path& path);

  const OsgbCounts& counts() const { return counts_; }

 private:
  struct Read;
  void walk(const std::filesystem::path& path, const GltfTransform& place,
            std::vector<std::filesystem::path>& above,
            const std::function<void(const OsgbShown&)>& visit);
  std::vector<std::filesystem::path> find_files(const std::filesystem::path& path,
                                                const std::vector<std::string>& names);

  storage::FileSystem& files_;
  NamedFiles named_;
  std::uint64_t most_bytes_;
  std::uint64_t shown_ = 0;
  OsgbCounts counts_;
};

/// Returns the files that lie beside an OSGB file and belong to its tile by their names: all others
/// in a folder of its name, else those that begin with its name.
std::vector<std::filesystem::path> osgb_family(storage::FileSystem& files,
                                               const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
