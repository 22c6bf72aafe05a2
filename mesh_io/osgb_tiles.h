// OSGB files that name each other (PagedLOD), and what they show at the finest.
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
#include <mutex>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// A file, the files that its names lead to, and its finest parts where these are there.
struct OsgbRead {
  OsgbFile file;
  std::vector<std::string> names;
  std::vector<std::filesystem::path> found;  ///< of each name; empty: it is not there
  OsgbTile tile;
};

/// A finer file, and its place in the coordinates of the file that names it.
struct OsgbFinerFile {
  std::filesystem::path path;
  GltfTransform place;
};

/// Reads files, each by itself. A name leads to a file in the folder of the file that names it, or
/// below; where it leads elsewhere, to the one of that name beside it. Thread-safe.
class OsgbTiles {
 public:
  /// `most_bytes`: memory for a file, and for what is made of it.
  OsgbTiles(storage::FileSystem& files, std::uint64_t most_bytes)
      : files_(files), named_(files), most_bytes_(most_bytes) {}

  /// Throws as OsgbFile.
  OsgbRead read(const std::filesystem::path& path);

 private:
  std::vector<std::filesystem::path> find_files(const std::filesystem::path& path,
                                                const std::vector<std::string>& names);

  storage::FileSystem& files_;
  std::mutex looking_;
  NamedFiles named_;
  std::uint64_t most_bytes_;
};

/// Returns the picture that begins at `offset` of the tile's GLB, as OsgbFile::picture().
std::vector<std::byte> picture_of(const OsgbRead& read, std::uint64_t offset);

/// Returns the finer files that are to be read next, in the order of the nodes that name them.
std::vector<OsgbFinerFile> finer_files(const OsgbRead& read);

/// Returns places where the files would be that are named and not there.
std::vector<std::filesystem::path> missing_places(const std::filesystem::path& path,
                                                  const OsgbRead& read);

}  // namespace meshhier::mesh_io
