// OSGB: scenes of OpenSceneGraph, as ContextCapture, DJI Terra and Smart3D write tiles.
//
// The library that reads them is not trusted with bytes of others: a program beside this one does
// it (mesh_io/osgb), which makes a GLB of a file. That is checked as any GLB is.
#pragma once

#include "mesh_io/gltf_transform.h"
#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Says in a sentence what keeps this machine from reading OSGB, and what to do; empty: it can.
std::string missing_for_osgb();

/// Returns whether a file begins as OSGB does.
bool begins_as_osgb(std::string_view start);

/// A file that holds a finer part of a tile.
struct OsgbFiner {
  std::size_t name = 0;  ///< in the file's names
  GltfTransform place;   ///< from its coordinates to those of the file that names it
};

struct OsgbTile {
  /// With the coordinates of the file: no axis is turned. Of pictures that are made of texels it
  /// has the first bytes, which tell their sizes.
  std::shared_ptr<const std::vector<std::byte>> glb;
  std::uint64_t triangles = 0;
  std::vector<OsgbFiner> finer{};
  std::uint64_t missing = 0;  ///< files that are not there, for which coarser parts stand, or none
  std::uint64_t others = 0;   ///< parts that are no triangles
  std::uint64_t unknown = 0;  ///< parts of kinds that the library does not know
};

/// Returns the memory that reading a file of that size takes, here and in the program beside this
/// one, texels left out.
std::uint64_t osgb_reading_bytes(std::uint64_t file_bytes);

/// An OSGB file in memory. Reading starts a process, or asks one that waits; thread-safe.
class OsgbFile {
 public:
  /// Reads the file, packed by gzip or not. `most_bytes`: for the file, and again for a question,
  /// and for its answer. Throws Error(budget) if the file has more, or 2^31, Error(io).
  OsgbFile(const storage::File& file, std::uint64_t most_bytes);

  /// Returns the names of the files that nodes name, each once. Throws Error(input) naming the file
  /// if it is broken, or if no process survives it; Error(io) as missing_for_osgb().
  std::vector<std::string> names() const;
  /// Returns its finest parts where the files with a 1 in `present` are there. Throws as names();
  /// Error(budget) if they take more than `most_bytes`.
  OsgbTile tile(std::span<const std::byte> present) const;
  /// Returns a picture as a file: the one that begins at `offset` of the GLB which tile() returns
  /// for the same `present`. Throws as tile().
  std::vector<std::byte> picture(std::span<const std::byte> present, std::uint64_t offset) const;
  /// Returns the bytes of the file, unpacked.
  std::span<const std::byte> bytes() const { return bytes_; }
  bool is_packed() const { return is_packed_; }  ///< in gzip

 private:
  std::vector<std::byte> ask(std::uint32_t kind, std::span<const std::byte> choice) const;

  std::filesystem::path path_;
  std::uint64_t most_bytes_;
  bool is_packed_;
  std::vector<std::byte> bytes_;
};

/// Ends the processes that wait.
void end_osgb_readers();

}  // namespace meshhier::mesh_io
