// OFF files: what is read, and what is refused.
#include "mesh_io/off_reader.h"

#include "streams.h"

#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

struct OffTaken {
  explicit OffTaken(const std::string& content) {
    Streamed streamed(content);
    counts = read_off(
        streamed.stream(), "mesh",
        [&](Vec3d p, std::span<const float> attributes) {
          places.push_back(p);
          vertices.push_back(fmt::format("{} {} {}", p.x, p.y, p.z));
          for (const float value : attributes)
            vertices.back() += fmt::format(" {}", value);
        },
        [&](std::span<const Triangle<VertexId>> all) {
          for (const Triangle<VertexId>& t : all)
            triangles.push_back(fmt::format("{} {} {}", raw(t[0]), raw(t[1]), raw(t[2])));
        },
        [&](std::uint64_t made, const std::optional<OffColour>& colour) {
          faces.push_back(fmt::format("{}:", made));
          if (colour) {
            faces.back() +=
                fmt::format(" {}{}{}", fmt::join(colour->numbers, " "),
                            colour->has_alpha ? " alpha" : "", colour->are_bytes ? " bytes" : "");
          }
        },
        [&](std::uint32_t vertex) { return places.at(vertex); });
  }
  std::vector<Vec3d> places;
  std::vector<std::string> faces;
  std::vector<std::string> vertices, triangles;
  OffCounts counts;
};

std::string off_refusal(const std::string& content) {
  return input_error_of([&] { OffTaken{content}; });
}

constexpr const char* kOffSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST(OffReader, ReadsVerticesAndFaces) {
  const OffTaken taken("# a\nOFF # b\n\n4 2 0\n" + std::string(kOffSquare) +
                       "\n# c\n3 0 1 2\n4 0 1 2 3");
  EXPECT_THAT(taken.vertices, ElementsAre("0 0 0", "1 0 0", "1 1 0", "0 1 0"));
  EXPECT_THAT(taken.triangles, ElementsAre("0 1 2", "0 1 2", "0 2 3"));
  EXPECT_EQ(taken.counts.faces.faces, 2U);
  EXPECT_EQ(taken.counts.attributes, AttributeLayout());
  EXPECT_TRUE(taken.counts.fits_float);
}

TEST(OffReader, CountsMayStandOnTheFirstLineOrWithoutEdges) {
  for (const char* start : {"OFF 4 1 0\n", "OFF 4 1\n", "OFF\r\n4 1\r\n", "OFF\r4 1 5\r"}) {
    const OffTaken taken(start + std::string(kOffSquare) + "3 0 1 2\n");
    EXPECT_THAT(taken.triangles, ElementsAre("0 1 2")) << start;
  }
}

TEST(OffReader, ReadsAttributesInTheirOrder) {
  AttributeLayout all;
  all.normals = all.texcoords = true;
  all.colour = ColourType::u8;
  const OffTaken bytes("STCNOFF\n1 0 0\n1 2 3 0 0 1 255 128 0 0.5 0.25\n");
  EXPECT_THAT(bytes.vertices, ElementsAre("1 2 3 0 0 1 255 128 0 0.5 0.25"));
  EXPECT_EQ(bytes.counts.attributes, all);

  const OffTaken floats("COFF\n2 0 0\n1 2 3 1 0.5 0 1\n1 2 3 1 0 0 1\n");
  EXPECT_THAT(floats.vertices, ElementsAre("1 2 3 1 0.5 0 1", "1 2 3 1 0 0 1"));
  EXPECT_EQ(floats.counts.attributes.colour, ColourType::f32);
  EXPECT_TRUE(floats.counts.attributes.alpha);

  const OffTaken large("COFF\n1 0 0\n1 2 3 256 0 0\n");
  EXPECT_EQ(large.counts.attributes.colour, ColourType::f32);
  EXPECT_FALSE(large.counts.attributes.alpha);
}

TEST(OffReader, NormalsAndTextureCoordinatesThatAreNoNumbersAreZero) {
  const OffTaken taken("STNOFF\n2 0 0\n1 2 3 0 nan 1 0.5 0.25\n4 5 6 0 0 1 0.5 inf\n");
  EXPECT_THAT(taken.vertices, ElementsAre("1 2 3 0 0 0 0.5 0.25", "4 5 6 0 0 1 0 0"));
  EXPECT_EQ(taken.counts.zeroed, (ZeroedCounts{1, 1}));
}

TEST(OffReader, FacesHaveColours) {
  const OffTaken taken("OFF 4 9 0\n" + std::string(kOffSquare) +
                       "3 0 1 2 255 0 0\n3 0 1 1\n2 0 1\n3 1 2 3 7\n4 0 1 2 3 0.5 0 1 0.25\n"
                       "3 0 1 2 1 2 256 # x\n3 0 1 2 1 2\n3 0 1 2 1 nan 3\n3 0 1 2 red\n");
  EXPECT_THAT(taken.faces, ElementsAre("1: 255 0 0 1 bytes", "1:", "1:", "2:",
                                       "4: 0.5 0 1 0.25 alpha", "5: 1 2 256 1", "6:", "7:", "8:"));
  EXPECT_THAT(taken.triangles, SizeIs(8));
  EXPECT_EQ(taken.counts.unknown_colours, 4U);
  EXPECT_EQ(taken.counts.faces.degenerate_triangles, 2U);
}

TEST(OffReader, ACommentMayFollowAWordAtOnce) {
  const OffTaken taken("OFF#x\n3 1 0#y\n0 0 0#z\n1 0 0 # \n0 1 0\n3 0 1 2#3 0 1 2");
  EXPECT_THAT(taken.triangles, ElementsAre("0 1 2"));
  EXPECT_EQ(taken.counts.unknown_colours, 0U);
}

TEST(OffReader, RefusesWhatIsWrongAndNamesTheLine) {
  EXPECT_THAT(off_refusal("OF\n"), HasSubstr("line 1: expected 'OFF'"));
  EXPECT_THAT(off_refusal("4OFF\n1 0 0\n1 2 3 4\n"),
              HasSubstr("line 1: expected three coordinates"));
  EXPECT_THAT(off_refusal("OFF BINARY\n"), HasSubstr("binary OFF is not read"));
  EXPECT_THAT(off_refusal("OFF\n"), HasSubstr("expected the counts of vertices and faces"));
  EXPECT_THAT(off_refusal("OFF\n-1 0 0\n"), HasSubstr("line 2: expected the count of vertices"));
  EXPECT_THAT(off_refusal("OFF\n1\n"), HasSubstr("expected the count of faces"));
  EXPECT_THAT(off_refusal("OFF\n4294967296 0 0\n"), HasSubstr("expected the count of vertices"));
  EXPECT_THAT(off_refusal("OFF\n1 0 0 0\n1 2 3\n"),
              HasSubstr("line 2: expected the end of the line"));
  EXPECT_THAT(off_refusal("OFF\n4000000000 4000000000 0\n1 2 3\n"),
              HasSubstr("expected vertex 1 of 4000000000, found the end of the file (truncated)"));
  EXPECT_THAT(off_refusal("OFF\n1 0 0\n1 2\n"), HasSubstr("line 4: expected a number"));
  EXPECT_THAT(off_refusal("OFF\n1 0 0\n1 2 9e37\n"),
              HasSubstr("line 3: expected a coordinate from"));
  EXPECT_THAT(off_refusal("OFF\n1 0 0\n1 2 3 4\n"), HasSubstr("line 3: expected 0 numbers behind"));
  EXPECT_THAT(off_refusal("OFF\n2 0 0\n1 2 3 4 5 6\n1 2 3\n"),
              HasSubstr("line 4: expected 3 numbers behind"));
  EXPECT_THAT(off_refusal("OFF3x 1 0\n"), HasSubstr("line 1: expected 'OFF'"));
  EXPECT_THAT(off_refusal("OFF4294967296 1 0\n"), HasSubstr("expected the count of vertices"));
  EXPECT_THAT(off_refusal("COFF\n2 0 0\n1 2 3 1 1 1\n1 2 3 1 1 1 1\n"),
              HasSubstr("line 4: expected 3 numbers behind"));
  EXPECT_THAT(off_refusal("NOFF\n1 0 0\n1 2 3 0 0 up\n"), HasSubstr("line 3: expected a number"));
  EXPECT_THAT(off_refusal("COFF\n1 0 0\n1 2 3 0 nan 0\n"), HasSubstr("line 3: expected a finite"));
  EXPECT_THAT(off_refusal("OFF\n1 0 0\n1 2 x\n"), HasSubstr("line 3: expected a finite number"));
  const auto faces = [](const std::string& face) {
    return off_refusal("OFF\n4 1 0\n" + std::string(kOffSquare) + face);
  };
  EXPECT_THAT(faces(""), HasSubstr("expected face 0 of 1, found the end of the file"));
  EXPECT_THAT(faces("3 0 1\n"), HasSubstr("line 7: expected a corner of face 0"));
  EXPECT_THAT(faces("3 0 1 4\n"), HasSubstr("expected a vertex from 0 to 3 in face 0, found '4'"));
  EXPECT_THAT(faces("3 0 1 -1\n"), HasSubstr("found '-1'"));
  EXPECT_THAT(faces("-3 0 1 2\n"), HasSubstr("expected the number of a face's corners"));
  EXPECT_THAT(faces("99999999999 0 1 2\n"), HasSubstr("faces of at most 131072 corners"));
  EXPECT_THAT(faces("3 0 1,0 2\n"), HasSubstr("found '1,0'"));
  EXPECT_THAT(off_refusal("OFF\n1 0 0\n1,5 2 3\n"), HasSubstr("decimal point, not a comma"));
}

TEST(OffReader, TheCountOfVerticesMayStandRightBehindTheKeyword) {
  for (const char* start : {"OFF4 1 0\n", "OFF4 1\n", "OFF4 1 0 # c\r\n", "OFF4  1 0\n"}) {
    const OffTaken taken(start + std::string(kOffSquare) + "3 0 1 2\n");
    EXPECT_THAT(taken.vertices, ElementsAre("0 0 0", "1 0 0", "1 1 0", "0 1 0")) << start;
    EXPECT_THAT(taken.triangles, ElementsAre("0 1 2")) << start;
  }
  const OffTaken coloured("COFF3 1 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n");
  EXPECT_EQ(coloured.counts.attributes.colour, ColourType::u8);
  EXPECT_TRUE(is_off_keyword("OFF490"));
  EXPECT_FALSE(is_off_keyword("OFFER"));
}

TEST(OffReader, ColoursMayStandInAPlainFile) {
  const OffTaken bytes("OFF\n3 1 0\n0 0 0 200 90 40 255\n1 0 0 0 0 0 0\n0 1 0 1 2 3 4\n3 0 1 2\n");
  EXPECT_EQ(bytes.counts.attributes, (AttributeLayout{.colour = ColourType::u8, .alpha = true}));
  EXPECT_THAT(bytes.vertices, ElementsAre("0 0 0 200 90 40 255", "1 0 0 0 0 0 0", "0 1 0 1 2 3 4"));
  const OffTaken floats("OFF3 1 0\n0 0 0 0.5 0 1\n1 0 0 1 1 1\n0 1 0 0 0 0\n3 0 1 2\n");
  EXPECT_EQ(floats.counts.attributes, AttributeLayout{.colour = ColourType::f32});
}

TEST(OffReader, LinesMayEndAnywhere) {
  for (const char* text : {"OFF\n4 2 0\n0 0 0 1 0 0 1 1 0 0 1 0\n3 0 1 2 3 0 2 3\n",
                           "OFF\n4 2 0\n0\n0\n0\n1 0 0 1 1\n0 0 1 0 3 0 1\n2 3 0\n2 3",
                           "OFF4 2\n0 0 0 1 0 0 1 1\n0 0 1 0 # c\n3\n0 1 2 3 0 2 3",
                           "OFF\r\n4 2 0\r\n0 0\r\n0 1 0 0 1 1 0 0 1 0 3 0 1 2 3 0 2 3\r\n"}) {
    const OffTaken taken(text);
    EXPECT_THAT(taken.vertices, ElementsAre("0 0 0", "1 0 0", "1 1 0", "0 1 0")) << text;
    EXPECT_THAT(taken.triangles, ElementsAre("0 1 2", "0 2 3")) << text;
    EXPECT_EQ(taken.counts.odd.lines_behind, 0U) << text;
  }
  const OffTaken faces("OFF\n4 3 0\n" + std::string(kOffSquare) + "3 0 1 2 3 0 2 3 3\n3 2 1\n");
  EXPECT_THAT(faces.triangles, ElementsAre("0 1 2", "0 2 3", "3 2 1"));
  EXPECT_EQ(faces.counts.unknown_colours, 0U);
  EXPECT_THAT(off_refusal("OFF\n3 1 0\n0 0 0 1 0 0 1 1 0\n3 0 1 2 7\n"),
              HasSubstr("line 4: expected the end of the file behind the faces, found '7'"));
  EXPECT_THAT(off_refusal("OFF\n3 1 0\n0 0 0 1 0 0 1 1 0\n3 0 1\n"),
              HasSubstr("expected a corner of face 0"));
}

TEST(OffReader, SmallSinsAreReadAndCounted) {
  const std::string square(kOffSquare);
  for (const std::string& start :
       {std::string("off\n4 1 0\n"), std::string("Off 4 1 0\n"), std::string("off4 1 0\n"),
        std::string("OFF\n4\n1\n0\n"), std::string("OFF\n4\n1 0\n"), std::string("OFF 4\n1\n"),
        std::string("OFF\n4 1\n0\n"), std::string("OFF\n4\n# c\n\n1\n\n0\n")}) {
    const OffTaken taken(start + square + "3 0 1 2\n");
    EXPECT_THAT(taken.vertices, ElementsAre("0 0 0", "1 0 0", "1 1 0", "0 1 0")) << start;
    EXPECT_THAT(taken.triangles, ElementsAre("0 1 2")) << start;
    EXPECT_EQ(taken.counts.odd, OddSyntax{.header_lines = 1}) << start;
  }
  const OffTaken coloured("coff\n3 1 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n");
  EXPECT_EQ(coloured.counts.attributes.colour, ColourType::u8);
  EXPECT_FALSE(is_off_keyword("noff")) << "NOFF or nOFF";
  EXPECT_TRUE(is_off_keyword("off"));
  const OffTaken floats("OFF\n4 1 0\n" + square + "3.0 0.0 1.0 2.0\n");
  EXPECT_THAT(floats.triangles, ElementsAre("0 1 2"));
  EXPECT_EQ(floats.counts.odd, OddSyntax{.integers = 4});
}

TEST(OffReader, CountsWhatLiesBehindTheFaces) {
  const std::string square = "OFF\n4 1 0\n" + std::string(kOffSquare) + "3 0 1 2\n";
  EXPECT_EQ(OffTaken(square).counts.odd.lines_behind, 0U);
  EXPECT_EQ(OffTaken(square + "\n  \n# end\n").counts.odd.lines_behind, 0U);
  EXPECT_EQ(OffTaken(square + "3 0 1 2\n\nthe end\n").counts.odd.lines_behind, 2U);
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
