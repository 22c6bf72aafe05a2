// Texts that are parsed in blocks of lines say the same as when they are read by words: lines that
// end with CR alone are, in PLY; in OFF what
// follows a header that is longer than a block.
#include "mesh_io/line_blocks.h"
#include "mesh_io/off_reader.h"
#include "mesh_io/ply_source.h"
#include "streams.h"

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

constexpr int kSide = 150;  // for texts of several blocks

/// As many blocks as there may be are read before the first is worked on, the last one first.
BlockRunner eager_runner() {
  constexpr std::size_t kInFlight = 3;
  return {kInFlight, [](const BlockSteps& steps) {
            bool is_over = false;
            for (std::size_t next = 0; !is_over;) {
              const std::size_t first = next;
              while (next < first + kInFlight && !is_over) {
                is_over = !steps.read(next);
                next += is_over ? 0 : 1;
              }
              for (std::size_t i = next; i > first; --i)
                steps.work(i - 1);
              for (std::size_t i = first; i < next; ++i) {
                if (!steps.take(i))
                  return;
              }
            }
          }};
}

std::string with_line_ends(std::string_view text, std::string_view end) {
  std::string changed;
  for (const char c : text)
    changed += c == '\n' ? end : std::string_view(&c, 1);
  return changed;
}

std::string vertex_lines() {
  std::string text;
  for (int i = 0; i < kSide * kSide; ++i) {
    text += fmt::format("{} {:.7} {} {} -0.{} 1e-{} {} 7 {}\n", i % kSide, 1.0 / (i + 1), i / kSide,
                        -i, i, i % 40, i % 256, i % 99);
  }
  return text;
}

std::string face_lines() {
  std::string text;
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      const int a = y * kSide + x;
      if (x % 7 == 3)
        text += fmt::format("4 {} {} {} {}\n", a, a + 1, a + 1 + kSide, a + kSide);
      else
        text += fmt::format("3 {} {} {}\n", a, a + 1, a + kSide);
    }
  }
  return text;
}

std::string ply_head(bool wide = false) {
  const std::string type = wide ? "double" : "float";
  std::string text = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\n", kSide * kSide);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    text += fmt::format("property {} {}\n", type, name);
  for (const char* name : {"red", "green", "blue"})
    text += fmt::format("property uchar {}\n", name);
  return text + fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                            (kSide - 1) * (kSide - 1));
}

/// The numbers of a file in order, whatever blocks they came in.
struct Numbers {
  std::vector<double> positions, attributes;
  std::vector<std::uint32_t> corners;
  std::uint64_t zeroed = 0, faces = 0;
  std::string error;
  bool operator==(const Numbers&) const = default;
};

Numbers numbers_of(const std::string& content, const BlockRunner& runner) {
  meshhier::tests::MemoryFiles files;
  files.put("mesh", content);
  Numbers all;
  all.error = input_error_of([&] {
    const auto source = open_mesh(files, "mesh");
    source->read_vertices(
        [&](const VertexBlock& block) {
          EXPECT_EQ(block.first * 3, all.positions.size());
          for (const Vec3f& p : block.positions)
            all.positions.insert(all.positions.end(), {p.x, p.y, p.z});
          for (const Vec3d& p : block.exact)
            all.positions.insert(all.positions.end(), {p.x, p.y, p.z});
          all.attributes.insert(all.attributes.end(), block.attributes.begin(),
                                block.attributes.end());
          all.zeroed += block.zeroed.normals;
        },
        runner);
    all.faces =
        source
            ->read_triangles(
                [&](std::span<const Triangle<VertexId>> triangles) {
                  for (const Triangle<VertexId>& t : triangles)
                    all.corners.insert(all.corners.end(), {raw(t[0]), raw(t[1]), raw(t[2])});
                },
                runner)
            .faces;
    const std::uint64_t checksum = source->checksum([] {});
    EXPECT_EQ(checksum, open_mesh(files, "mesh")->checksum([] {}));
  });
  return all;
}

void expect_same_in_lines(const std::string& ply, const char* what) {
  SCOPED_TRACE(what);
  const Numbers words = numbers_of(with_line_ends(ply, "\r"), {});
  EXPECT_TRUE(words.faces > 0 || !words.error.empty());
  // The visits before an error are as many as blocks ask for.
  const bool is_whole = words.error.empty();
  const Numbers lines = numbers_of(ply, eager_runner());
  EXPECT_EQ(lines.error, words.error);
  EXPECT_TRUE(!is_whole || lines == words);
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(TextLines, OfPlyAreWhatWordsAre) {
  const std::string ply = ply_head() + vertex_lines() + face_lines();
  ASSERT_GT(vertex_lines().size(), 3 * LineBlocks::kBytes);
  ASSERT_GT(face_lines().size(), LineBlocks::kBytes);
  expect_same_in_lines(ply, "as it is");
  expect_same_in_lines(ply_head(true) + vertex_lines() + face_lines(), "doubles");
  expect_same_in_lines(ply.substr(0, ply.size() - 1), "no end of the last line");
  expect_same_in_lines(ply + "\n \n", "blank lines behind");
}

TEST(TextLines, OfPlyThatAreNotPlainAreReadByWords) {
  const std::string vertices = vertex_lines(), faces = face_lines();
  const auto with_vertices = [&](std::string_view what, std::string_view by) {
    return ply_head() + replaced(vertices, what, by) + faces;
  };
  const auto with_faces = [&](std::string_view what, std::string_view by) {
    return ply_head() + vertices + replaced(faces, what, by);
  };
  expect_same_in_lines(with_vertices(" -15000 ", " nan "), "a normal that is none");
  expect_same_in_lines(with_vertices(" -15000 ", " +1 "), "a sign");
  expect_same_in_lines(with_vertices(" -15000 -0.15000", " \t1\v2 "), "other blanks");
  expect_same_in_lines(with_vertices("\n50 ", "\n\n 50 "), "a blank line");
  expect_same_in_lines(with_vertices(" -15000 ", " 1 2 "), "a number too many");
  expect_same_in_lines(with_vertices(" -15000 ", " "), "a number too few");
  expect_same_in_lines(with_vertices(" -15000 ", "\n-15000 "), "a line that is cut");
  expect_same_in_lines(with_vertices(" -15000 ", " 1x "), "no number");
  expect_same_in_lines(with_vertices(" 7 50\n", " 256 50\n"), "no byte");
  expect_same_in_lines(with_vertices("\n99 ", "\n1e39 "), "no coordinate");
  expect_same_in_lines(with_faces("\n3 14000 ", "\n\n3 14000 "), "a blank line between faces");
  expect_same_in_lines(with_faces("\n3 14000 ", "\n3 22500 "), "no vertex");
  expect_same_in_lines(with_faces("\n3 14000 ", "\n3 -1 "), "a negative index");
  expect_same_in_lines(with_faces("\n3 14000 ", "\n2 "), "two corners");
  expect_same_in_lines(with_faces("\n3 14000 ", "\n4 14000 "), "a corner too few");
  expect_same_in_lines(with_faces("\n3 14000 ", "\n300 14000 "), "a length that is no uchar");
  const std::string ply = ply_head() + vertices + faces;
  expect_same_in_lines(ply.substr(0, ply.size() / 2), "truncated");
  expect_same_in_lines(ply + "3 1 2 3\n", "a face too many");
}

TEST(TextLines, OfPlyMayBeLongerThanABlock) {
  const std::string blanks(3 * LineBlocks::kBytes, ' ');
  const std::string ply =
      ply_head() + replaced(vertex_lines(), " -15000 ", " " + blanks + "3 ") + face_lines();
  expect_same_in_lines(ply, "a line of blanks");
}

Numbers off_numbers(const std::string& content, const BlockRunner& runner) {
  Numbers all;
  Streamed streamed(content);
  all.error = input_error_of([&] {
    const OffCounts counts = read_off(
        streamed.stream(), "mesh",
        [&](Vec3d p, std::span<const float> attributes) {
          for (const double v : {p.x, p.y, p.z})
            all.positions.push_back(std::isnan(v) ? -1e99 : v);
          all.attributes.insert(all.attributes.end(), attributes.begin(), attributes.end());
        },
        [&](std::span<const Triangle<VertexId>> triangles) {
          for (const Triangle<VertexId>& t : triangles)
            all.corners.insert(all.corners.end(), {raw(t[0]), raw(t[1]), raw(t[2])});
        },
        [&](std::uint64_t, const std::optional<OffColour>& colour) {
          if (colour) {
            all.attributes.insert(all.attributes.end(), colour->numbers.begin(),
                                  colour->numbers.end());
            all.attributes.push_back(colour->are_bytes ? 1 : 0);
          }
        },
        [&](std::uint32_t vertex) {
          return Vec3d{all.positions.at(3 * vertex), all.positions.at(3 * vertex + 1),
                       all.positions.at(3 * vertex + 2)};
        },
        runner);
    all.faces = counts.faces.faces;
    all.zeroed = counts.zeroed.normals + 1000 * counts.unplaced.count +
                 1'000'000 * counts.unknown_colours + 1'000'000'000 * counts.odd.lines_behind +
                 (counts.fits_float ? 1 : 0) +
                 100 * static_cast<std::uint64_t>(counts.attributes.colour);
  });
  return all;
}

/// A comment that is longer than a block lets the header be read beyond it.
void expect_same_off(const std::string& keyword, const std::string& lines, const char* what) {
  SCOPED_TRACE(what);
  const std::string counts =
      fmt::format("{} {} 0\n", kSide * kSide, (kSide - 1) * (kSide - 1)) + lines;
  const std::string comment(2 * LineBlocks::kBytes, 'x');
  const Numbers words = off_numbers(keyword + "\n#" + comment + "\n" + counts, {});
  const Numbers blocks = off_numbers(keyword + "\n#\n" + counts, eager_runner());
  EXPECT_EQ(blocks.error, words.error);
  EXPECT_TRUE(!words.error.empty() || blocks == words);
}

std::string off_vertices(int columns) {
  std::string text;
  for (int i = 0; i < kSide * kSide; ++i) {
    text += fmt::format("{} {:.9} -0.{}", i % kSide, 1e10 / (i + 1), i);
    for (int k = 3; k < columns; ++k)
      text += fmt::format(" {}", (i * k) % 256);
    text += "\n";
  }
  return text;
}

TEST(TextLines, OfOffAreWhatWordsAre) {
  const std::string faces = face_lines();
  expect_same_off("OFF", off_vertices(3) + faces, "as it is");
  expect_same_off("OFF", off_vertices(6) + faces, "with colours");
  expect_same_off("OFF", off_vertices(7) + faces + "3 1 2 3\nwords\n", "alpha, and lines behind");
  expect_same_off("NOFF", replaced(off_vertices(6), "\n50 ", "\n# a\n\n \n50 ") + faces,
                  "normals, comments and blank lines");
  expect_same_off("STNOFF", off_vertices(8) + replaced(faces, "\n3 14000", "\n 3  14000"),
                  "normals and texture coordinates");
  std::string coloured = faces;
  for (std::size_t at = 0; (at = coloured.find("\n3 14", at)) != std::string::npos; at += 30)
    coloured.insert(coloured.find('\n', at + 1), at % 2 == 0 ? " 0.3 1 0.25" : " 255 0 16 7");
  expect_same_off("OFF", off_vertices(3) + coloured, "faces with colours");
  expect_same_off("OFF", off_vertices(3) + faces.substr(0, faces.size() - 1), "no last line end");
  expect_same_off("OFF", with_line_ends(off_vertices(3) + faces, " "), "one line");
}

TEST(TextLines, OfOffThatAreNotPlainAreReadByWords) {
  const std::string faces = face_lines();
  const auto with_vertices = [&](std::string_view what, std::string_view by) {
    return replaced(off_vertices(6), what, by) + faces;
  };
  const auto with_faces = [&](std::string_view what, std::string_view by) {
    return off_vertices(6) + replaced(faces, what, by);
  };
  expect_same_off("OFF", with_vertices("-0.15000 ", "nan "), "no number");
  expect_same_off("OFF", with_vertices("-0.15000 ", "1e39 "), "no coordinate");
  expect_same_off("OFF", with_vertices("-0.15000 ", "16777217 "), "no float");
  expect_same_off("OFF", with_vertices("-0.15000 ", "-0 "), "a negative zero");
  expect_same_off("OFF", with_vertices("-0.15000 ", "x "), "a word");
  expect_same_off("OFF", with_vertices("-0.15000 ", "1 2 "), "a number too many");
  expect_same_off("OFF", with_vertices("-0.15000 ", "1 2#"), "a comment in a word");
  expect_same_off("OFF", with_vertices("-0.15000 200 ", "1 0.5 "), "a colour of no byte");
  expect_same_off("OFF", with_faces("\n3 14000 ", "\n3 22500 "), "no vertex");
  expect_same_off("OFF", with_faces("\n3 14000 ", "\n3 1.0 "), "no integer");
  expect_same_off("OFF", with_faces("\n3 14000 ", "\n2 "), "a line");
  expect_same_off("OFF", with_faces("\n3 14000 ", "\n3 1 2 3 4 5 6 7 8 "), "numbers behind");
  expect_same_off("OFF", with_faces("3 0 1 150", "3 0 1 150 4 5 6 7 8"), "behind the first face");
  expect_same_off("OFF", with_faces("\n3 14000 ", "\n4 14000 "), "a corner too few");
  const std::string all = off_vertices(3) + faces;
  expect_same_off("OFF", all.substr(0, all.size() / 3), "truncated");
}

TEST(TextLines, MayEndWithTwoCharactersAndBeReadByOneThread) {
  const std::string ply = ply_head() + vertex_lines() + face_lines();
  const Numbers expected = numbers_of(ply, eager_runner());
  EXPECT_EQ(numbers_of(ply, {}), expected);
  EXPECT_EQ(numbers_of(with_line_ends(ply, "\r\n"), eager_runner()), expected);
  const std::string off = fmt::format("OFF\n{} {}\n", kSide * kSide, (kSide - 1) * (kSide - 1)) +
                          off_vertices(6) + face_lines();
  const Numbers expected_off = off_numbers(off, eager_runner());
  EXPECT_EQ(off_numbers(off, {}), expected_off);
  EXPECT_EQ(off_numbers(with_line_ends(off, "\r\n"), eager_runner()), expected_off);
  EXPECT_EQ(off_numbers(with_line_ends(off, "\r"), eager_runner()), expected_off);
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
