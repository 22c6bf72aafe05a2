// What the program meshhier_osgb is asked and what it answers, as storage/io/worker_pool.h has it.
//
//   question          kind, bytes of the choice, bytes of all; the choice, the OSGB file
//   answer (names)    count; each: bytes, the name
//   answer (tile)     counts: finer files, missing ones, parts that are no triangles, parts of
//   kinds
//                     that the library does not know, triangles
//                     each finer file: the number of its name; its place, 16 doubles as in a glTF
//                     a GLB; of pictures that are made, not only copied, it has the first bytes
//   answer (picture)  a file
//
// `names` lists the files that the nodes of a file name, each once. The choice of `tile` is a byte
// a name, 1 if that file is there. That of `picture` is where a picture begins in the GLB, before
// the choice of that. Numbers have 32 bits and are little endian.
#pragma once

#include <cstdint>

namespace meshhier::mesh_io::osgb {

inline constexpr std::uint32_t kProtocol = 2;
inline constexpr std::uint32_t kNames = 0, kTile = 1, kPicture = 2;

}  // namespace meshhier::mesh_io::osgb
