// Damaged files of every encoding: each is read, or refused with one Error(input). Nothing else may
// happen, and no damage makes the reader hand out more than the file can hold.
#include "base/error.h"
#include "ply_samples.h"
#include "tests/support/share.h"

#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

enum class Outcome { valid, refused };

/// The triangles, or what is wrong.
template <class Read>
std::string told(const Read& read) {
  try {
    std::string text;
    for (const auto& t : read().triangles)
      text += fmt::format("{} {} {},", t[0], t[1], t[2]);
    return text;
  } catch (const Error& error) {
    return error.what();
  }
}

/// However a file is damaged, blocks make of it what the stream makes of it.
void expect_same_in_blocks(MeshSource& source, bool backwards) {
  const std::string expected = told([&] {
    ReadMesh mesh;
    source.read_vertices([](const VertexBlock&) {});
    source.read_triangles([&](std::span<const Triangle<VertexId>> block) {
      for (const Triangle<VertexId>& t : block)
        mesh.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
    });
    return mesh;
  });
  EXPECT_EQ(told([&] { return read_in_blocks(source, backwards); }), expected);
}

/// Reads everything; fails the test on anything but success or Error(input) with a message that
/// starts with the file's name.
Outcome outcome_of(const Bytes& bytes) {
  MemoryFiles files;
  files.put(std::string(kFileName), bytes);
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  try {
    const auto source = open_mesh(files, kFileName);
    const std::uint64_t count = source->description().vertex_count;
    for (const bool backwards : {false, true})
      expect_same_in_blocks(*source, backwards);
    source->read_vertices(
        [&](const VertexBlock& block) { vertices += block.positions.size() + block.exact.size(); });
    source->read_triangles([&](std::span<const Triangle<VertexId>> block) {
      triangles += block.size();
      for (const Triangle<VertexId>& t : block) {
        for (const VertexId corner : t)
          EXPECT_LT(raw(corner), count);
      }
    });
    EXPECT_EQ(vertices, count);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_TRUE(std::string(error.what()).starts_with("mesh.ply: ")) << error.what();
    EXPECT_LT(std::string(error.what()).size(), 600U);
    return Outcome::refused;
  }
  EXPECT_LE(vertices + triangles, bytes.size());
  return Outcome::valid;
}

/// Files that go through every path: plain, with lists and scalars around, with strips and colours.
std::vector<Bytes> seeds(PlyEncoding encoding) {
  PlyText rich(encoding);
  rich.line("comment rich").line("element face 2").line("property ushort group");
  rich.line("property list char short vertex_index").line("property list uchar uchar tags");
  rich.line("element vertex 5").line("property double x").line("property float y");
  rich.line("property int z").line("property list int uchar marks").line("property int red");
  rich.line("property int green").line("property int blue").line("element tristrips 1");
  rich.line("property list int int vertex_indices").line("element edge 1");
  rich.line("property int vertex1").end_header();
  for (int i = 0; i < 2; ++i) {
    rich.value(PlyType::u16, 7).value(PlyType::i8, 3 + i);
    for (int corner = 0; corner < 3 + i; ++corner)
      rich.value(PlyType::i16, corner + 1 - i);
    rich.value(PlyType::u8, 2).value(PlyType::u8, 1).value(PlyType::u8, 2).end_row();
  }
  for (int i = 0; i < 5; ++i) {
    rich.value(PlyType::f64, i * 0.3).value(PlyType::f32, i).value(PlyType::i32, -i);
    rich.value(PlyType::i32, 1).value(PlyType::u8, 8);
    for (int channel = 0; channel < 3; ++channel)
      rich.value(PlyType::i32, 100 + channel);
    rich.end_row();
  }
  rich.list(PlyType::i32, PlyType::i32, {0, 1, 2, 3, -1, 2, 3, 4}).row(PlyType::i32, {3});
  return {tetrahedron(encoding), tetrahedron(encoding, PlyType::f64, PlyType::i32, PlyType::u16),
          rich.bytes()};
}

TEST(PlyFuzz, TruncatedAtEveryByte) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const Bytes& seed : seeds(encoding)) {
      ASSERT_EQ(outcome_of(seed), Outcome::valid);
      // Only the last line end of a text may be missing.
      const std::size_t spare = encoding == PlyEncoding::ascii ? 1 : 0;
      for (std::size_t size = 0; size + spare < seed.size(); ++size) {
        EXPECT_EQ(outcome_of(seed.substr(0, size)), Outcome::refused) << size;
      }
    }
  }
}

TEST(PlyFuzz, EveryBitFlipped) {
  for (const PlyEncoding encoding : kEncodings) {
    std::size_t refused = 0;
    for (const Bytes& seed : seeds(encoding)) {
      for (std::size_t bit = meshhier::tests::share().index; bit < 8 * seed.size();
           bit += meshhier::tests::share().count) {
        Bytes damaged = seed;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        if (outcome_of(damaged) == Outcome::refused)
          ++refused;
      }
    }
    EXPECT_GT(refused, 1000 / meshhier::tests::share().count) << "most damage is found";
  }
}

TEST(PlyFuzz, RandomDamage) {
  std::mt19937 random(20240);
  const auto below = [&](std::size_t bound) { return static_cast<std::size_t>(random() % bound); };
  for (const PlyEncoding encoding : kEncodings) {
    for (const Bytes& seed : seeds(encoding)) {
      std::size_t refused = 0;
      for (int round = 0; round < 400; ++round) {
        Bytes damaged = seed;
        for (std::size_t hit = 0; hit < 1 + below(6); ++hit) {
          damaged[below(damaged.size())] = static_cast<char>(random());
        }
        const std::size_t cut = below(damaged.size());
        if (round % 3 == 0)
          damaged.insert(cut, damaged.substr(below(damaged.size()), below(40)));
        if (round % 3 == 1)
          damaged.erase(cut, below(20));
        if (outcome_of(damaged) == Outcome::refused)
          ++refused;
      }
      EXPECT_GT(refused, 200U);
    }
  }
}

/// Numbers of a header replaced by the worst ones: nothing is taken that the file cannot fill.
TEST(PlyFuzz, HostileCounts) {
  for (const PlyEncoding encoding : kEncodings) {
    for (const char* count : {"4294967295", "4294967296", "9223372036854775807",
                              "18446744073709551615", "1000000000"}) {
      for (const std::string element : {"element vertex ", "element face "}) {
        Bytes bytes = tetrahedron(encoding);
        bytes.replace(bytes.find(element) + element.size(), 1, count);
        EXPECT_EQ(outcome_of(bytes), Outcome::refused) << element << count;
      }
    }
  }
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
