#include "fuzz/ply_reading.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_header.h"
#include "mesh_io/ply_writer.h"
#include "storage/io/file_checksum.h"
#include "storage/io/hash.h"
#include "support/memory_files.h"

#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

namespace meshhier::tests::fuzz {
namespace {

using mesh_io::MeshSource;
using mesh_io::PlyEncoding;
using mesh_io::PlyHeader;

constexpr const char* kMeshName = "mesh.ply";

std::optional<PlyHeader> header_of(std::string_view file) {
  std::optional<PlyHeader> header;
  refusal({ErrorCode::input}, "mesh.ply: ", [&] {
    header = mesh_io::parse_ply_header(file.substr(0, mesh_io::kMaxHeaderBytes), kMeshName);
  });
  return header;
}

/// Null if the file is refused before its data is looked at.
std::unique_ptr<MeshSource> open(MemoryFiles& files) {
  std::unique_ptr<MeshSource> source;
  refusal({ErrorCode::input}, "mesh.ply: ", [&] { source = mesh_io::open_mesh(files, kMeshName); });
  return source;
}

void check_checksum(MemoryFiles& files, MeshSource& source) {
  const auto file = files.open(kMeshName);
  const auto no_check = [] {};
  storage::FileChecksum checksum(file->size());
  require(source.checksum(no_check) == checksum.complete(*file, no_check),
          "the checksum is the file's");
}

/// The file read in each order and form; the results are the same, or Violation is thrown.
PlyReading read_every_way(MemoryFiles& files, MeshSource& source) {
  const PlyReading reading = read_as_stream(source);
  require(is_same(read_in_blocks(source), reading), "blocks are as the stream");
  check_checksum(files, source);
  const auto another = mesh_io::open_mesh(files, kMeshName);
  require(is_same(read_as_stream_backwards(*another), reading), "any order is as good");
  return reading;
}

/// decode(encode(mesh)) == mesh.
void check_written(const mesh_io::MeshDescription& mesh, const PlyReading& reading) {
  MemoryFiles files;
  mesh_io::PlyContent content;
  content.vertex_count = mesh.vertex_count;
  content.triangle_count = reading.triangles.size();
  content.attributes = mesh.attributes;
  content.double_coordinates = mesh.wide_coordinates;
  mesh_io::PlyWriter writer(files.create(kMeshName), content);
  if (mesh.wide_coordinates) {
    writer.write_vertices(reading.exact, reading.attributes);
  } else {
    writer.write_vertices(reading.positions, reading.attributes);
  }
  writer.write_triangles(reading.triangles);
  writer.finish();

  PlyReading again = read_as_stream(*mesh_io::open_mesh(files, kMeshName));
  require(again.counts.degenerate_triangles == 0, "only triangles were written");
  again.counts = reading.counts;
  require(is_same(again, reading), "what is written is read again");
}

/// Wherever in a file the data lies, it is the same data: also across the borders of buffers,
/// blocks and checksums, which the few kilobytes of an input never reach by themselves.
struct Move {
  std::size_t border = 0;    ///< byte of the file that lies within the data, or at one of its ends
  std::size_t short_of = 0;  ///< where the data begins before it
  bool rare = false;         ///< one of 64
};

/// The same for the same input.
Move move_of(std::string_view file, const PlyHeader& header) {
  constexpr std::size_t kBorders[] = {std::size_t{1} << 17, std::size_t{1} << 18,
                                      std::size_t{1} << 19};
  const std::uint64_t hash = storage::checksum(bytes_of(file));
  const std::size_t size = file.size() - header.data_offset;
  return {kBorders[hash % 3], static_cast<std::size_t>(hash >> 8) % (size + 1), hash >> 58 == 0};
}

/// A binary file with an element of single bytes before all others; empty if its header leaves no
/// place for that.
std::string moved_binary(std::string_view file, const PlyHeader& header, const Move& move) {
  const std::string_view text = file.substr(0, header.data_offset);
  const std::size_t place = text.find("\nelement ");
  const bool fits = text.find('\r') == std::string_view::npos &&
                    text.find("padding") == std::string_view::npos &&
                    place != std::string_view::npos;
  constexpr std::size_t kAddedText = 100;
  if (!fits || move.border < header.data_offset + move.short_of + kAddedText)
    return {};
  // The count has six digits, leading zeros included: its size does not depend on it.
  constexpr auto kForm = "\nelement padding {:06}\nproperty uchar p";
  const std::size_t rows =
      move.border - move.short_of - header.data_offset - fmt::format(kForm, 0).size();
  std::string result(text.substr(0, place));
  result += fmt::format(kForm, rows);
  result += text.substr(place);
  // Another element may come before, behind blanks that the search does not know.
  if (mesh_io::parse_ply_header(result, kMeshName).elements.front().name != "padding")
    return {};
  result.append(rows, '\0');
  result += file.substr(header.data_offset);
  return result;
}

/// A text with blanks before its first row, up to the end of a window of 1 MiB.
std::string moved_text(std::string_view file, const PlyHeader& header, const Move& move) {
  constexpr std::size_t kBorder = std::size_t{1} << 20;
  if (kBorder < header.data_offset + move.short_of)
    return {};
  std::string result(file.substr(0, header.data_offset));
  result.append(kBorder - move.short_of - header.data_offset, ' ');
  result += file.substr(header.data_offset);
  return result;
}

void check_moved(std::string_view file, const PlyHeader& header, const PlyReading& reading) {
  const bool text = header.encoding == PlyEncoding::ascii;
  const Move move = move_of(file, header);
  if (text && !move.rare)  // a MiB of text takes as long as twenty inputs
    return;
  const std::string far = text ? moved_text(file, header, move) : moved_binary(file, header, move);
  if (far.empty())
    return;
  MemoryFiles files;
  files.put(kMeshName, far);
  const auto source = mesh_io::open_mesh(files, kMeshName);
  require(is_same(read_every_way(files, *source), reading, text), "the place does not matter");
}

void ply_body(Bytes input, bool text) {
  const std::string_view file = text_of(input);
  const std::optional<PlyHeader> header = header_of(file);
  if (!header || (header->encoding == PlyEncoding::ascii) != text)
    return;
  MemoryFiles files;
  files.put(kMeshName, std::string(file));
  const auto source = open(files);
  if (source == nullptr)
    return;
  const PlyReading reading = read_every_way(files, *source);
  if (reading.is_whole())
    check_written(source->description(), reading);
  check_moved(file, *header, reading);
}

}  // namespace

void ply_text(Bytes input) {
  ply_body(input, true);
}

void ply_binary(Bytes input) {
  ply_body(input, false);
}

}  // namespace meshhier::tests::fuzz
