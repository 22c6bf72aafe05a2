// OBJ files: what is read, and what is refused.
#include "mesh_io/obj_reader.h"

#include "base/error.h"
#include "mesh_io/polygon_cut.h"
#include "streams.h"
#include "support/gzip.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Notes all that was taken, as short texts.
class Taken final : public ObjVisitor {
 public:
  /// How the file is read: in blocks, or all of it word by word.
  enum class By { blocks, words };

  explicit Taken(const std::string& content, By by = By::blocks) {
    if (by == By::blocks) {
      Streamed streamed(content);
      counts = read_obj(streamed.stream(), "mesh", *this);
      return;
    }
    const std::filesystem::path path("mesh");
    ObjReader reader(path, *this);
    Streamed words(content.starts_with("\xEF\xBB\xBF") ? content.substr(3) : content);
    reader.take_rest(words.stream());
    counts = reader.finish();
  }
  void add_polypaint(const ObjColour& c) override {
    statements.push_back(fmt::format("{} {} {}", c[0], c[1], c[2]));
  }
  void use_material(const std::string& name) override {
    statements.push_back(fmt::format("{} before {}", name, triangles.size()));
  }
  void use_libraries(const std::string& names) override { statements.push_back(names); }
  Vec3d position(std::uint32_t number) override { return places.at(number); }
  void add_position(Vec3d p, const std::optional<ObjColour>& colour) override {
    places.push_back(p);
    positions.push_back(fmt::format("{} {} {}", p.x, p.y, p.z));
    if (colour)
      positions.back() += fmt::format(" / {} {} {}", (*colour)[0], (*colour)[1], (*colour)[2]);
  }
  void add_texcoord(std::array<float, 2> t) override {
    texcoords.push_back(fmt::format("{} {}", t[0], t[1]));
  }
  void add_normal(Vec3f n) override { normals.push_back(fmt::format("{} {} {}", n.x, n.y, n.z)); }
  void add_triangle(const ObjTriangle& t) override {
    std::string text;
    for (const ObjCorner& c : t) {
      const auto index = [](std::uint32_t i) {
        return i == ObjCorner::kNone ? std::string("-") : std::to_string(i);
      };
      text += fmt::format("{}{},{},{}", text.empty() ? "" : " ", c.position, index(c.texcoord),
                          index(c.normal));
    }
    triangles.push_back(text);
  }

  std::vector<Vec3d> places;
  std::vector<std::string> positions, texcoords, normals, triangles, statements;
  ObjCounts counts;
};

std::string obj_refusal(const std::string& content) {
  return input_error_of([&] { Taken{content}; });
}

/// All that was taken, or why nothing was.
std::vector<std::string> all_of(const std::string& content, Taken::By by) {
  std::vector<std::string> all;
  try {
    const Taken taken(content, by);
    for (const auto* some :
         {&taken.positions, &taken.texcoords, &taken.normals, &taken.triangles, &taken.statements})
      all.insert(all.end(), some->begin(), some->end());
    const ObjCounts& c = taken.counts;
    all.push_back(fmt::format(
        "{} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}", c.positions, c.coloured, c.painted,
        c.texcoords, c.normals, c.faces, c.triangles, c.degenerate_triangles, c.corners,
        c.textured_corners, c.normal_corners, c.groups, c.others, c.points_and_lines, c.fits_float,
        c.zeroed.normals + c.zeroed.texcoords, c.unplaced.first));
  } catch (const Error& error) {
    all = {error.what()};
  }
  return all;
}

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, ReadsVerticesOfAllKinds) {
  const Taken taken(
      "v 1 2 3\nv -1.5e2 +.25 3. 1\nv 1 2 3 0.5 0.25 1\nv 1 2 3 4 5 6 7\n"
      "vt 0.5\nvt 0.5 0.25\nvt 1 2 3\nvn 0 0 1\n");
  EXPECT_THAT(taken.positions,
              ElementsAre("1 2 3", "-150 0.25 3", "1 2 3 / 0.5 0.25 1", "1 2 3 / 4 5 6"));
  EXPECT_THAT(taken.texcoords, ElementsAre("0.5 0", "0.5 0.25", "1 2"));
  EXPECT_THAT(taken.normals, ElementsAre("0 0 1"));
  EXPECT_EQ(taken.counts.positions, 4U);
  EXPECT_EQ(taken.counts.coloured, 2U);
  EXPECT_TRUE(taken.counts.fits_float);
}

// As programs write them for faces without an area.
TEST(ObjReader, NormalsAndTextureCoordinatesThatAreNoNumbersAreZero) {
  const Taken taken(
      "vn nan nan nan\nvn 0 -nan(ind) 1\nvn 0 0 1\nvt 0.5 -1.#IND\nvt 0.5 inf 0\nvt 0.5 0.25 "
      "nan\n");
  EXPECT_THAT(taken.normals, ElementsAre("0 0 0", "0 0 0", "0 0 1"));
  EXPECT_THAT(taken.texcoords, ElementsAre("0 0", "0 0", "0.5 0.25"));
  EXPECT_EQ(taken.counts.zeroed, (ZeroedCounts{2, 2}));
}

TEST(ObjReader, ReadsCornersOfAllForms) {
  const Taken taken(std::string(kSquare) +
                    "vt 0 0\nvt 1 0\nvn 0 0 1\n"
                    "f 1 2 3\nf 1/1 2/2 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/2/1 4/1/1\nf 1/ 2// 3\n");
  EXPECT_THAT(taken.triangles,
              ElementsAre("0,-,- 1,-,- 2,-,-", "0,0,- 1,1,- 2,0,-", "0,-,0 1,-,0 2,-,0",
                          "0,0,0 1,1,0 3,0,0", "0,-,- 1,-,- 2,-,-"));
  EXPECT_EQ(taken.counts.corners, 15U);
  EXPECT_EQ(taken.counts.textured_corners, 6U);
  EXPECT_EQ(taken.counts.normal_corners, 6U);
}

TEST(ObjReader, CountsBackFromWhereItStands) {
  const Taken taken("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\n");
  EXPECT_THAT(taken.triangles, ElementsAre("0,-,- 1,-,- 2,-,-", "0,-,- 2,-,- 3,-,-"));
}

TEST(ObjReader, FacesMayComeBeforeTheirVertices) {
  EXPECT_THAT(Taken("f 1 2 3\n" + std::string(kSquare)).triangles,
              ElementsAre("0,-,- 1,-,- 2,-,-"));
}

TEST(ObjReader, PolygonsBecomeFansAndDegenerateOnesAreCounted) {
  const Taken taken(std::string(kSquare) + "f 1 2 3 4\nf 1 1 2\nf 1 2\nf\n");
  EXPECT_THAT(taken.triangles, ElementsAre("0,-,- 1,-,- 2,-,-", "0,-,- 2,-,- 3,-,-"));
  EXPECT_EQ(taken.counts.faces, 4U);
  EXPECT_EQ(taken.counts.triangles, 2U);
  EXPECT_EQ(taken.counts.degenerate_triangles, 3U);
}

TEST(ObjReader, LinesMayBeJoinedAndEndInAnyWay) {
  const Taken taken(
      "v 0 0 0\r\nv 1 \\\r\n 0 0\rv 1 1\\\n 0\n\n# v 9 9 9 \\\nf 1 \\\n2 \\\n\\\n3 # end");
  EXPECT_THAT(taken.positions, ElementsAre("0 0 0", "1 0 0", "1 1 0"));
  EXPECT_THAT(taken.triangles, ElementsAre("0,-,- 1,-,- 2,-,-"));
}

TEST(ObjReader, ABackslashEndsNoComment) {
  for (const char* comment :
       {"# from C:\\scans\\", "#\\", "\t# a \\ b \\\\", "v 7 7 7 # a folder\\",
        "g roof # C:\\roof\\", "s off # C:\\", "usemtl wall # C:\\", "mtllib a.mtl # C:\\", "#",
        "f 1 2 \\\n 3 # C:\\"}) {
    for (const char* end : {"\n", "\r\n", "\r"}) {
      const Taken taken(std::string(kSquare) + comment + end + "v 9 9 9\nf 1 2 5\n");
      EXPECT_THAT(taken.positions, Contains("9 9 9")) << comment;
      EXPECT_FALSE(taken.triangles.empty());
    }
  }
  EXPECT_THAT(Taken("v 0 0 0 # C:\\").positions, ElementsAre("0 0 0")) << "at the end of the file";
  const std::string far(300'000, 'x');
  EXPECT_THAT(Taken("# " + far + "\\\nv 0 0 0\n").positions, ElementsAre("0 0 0"));
  EXPECT_THAT(Taken("g " + far + " # \\\nv 0 0 0\n").positions, ElementsAre("0 0 0"));
}

TEST(ObjReader, ABackslashJoinsLinesThatHaveNoComment) {
  const Taken taken(std::string(kSquare) + "g a#b \\\nv 8 8 8\nf 1 2 \\\n 3\n");
  EXPECT_THAT(taken.positions, SizeIs(4)) << "a '#' within a word is none";
  EXPECT_THAT(taken.triangles, SizeIs(1));
}

/// Lines of every kind, mostly plain ones.
std::string random_lines(std::uint32_t seed, std::size_t bytes) {
  std::mt19937 random(seed);
  static constexpr std::array kPlain{"v 1 2 3",
                                     "v -0.5 1e-3 +7",
                                     "v 1 2 3 0.5 0.25 1",
                                     "vt 0.5 0.25",
                                     "vt 0.5 0.25 0",
                                     "vn 0 0 1",
                                     "f 1 2 3",
                                     "f 1 2 3 4",
                                     "f 1/1 2/1 3/1",
                                     "f 1//1 2//1 3//1",
                                     "f 1/1/1 2/1/1 3/1/1",
                                     "f -1 -2 -3",
                                     "f -1/-1 -2/-1 -3/-1",
                                     "",
                                     "# a comment"};
  static constexpr std::array kOdd{"  v 1 2 3  ",  "\tf 1 2\t3",      "v 1 2 3 # x",
                                   "v 1 2 3 0.5",  "v 1 2 3 1 0 0 1", "v nan 0 0",
                                   "vt 0.5",       "vt nan 0",        "vn inf 0 0",
                                   "f 1 2 3 # y",  "f 1 2",           "f",
                                   "f 1/1 2 3",    "f 3 2 1 1 2 3 1", "usemtl a # b",
                                   "mtllib a.mtl", "g left right",    "o",
                                   "s off",        "l 1 2",           "#MRGB ff00ff00ff102030",
                                   "#MRGBx",       "# ends in \\",    "g a \\",
                                   "f 1 \\",       "v 1 \\",          " 2 3",
                                   "\v",           "v\f1 2 3",        "v 100000.1 2 3",
                                   "vp 1 2",       "f +1 2 3",        "f 1/1/ 2/1/ 3/1/"};
  static constexpr std::array kWrong{"f 1 2 99999999", "f 0 1 2",          "f 1 2 -99999",
                                     "v 1 2",          "v 1 2 1e60",       "vx 1 2",
                                     "f 1 2 3x",       "f 4294967296 1 2", "vn 1 2 x"};
  static constexpr std::array kEnds{"\n", "\r\n", "\r"};
  const bool is_wrong = random() % 4 == 0;
  const std::size_t odd = random() % 3 == 0 ? 2 : 200;
  const char* const end = kEnds[random() % kEnds.size()];
  std::string text(random() % 3 == 0 ? "\xEF\xBB\xBF" : "");
  text += "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\n";
  while (text.size() < bytes) {
    const bool is_odd = random() % odd == 0;
    text += is_odd ? kOdd[random() % kOdd.size()] : kPlain[random() % kPlain.size()];
    if (is_wrong && random() % (bytes / 8) == 0)
      text += std::string(end) + kWrong[random() % kWrong.size()];
    text += random() % 50 == 0 ? kEnds[random() % kEnds.size()] : end;
  }
  return text + (random() % 2 == 0 ? "f 1 2 3" : "");
}

// Blocks are cut wherever a quarter of a MiB ends; nobody may see that.
TEST(ObjReader, BlocksOfLinesSayWhatWordsSay) {
  int refused = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const std::string text = random_lines(seed, seed % 4 == 0 ? 600'000 : 3000);
    const std::vector<std::string> by_words = all_of(text, Taken::By::words);
    ASSERT_EQ(all_of(text, Taken::By::blocks), by_words) << "seed " << seed;
    refused += by_words.size() == 1 ? 1 : 0;
  }
  EXPECT_GT(refused, 5);
  EXPECT_LT(refused, 40);
}

TEST(ObjReader, EveryLineAloneSaysWhatWordsSay) {
  for (const char* line : {"v 1 2 3",
                           "v 1 2 3 4",
                           "v 1 2 3 4 5",
                           "v 1 2 3 0 0 0",
                           "v 1 2 3 0 0 nan",
                           "v 1 2 3 0 0 1e39",
                           "v 1 2 3 4 5 6 7",
                           "v 1 2 3 4 5 6 7 8",
                           "v 8.6e37 0 0",
                           "v 1e999 0 0",
                           "v 1e-400 0 0",
                           "v 0x1 0 0",
                           "v 1,5 0 0",
                           "v1 2 3",
                           "vt",
                           "vt 1",
                           "vt 1 2 3",
                           "vt 1 2 3 4",
                           "vt1 2",
                           "vn 1 2",
                           "vn 1 2 3 4",
                           "vn 1e39 0 0",
                           "f 1 2",
                           "f 1 2 3 4 4",
                           "f 2147483648 1 2",
                           "f 2147483647 1 2",
                           "f 1 2 3 ",
                           "f 1 2 3\t",
                           "f 1 2 3\v",
                           "f 1/ 2/ 3/",
                           "f 1// 2// 3//",
                           "f 1/1/1 2/1/1 3/1",
                           "f 1 2 1",
                           "fo 1 2 3",
                           "f 1 2 3 #",
                           "f 1 2 3#",
                           "f 01 002 3",
                           "f +1 2 3",
                           "f --1 2 3",
                           "f 1.0 2 3",
                           "f -4 -3 -2",
                           "f -5 1 2",
                           "#",
                           "#MRGB",
                           "#MRGB 01020304",
                           "\\",
                           "v 1 2 3\\",
                           "v 1 2\\\n 3",
                           "f 1 2\\\r\n 3 4"}) {
    for (const char* end : {"", "\n", "\r\n", "\r", "\nf 1 2 4\n"}) {
      const std::string text = std::string(kSquare) + "vt 0 0\nvn 0 0 1\n" + line + end;
      EXPECT_EQ(all_of(text, Taken::By::blocks), all_of(text, Taken::By::words)) << line;
    }
  }
}

TEST(ObjReader, ALineLongerThanABlockIsReadByWords) {
  std::string face = "f";
  for (int i = 0; i < 30'000; ++i)  // 300 KB in all
    face += "  1 2 \t3 4";
  for (const std::string& line :
       {face, "g " + std::string(700'000, 'x'), "# " + std::string(700'000, 'x')}) {
    const std::string text = std::string(kSquare) + line + "\nv 9 9 9\nf 1 2 5\n";
    const std::vector<std::string> all = all_of(text, Taken::By::blocks);
    EXPECT_GT(all.size(), 6U);
    EXPECT_EQ(all, all_of(text, Taken::By::words));
  }
}

TEST(ObjReader, CountsWhatIsNoSurface) {
  const Taken taken(std::string(kSquare) +
                    "mtllib a.mtl b.mtl\no thing\ng\ng left right\nusemtl red\ns off\ns 1\n"
                    "l 1 2\np 1\nf 1 2 3\n");
  EXPECT_EQ(taken.counts.libraries, 1U);
  EXPECT_EQ(taken.counts.objects, 1U);
  EXPECT_EQ(taken.counts.groups, 2U);
  EXPECT_EQ(taken.counts.materials, 1U);
  EXPECT_EQ(taken.counts.points_and_lines, 2U);
  EXPECT_EQ(taken.counts.others, 2U);
}

TEST(ObjReader, KnowsWhetherFloatsSayAllThatTheTextDoes) {
  EXPECT_TRUE(Taken("v 0.1 123456.79 1e-30\n").counts.fits_float);
  EXPECT_FALSE(Taken("v 0.1 0.1 400123.123\n").counts.fits_float);
}

TEST(ObjReader, ReadsTheSameOutOfGzip) {
  const std::string text = std::string(kSquare) + "f 1 2 3 4\n";
  EXPECT_EQ(Taken(meshhier::tests::gzip(text)).triangles, Taken(text).triangles);
}

TEST(ObjReader, LongLinesAndManyCornersTakeNoMemory) {
  std::string text = kSquare;
  text += "# " + std::string(3'000'000, 'x') + "\nf";
  for (int i = 0; i < 30'000; ++i)
    text += " 1 2 3 4";
  const Taken taken(text);
  EXPECT_EQ(taken.counts.faces, 1U);
  EXPECT_EQ(taken.counts.triangles + taken.counts.degenerate_triangles, 119'998U);
}

TEST(ObjReader, AFaceOfTooManyCornersIsRefused) {
  std::string text = kSquare;
  text += "f";
  for (std::size_t i = 0; i <= PolygonCut::kMostCorners / 4; ++i)
    text += " 1 2 3 4";
  EXPECT_THAT(obj_refusal(text), HasSubstr("line 5: expected faces of at most 131072 corners"));
}

TEST(ObjReader, IntegersMayBeWrittenAsFloats) {
  const Taken taken(std::string(kSquare) + "f 1.0 2 3.00\nf -1.0 1 2\n");
  EXPECT_EQ(taken.counts.triangles, 2U);
  EXPECT_EQ(taken.counts.odd, OddSyntax{.integers = 3});
}

TEST(ObjReader, VerticesWithoutAPlaceAreVisitedAndCounted) {
  const Taken taken("v 0 0 0\nv 1 nan inf\nv 1e999 0 0\nv -inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 5 6\n");
  EXPECT_EQ(taken.counts.positions, 6U);
  EXPECT_EQ(taken.counts.unplaced.count, 3U);
  EXPECT_EQ(taken.counts.unplaced.first,
            "mesh: line 2: expected a finite number for a coordinate, found 'nan'");
  EXPECT_TRUE(taken.counts.fits_float);
}

TEST(ObjReader, RefusesWhatIsWrongAndNamesTheLine) {
  const auto after = [](const std::string& line) {
    return obj_refusal("v 0 0 0\nv 1 0 0\n" + line);
  };
  EXPECT_EQ(after("v 1 2\n"),
            "mesh: line 3: expected a number for a coordinate, found the end of the line");
  EXPECT_EQ(after("v 1 2 x\n"),
            "mesh: line 3: expected a finite number for a coordinate, found 'x'");
  for (const char* bad : {"0x10", "1,5"})
    EXPECT_THAT(after(fmt::format("v 1 2 {}\n", bad)), HasSubstr("expected a finite number"));
  for (const char* bad : {"-3e38", "1e200"}) {
    EXPECT_THAT(after(fmt::format("v 1 {} 3\n", bad)),
                HasSubstr("line 3: expected a coordinate from -8.5e37 to 8.5e37 (2^126), found"));
  }
  EXPECT_THAT(after("v 1 2 3 4 5\n"), HasSubstr("line 3: expected 3, 4, 6 or 7 numbers"));
  EXPECT_THAT(after("v 1 2 3 4 5 6 7 8\n"), HasSubstr("line 3: expected 3, 4, 6 or 7 numbers"));
  EXPECT_THAT(after("vn 1 2\n"), HasSubstr("line 3: expected a number for a normal"));
  EXPECT_THAT(after("v 1 2 3 0.5 0.5 1e39\n"), HasSubstr("within single precision"));
  EXPECT_THAT(after("vn 1 2 up\n"), HasSubstr("line 3: expected a number for a normal"));
  EXPECT_THAT(after("vt\n"), HasSubstr("line 3: expected a number for a texture coordinate"));
  EXPECT_THAT(after("\n# x\nfoo 1 2 3\n"), HasSubstr("line 5: expected a statement"));
  EXPECT_THAT(after("v " + std::string(5000, '1') + "\n"), HasSubstr("more than 4096 bytes"));
}

TEST(ObjReader, RefusesIndicesOfWhatIsNotThere) {
  const auto after = [](const std::string& line) {
    return obj_refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + line + "\nvt 0 0\n");
  };
  EXPECT_THAT(after("f 1 2 4"), HasSubstr("line 4: expected the number of a vertex up to 3, as "
                                          "many as the file has, found 4"));
  for (const char* bad : {"0", "-4", "x", "1.5", "", "99999999999999999999", "4294967295"}) {
    EXPECT_THAT(after(fmt::format("f 1 2 {}/1", bad)),
                HasSubstr("line 4: expected the number of a vertex from 1 on"))
        << bad;
  }
  EXPECT_THAT(after("f 1/1 2/1 3/2"), HasSubstr("line 4: expected the number of a texture "
                                                "coordinate up to 1"));
  EXPECT_THAT(after("f 1//1 2//1 3//1"), HasSubstr("expected the number of a normal up to 0"));
  EXPECT_THAT(after("f 1/-1 2/1 3/1"), HasSubstr("line 4: expected the number of a texture"));
  EXPECT_THAT(after("f 1/1/1/1 2 3"), HasSubstr("line 4: expected the number of a normal"));
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
