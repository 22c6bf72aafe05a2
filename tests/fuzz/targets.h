// The fuzz targets: what reads bytes from outside, each as a function of the bytes.
//
// A body returns if the input is read or refused as the headers promise, and lets an exception
// escape if not. libFuzzer drives one body a program (driver.cpp, scripts/fuzz); the test
// fuzz_replay runs all of corpus/ through them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace meshhier::tests::fuzz {

/// The input is a PLY file of which only the header is read.
void ply_header(std::span<const std::byte> input);
/// The input is a PLY file; binary files are passed over by the one, text by the other.
void ply_text(std::span<const std::byte> input);
void ply_binary(std::span<const std::byte> input);
/// Returns whether vertices are welded, then a file of any format, packed or not, to be imported.
void mesh(std::span<const std::byte> input);
/// A material library, of a mesh that is always the same.
void mtl(std::span<const std::byte> input);
/// The same for glTF, JSON or GLB: two bits, then the file.
void gltf(std::span<const std::byte> input);
/// A tileset of 3D Tiles, or a tile of one: a bit, then the file.
void tileset(std::span<const std::byte> input);
/// A byte, then a subtree of implicit tiles.
void subtree(std::span<const std::byte> input);
/// Lines that begin with "--set " are overrides, the others the config.
void config(std::span<const std::byte> input);
/// A file for placement.metadata.
void map_file(std::span<const std::byte> input);
/// A tree (take_tree()), then a list of nodes.
void cut(std::span<const std::byte> input);
/// A hierarchy.json; also with the right checksum at its end.
void manifest(std::span<const std::byte> input);
/// A tree, then a tiles.bin; also with the right checksum.
void index(std::span<const std::byte> input);
/// A tree, a node and a format (see tile.cpp), then a GLB, or counts and a BIN chunk.
void tile(std::span<const std::byte> input);
/// An outline.glb, or counts and a BIN chunk.
void outline(std::span<const std::byte> input);
/// A 3tz archive, and what one is made of (see archive.cpp).
void archive(std::span<const std::byte> input);
/// A table of objects: a kind, then a file, or a part of one.
void object_table(std::span<const std::byte> input);
/// A table beside a mesh: CSV or lines of JSON.
void records(std::span<const std::byte> input);
/// What features of a glTF are: a kind, the JSON and the bytes of a property table or of a batch
/// table (see metadata.cpp).
void metadata(std::span<const std::byte> input);
/// A table of words: a kind, then a file, rows, a table of letters, or names.
void object_words(std::span<const std::byte> input);
/// A layout and runs of lists, packed here or whole as a file, for a mesh of a few thousand slots.
void detail(std::span<const std::byte> input);
/// A progressive.json; also with the right checksum at its end.
void stream_index(std::span<const std::byte> input);
/// Changes to the files of a whole hierarchy, whose checksums are then made right.
void hierarchy(std::span<const std::byte> input);
/// The same, of one that was made by half_edge; it is streamed.
void stream(std::span<const std::byte> input);
/// The head of an HTTP request.
void request(std::span<const std::byte> input);
/// A form of files, as it is sent.
void form(std::span<const std::byte> input);
/// A JPEG, PNG or WebP file.
void image(std::span<const std::byte> input);
/// A raster of heights: its kind, then the file.
void raster(std::span<const std::byte> input);
/// Points or rays for a query: a byte, then the file.
void rows(std::span<const std::byte> input);
/// A small mesh of any shape and how it is to be built.
void build(std::span<const std::byte> input);

struct Target {
  std::string_view name;
  void (*run)(std::span<const std::byte> input) = nullptr;
};

/// Names are those of the folders in corpus/, the dictionaries, and the programs (fuzz_NAME).
inline constexpr auto kTargets = std::to_array<Target>({{"ply_header", ply_header},
                                                        {"ply_text", ply_text},
                                                        {"ply_binary", ply_binary},
                                                        {"mesh", mesh},
                                                        {"mtl", mtl},
                                                        {"gltf", gltf},
                                                        {"tileset", tileset},
                                                        {"subtree", subtree},
                                                        {"config", config},
                                                        {"map_file", map_file},
                                                        {"cut", cut},
                                                        {"manifest", manifest},
                                                        {"index", index},
                                                        {"tile", tile},
                                                        {"outline", outline},
                                                        {"archive", archive},
                                                        {"object_table", object_table},
                                                        {"records", records},
                                                        {"metadata", metadata},
                                                        {"object_words", object_words},
                                                        {"detail", detail},
                                                        {"stream_index", stream_index},
                                                        {"stream", stream},
                                                        {"hierarchy", hierarchy},
                                                        {"request", request},
                                                        {"form", form},
                                                        {"image", image},
                                                        {"raster", raster},
                                                        {"rows", rows},
                                                        {"build", build}});

}  // namespace meshhier::tests::fuzz
