// Counts that lie: files of a kilobyte that declare 10^18 of something are refused before memory is
// taken for it.
#include "base/error.h"
#include "fuzz/sealed.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_samples.h"
#include "progressive/detail_file.h"
#include "progressive/reconstruct.h"
#include "progressive/stream_index.h"
#include "storage/format/archive.h"
#include "storage/format/glb.h"
#include "storage/format/gzip.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/index.h"
#include "storage/format/manifest.h"
#include "storage/format/outline_glb.h"
#include "storage/format/tile_glb.h"
#include "support/hollow_file.h"
#include "support/memory_files.h"
#include "support/taken_memory.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

using mesh_io::PlyEncoding;
using Json = nlohmann::ordered_json;

/// A reader's buffers: a window of 1 MiB and blocks of triangles, a few times over.
constexpr std::size_t kBuffers = std::size_t{8} << 20;

constexpr const char* kLies[] = {"1000000000000000000", "18446744073709551615",
                                 "9223372036854775807", "4294967296",
                                 "4294967295",          "100000000"};

/// Runs `read`, which must end in an error of that code and may take kBuffers on the way.
void expect_cheap_refusal(ErrorCode code, const std::string& what,
                          const std::function<void()>& read) {
  const std::size_t before = taken_bytes();
  try {
    read();
    ADD_FAILURE() << what << ": accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << what << ": " << error.what();
  }
  EXPECT_LT(taken_bytes() - before, kBuffers) << what;
}

void read_all(const std::string& file) {
  MemoryFiles files;
  files.put("mesh.ply", file);
  const auto source = mesh_io::open_mesh(files, "mesh.ply");
  source->read_vertices([](const mesh_io::VertexBlock&) {});
  source->read_triangles([](std::span<const Triangle<VertexId>>) {});
}

std::string with_number(std::string text, const std::string& before, const std::string& number) {
  const std::size_t place = text.find(before) + before.size();
  return text.replace(place, text.find_first_not_of("0123456789", place) - place, number);
}

storage::Manifest small_manifest() {
  storage::Manifest manifest;
  manifest.generator = "meshhier";
  manifest.first_view = Standpoint{};
  manifest.source.file_name = "a.ply";
  manifest.source.vertices = 10;
  manifest.source.places = 10;
  manifest.source.bounds = {{0, 0, 0}, {1, 1, 1}};
  manifest.partition_count = 1;
  manifest.config = Json::object();
  manifest.levels = Json::array();
  return manifest;
}

/// A GLB whose JSON has nothing but an extension, and a kilobyte of zeros.
std::vector<std::byte> glb_with(const char* name, const Json& extension) {
  Json document;
  document["extensions"][name] = extension;
  return storage::join_glb(document.dump(), std::vector<std::byte>(1024));
}

TEST(LyingCounts, OfPlyElementsTakeNoMemory) {
  for (const PlyEncoding encoding : mesh_io::tests::kEncodings) {
    const std::string mesh = mesh_io::tests::tetrahedron(encoding);
    for (const char* lie : kLies) {
      for (const std::string element : {"element vertex ", "element face "}) {
        expect_cheap_refusal(ErrorCode::input, element + lie,
                             [&] { read_all(with_number(mesh, element, lie)); });
      }
      std::string other = mesh;
      other.insert(other.find("element vertex"),
                   std::string("element other ") + lie + "\nproperty list uchar int a\n");
      expect_cheap_refusal(ErrorCode::input, "an element before the others",
                           [&] { read_all(other); });
    }
  }
}

TEST(LyingCounts, OfPlyListsTakeNoMemory) {
  using mesh_io::PlyType;
  for (const PlyEncoding encoding : mesh_io::tests::kEncodings) {
    for (const std::string element : {"face", "tristrips"}) {
      for (const double lie : {2147483647.0, 100000000.0, -1.0}) {
        mesh_io::tests::PlyText ply(encoding);
        ply.line("element vertex 1").line("property float x").line("property float y");
        ply.line("property float z").line("element " + element + " 1");
        ply.line("property list int int vertex_indices").end_header();
        ply.row(PlyType::f32, {0, 0, 0}).value(PlyType::i32, lie);
        for (int i = 0; i < 200; ++i)
          ply.value(PlyType::i32, 0);
        expect_cheap_refusal(ErrorCode::input, element + " of " + std::to_string(lie),
                             [&] { read_all(ply.end_row().bytes()); });
      }
    }
  }
}

TEST(LyingCounts, OfAnIndexTakeNoMemory) {
  constexpr std::uint32_t kMost = 0xFFFFFFFF;
  std::vector<std::byte> bytes = storage::encode_index(std::vector<TileRecord>(10));
  for (const std::uint64_t lie :
       {std::uint64_t{1000000000000000000}, ~std::uint64_t{0}, 2 * std::uint64_t{kMost} - 1}) {
    storage::store_little(lie, bytes.data() + 16);
    for (const std::uint32_t partitions : {kMost, 1000000U, 1U}) {
      expect_cheap_refusal(ErrorCode::corrupt, "an index", [&] {
        storage::decode_index(bytes, {kMost, partitions}, "tiles.bin");
      });
    }
  }
}

TEST(LyingCounts, OfAManifestTakeNoMemory) {
  const std::string honest = storage::to_json_text(small_manifest());
  const std::string index = "\"file\": \"tiles.bin\",\n    \"bytes\": ";
  const std::string outline = "\"file\": \"outline.glb\",\n    \"bytes\": ";
  for (const std::string lie : kLies) {
    for (const std::string& key : {std::string("\"vertices\": "), std::string("\"places\": "),
                                   std::string("\"partitions\": "), index, outline}) {
      // The most that is allowed everywhere, and the lie.
      std::string text = with_number(honest, "\"vertices\": ", "4294967295");
      text = with_number(text, "\"places\": ", "4294967295");
      text =
          with_number(with_number(text, "\"partitions\": ", "4294967295"), index, "893353197288");
      MemoryFiles files;
      files.put("a.hier/hierarchy.json", fuzz::sealed_manifest(with_number(text, key, lie)));
      files.put("a.hier/tiles.bin", std::string(1024, '\0'));
      expect_cheap_refusal(ErrorCode::corrupt, key + lie,
                           [&] { storage::HierarchyReader(files, "a.hier"); });
    }
  }
}

/// Zeros without end, as a sparse file has them on a disk that has no room for one of them.
class SparseFile final : public storage::File {
 public:
  explicit SparseFile(const std::filesystem::path& path) : File(path) {}
  std::uint64_t size() const override { return 1000000000000000000; }
  void sync() override {}

 protected:
  std::size_t read_some(std::uint64_t, std::span<std::byte> bytes) const override {
    std::ranges::fill(bytes, std::byte{0});
    return bytes.size();
  }
  std::size_t write_some(std::uint64_t, std::span<const std::byte>) override { return 0; }
};

class SparseIndex final : public MemoryFiles {
 public:
  std::unique_ptr<storage::File> open(const std::filesystem::path& path) override {
    if (path.filename() == "tiles.bin")
      return std::make_unique<SparseFile>(path);
    return MemoryFiles::open(path);
  }
};

TEST(LyingCounts, ThatAgreeWithASparseIndexTakeNoMemory) {
  storage::Manifest manifest = small_manifest();
  manifest.index_bytes = 1000000000000000000;
  SparseIndex files;
  files.put("a.hier/hierarchy.json", storage::to_json_text(manifest));
  expect_cheap_refusal(ErrorCode::corrupt, "an index",
                       [&] { storage::HierarchyReader(files, "a.hier"); });
}

TEST(LyingCounts, OfATileTakeNoMemory) {
  const Tree tree(1000, 4);
  for (const std::uint64_t lie : {std::uint64_t{1000000000000000000}, std::uint64_t{4294967295}}) {
    for (const char* key : {"ghostCount", "neighbourCount", "chainEntryCount", "interiorCount",
                            "borderCount", "ownCount", "copyCount"}) {
      Json extension = {{"version", 2},       {"ownCount", 4},       {"rimCount", 2},
                        {"ghostCount", 2},    {"neighbourCount", 1}, {"chainEntryCount", 4},
                        {"interiorCount", 2}, {"borderCount", 2},    {"copyCount", 2}};
      extension[key] = lie;
      if (key == std::string("neighbourCount"))
        extension["ghostCount"] = lie;
      const auto glb = glb_with("MESHHIER_tile", extension);
      expect_cheap_refusal(ErrorCode::corrupt, key, [&] {
        storage::decode_tile(glb, {Level{2}, 1}, tree, {}, "tile.glb");
      });
    }
  }
}

TEST(LyingCounts, OfAnOutlineTakeNoMemory) {
  for (const std::uint64_t lie : {std::uint64_t{1000000000000000000}, std::uint64_t{4294967295}}) {
    for (const char* key : {"vertexCount", "segmentCount"}) {
      Json extension = {{"version", 1}, {"vertexCount", 4}, {"segmentCount", 3}};
      extension[key] = lie;
      const auto glb = glb_with("MESHHIER_outline", extension);
      expect_cheap_refusal(ErrorCode::corrupt, key,
                           [&] { storage::decode_outline(glb, "outline.glb"); });
    }
  }
}

TEST(LyingCounts, OfADetailFileTakeNoMemory) {
  constexpr AttributeLayout kWidest{true, ColourType::f32, true, true};
  // Many zeros in a few bytes, and nothing.
  std::vector<std::byte> bomb = storage::gzip(std::vector<std::byte>(std::size_t{1} << 26));
  for (const std::vector<std::byte>& packed : {bomb, storage::gzip({}), std::vector<std::byte>()}) {
    for (const std::uint32_t list : {1U, 2U, 3U}) {
      for (const std::uint32_t entries : {1U, 65536U, 65537U, UINT32_MAX}) {
        for (const std::uint32_t size : {static_cast<std::uint32_t>(packed.size()), UINT32_MAX}) {
          std::vector<std::byte> file = progressive::detail_head(1);
          for (const std::uint32_t number : {list, entries, size})
            storage::append_little(file, number);
          file.insert(file.end(), packed.begin(), packed.end());
          expect_cheap_refusal(ErrorCode::corrupt, "a detail file", [&] {
            progressive::DetailFileReader(file, 1, kWidest, "detail_01.bin").next();
          });
        }
      }
    }
  }
}

TEST(LyingCounts, OfAProgressiveIndexTakeNoMemory) {
  progressive::ProgressiveIndex index;
  index.source = small_manifest().source;
  index.vertices = index.own_vertices = 10;
  index.triangles = 12;
  index.files = {{Level{0}, 10, 12, 0, 10, 12, 1000, 0}};
  const std::string honest = progressive::to_json_text(index);
  const auto refuse = [](const std::string& text) {
    MemoryFiles files;
    files.put("a.prog/progressive.json", fuzz::sealed_manifest(text));
    files.put("a.prog/base.bin", std::string(1000, '\0'));
    execution::NoProgress progress;
    progressive::reconstruct(files, "a.prog", {{}, "a.ply", std::uint64_t{1} << 20}, progress,
                             execution::CancelToken());
  };
  expect_cheap_refusal(ErrorCode::corrupt, "zeros", [&] { refuse(honest); });
  for (const std::string lie : kLies) {
    for (const std::string key :
         {"own_vertices", "shown_vertices", "shown_triangles", "merges", "bytes"}) {
      expect_cheap_refusal(ErrorCode::corrupt, key + lie,
                           [&] { refuse(with_number(honest, "\"" + key + "\": ", lie)); });
    }
    for (const std::string key : {"\n  \"vertices\": ", "\n  \"triangles\": "}) {
      const std::size_t before = taken_bytes();
      EXPECT_THROW(refuse(with_number(honest, key, lie)), Error) << key << lie;
      EXPECT_LT(taken_bytes() - before, kBuffers) << key << lie;
    }
  }
}

TEST(LyingCounts, OfAContainerTakeNoMemory) {
  auto glb = storage::join_glb("{}", std::vector<std::byte>(1024));
  for (const std::size_t place : {8, 12, 24}) {
    auto lying = glb;
    storage::store_little(std::uint32_t{0xFFFFFFFC}, lying.data() + place);
    expect_cheap_refusal(ErrorCode::corrupt, "a GLB",
                         [&] { storage::decode_outline(lying, "outline.glb"); });
  }
}

/// An archive of a TiB, of which nothing is there but an end that promises a file for each byte.
TEST(LyingCounts, OfAnArchiveTakeNoMemory) {
  constexpr std::uint64_t kSize = std::uint64_t{1} << 40;
  for (const std::uint64_t entries : {std::uint64_t{1} << 62, kSize / 46, std::uint64_t{65536}}) {
    const auto end = storage::encode_archive_end(
        {entries, 1 << 20, kSize - storage::kLongestArchiveEnd - (1 << 20)});
    expect_cheap_refusal(ErrorCode::corrupt, "an archive", [&] {
      auto file = std::make_unique<tests::HollowFile>();
      file->write_at(kSize - end.size(), end);
      storage::Archive archive(std::move(file));
    });
  }
}

/// The other tests rely on this.
TEST(LyingCounts, MemoryThatIsTakenIsCounted) {
  const std::size_t before = taken_bytes();
  const std::vector<std::byte> bytes(kBuffers);
  EXPECT_GE(taken_bytes() - before, kBuffers);
}

}  // namespace
}  // namespace meshhier::tests
