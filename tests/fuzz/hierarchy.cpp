// The input of the targets `hierarchy` and `stream`: changes to the files of a sound one, little
// endian, until it ends:
//
//   u8   file, modulo those there are, by name
//   u16  place in it, modulo its size
//   u8   bytes that are replaced, one less; modulo 16
//   so many bytes
//
// The checksums of all files are then made right. Whoever reads it finds out what is wrong, or gets
// what the hierarchy promises: if verify has nothing against it, all of it can be exported. A
// progressive stream that is made of it is sound, whatever it shows.
#include "bench/generator.h"
#include "export/export.h"
#include "fuzz/sealed.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "inspection/inspect.h"
#include "mesh_io/mesh_source.h"
#include "pipeline/build.h"
#include "progressive/reconstruct.h"
#include "progressive/stream.h"
#include "progressive/stream_index.h"
#include "storage/format/glb.h"
#include "storage/format/layout.h"
#include "storage/format/manifest.h"
#include "storage/io/hash.h"
#include "support/memory_files.h"
#include "tests/support/quick_config.h"
#include "verify/verify.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>

namespace meshhier::tests::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHierarchy = "a.hier";
constexpr const char* kExported = "out.ply";
constexpr const char* kCut = "cut.txt";
constexpr const char* kStream = "a.prog";

using Contents = std::vector<std::pair<fs::path, std::vector<std::byte>>>;

/// A tree with early nodes, over a closed surface with colours and an origin.
Contents make_sound(config::SimplifyMethod method) {
  bench::SurfaceOptions surface;
  surface.triangles = 100;
  surface.noise = 0.5;
  surface.colours = true;
  surface.double_coordinates = true;
  surface.offset = {500123.4567, 5812345.6789, 100.125};
  config::Config config = tests::smooth_config();
  config.input = "a.ply";
  config.output = kHierarchy;
  config.threads = 1;
  config.partition.count = 5;
  config.simplify.method = method;
  config.simplify.vertices = 12;
  MemoryFiles files;
  bench::write_ply(files, {config.input.front(), true}, *bench::make_surface(surface));
  execution::NoProgress progress;
  pipeline::build_hierarchy(config, {}, {files, progress, {}});
  Contents contents;
  for (const fs::path& path : files.list(kHierarchy))
    contents.emplace_back(path, files.bytes(path));
  return contents;
}

void apply(Bytes changes, const Contents& sound, MemoryFiles& files) {
  for (Take take(changes); !take.rest().empty();) {
    auto& bytes = files.bytes(sound[take.upto(static_cast<std::uint8_t>(sound.size() - 1))].first);
    std::size_t place = take.number<std::uint16_t>() % bytes.size();
    for (int count = take.upto<std::uint8_t>(15); count >= 0 && place < bytes.size(); --count)
      bytes[place++] = static_cast<std::byte>(take.number<std::uint8_t>());
  }
}

/// Sizes never change: `apply` replaces.
void seal(const Contents& sound, MemoryFiles& files) {
  constexpr std::size_t kHeaderBytes = 32, kRecordBytes = 120, kChecksumPlace = 112;
  std::vector<std::byte>& index = files.bytes(storage::index_path(kHierarchy));
  std::size_t record = kHeaderBytes;
  for (const auto& [path, unchanged] : sound) {
    if (path.extension() != ".glb" || path == storage::outline_path(kHierarchy))
      continue;
    storage::store_little(storage::checksum(files.bytes(path)),
                          index.data() + record + kChecksumPlace);
    record += kRecordBytes;
  }
  index = sealed_index(index);

  const fs::path path = storage::manifest_path(kHierarchy);
  files.put(path, sealed_manifest(files.content(path)));
  try {
    storage::Manifest manifest = storage::parse_manifest(files.content(path), "hierarchy.json");
    manifest.index_checksum = storage::checksum(index);
    manifest.outline_checksum = storage::checksum(files.bytes(storage::outline_path(kHierarchy)));
    files.put(path, storage::to_json_text(manifest));
  } catch (const Error&) {
    // So be it: a manifest that says nothing.
  }
}

bool is_sound(MemoryFiles& files) {
  execution::NoProgress progress;
  verifying::VerifyOptions options;
  options.cuts = 3;
  options.memory_budget = std::uint64_t{1} << 24;
  const auto report = verifying::verify_hierarchy(files, kHierarchy, options, progress, {});
  for (const std::string& problem : report.problems)
    require_message(problem, "");
  return report.problems.empty();
}

/// Returns whether it was exported; a tree that has not what is asked for is a usage error.
bool is_exported(MemoryFiles& files, const exporting::ExportSelection& selection) {
  execution::NoProgress progress;
  files.remove_all(kExported);
  const std::string refused = refusal({ErrorCode::corrupt, ErrorCode::usage}, "", [&] {
    exporting::export_mesh(files, kHierarchy, {selection, kExported, std::uint64_t{1} << 24, true},
                           progress, {});
  });
  require(files.exists(kExported) == refused.empty(), "an export is whole, or not there");
  if (refused.empty() && !std::holds_alternative<exporting::OutlineSelection>(selection)) {
    const auto mesh = mesh_io::open_mesh(files, kExported);
    mesh->read_vertices([](const mesh_io::VertexBlock&) {});
    mesh->read_triangles([](std::span<const Triangle<VertexId>>) {});
  }
  return refused.empty();
}

bool is_inspected(MemoryFiles& files) {
  return refusal({ErrorCode::corrupt}, "", [&] { inspection::inspect_text(files, kHierarchy, {}); })
      .empty();
}

/// The sound hierarchy with the changes of `input`.
void put_changed(Bytes input, const Contents& sound, MemoryFiles& files) {
  for (const auto& [path, bytes] : sound)
    storage::write_file(files, path, bytes);
  apply(input, sound, files);
  seal(sound, files);
}

/// Streams the part, and puts together what was streamed.
void check_streamed(MemoryFiles& files, std::optional<NodeId> part) {
  execution::NoProgress progress;
  files.remove_all(kStream);
  const std::string refused =
      refusal({ErrorCode::corrupt, ErrorCode::usage, ErrorCode::budget}, "", [&] {
        progressive::write_progressive(
            files, kHierarchy, {part, {}, kStream, false, std::uint64_t{1} << 24}, progress, {});
      });
  require(files.exists(kStream) == refused.empty(), "a stream is whole, or not there");
  if (!refused.empty())
    return;
  const std::size_t steps = progressive::read_progressive_index(files, kStream).files.size();
  for (std::uint32_t details = 0; details < steps; ++details) {
    files.remove_all(kExported);
    progressive::reconstruct(files, kStream, {details, kExported, std::uint64_t{1} << 24, true},
                             progress, {});
    require(files.exists(kExported), "what is streamed can be put together");
  }
}

}  // namespace

void stream(Bytes input) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  static const Contents kSound = make_sound(config::SimplifyMethod::half_edge);
  MemoryFiles files;
  put_changed(input, kSound, files);
  check_streamed(files, std::nullopt);
  check_streamed(files, NodeId{Level{1}, 1});
}

void hierarchy(Bytes input) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  static const Contents kSound = make_sound(config::SimplifyMethod::edge_collapse);
  MemoryFiles files;
  put_changed(input, kSound, files);

  const bool sound = is_sound(files);
  require(is_inspected(files) || !sound, "what is sound can be inspected");
  files.put(kCut, "1/0\n3/3\n3/4\n");
  const std::array<exporting::ExportSelection, 3> selections = {fs::path(kCut), NodeId{Level{2}, 1},
                                                                exporting::OutlineSelection{}};
  for (const auto& selection : selections)
    require(is_exported(files, selection) || !sound, "what is sound can be exported");
}

}  // namespace meshhier::tests::fuzz
