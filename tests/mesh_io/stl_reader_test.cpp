// STL files, binary and ASCII: what is read, and what is refused.
#include "mesh_io/stl_reader.h"

#include "mesh_io/line_blocks.h"
#include "mesh_io/stl_block.h"
#include "streams.h"
#include "support/gzip.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using ::testing::HasSubstr;

using Facet = std::array<float, 9>;

/// Normals are not finite: nobody looks at them.
std::string binary_stl(const std::vector<Facet>& facets, std::uint16_t attribute = 0) {
  std::string file(80, ' ');
  const auto put = [&](auto value) {
    std::array<char, sizeof value> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    file.append(bytes.data(), bytes.size());
  };
  put(static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) {
    for (int i = 0; i < 3; ++i)
      put(std::numeric_limits<float>::quiet_NaN());
    for (const float coordinate : facet)
      put(coordinate);
    put(attribute);
  }
  return file;
}

std::vector<Facet> many_facets(std::size_t count) {
  std::vector<Facet> facets(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 9; ++k)
      facets[i][k] = static_cast<float>(i) + 0.125F * static_cast<float>(k);
  }
  return facets;
}

struct StlTaken {
  std::vector<std::string> facets;
  StlCounts counts;
};

template <class Read>
StlTaken take(const std::string& content, const Read& read) {
  StlTaken taken;
  Streamed streamed(content);
  taken.counts = read(streamed.stream(), "mesh", [&](std::span<const SoupTriangle> triangles) {
    for (const SoupTriangle& t : triangles) {
      taken.facets.push_back(fmt::format("{} {} {}, {} {} {}, {} {} {}", t[0].x, t[0].y, t[0].z,
                                         t[1].x, t[1].y, t[1].z, t[2].x, t[2].y, t[2].z));
    }
  });
  return taken;
}
StlTaken take_binary(const std::string& content) {
  return take(content,
              [](InputStream& stream, const std::filesystem::path& path, const SoupVisitor& visit) {
                return read_binary_stl(stream, path, visit);
              });
}
StlTaken take_text(const std::string& content) {
  return take(content, read_text_stl);
}

std::string facet_text(const std::string& corner = "0 1 0") {
  return "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex " + corner +
         "\n endloop\nendfacet\n";
}

TEST(StlReader, ReadsBinaryFilesOfAnySize) {
  for (const std::size_t count : {0, 1, 4096, 4097, 9000}) {
    const std::vector<Facet> facets = many_facets(count);
    const StlTaken taken = take_binary(binary_stl(facets));
    ASSERT_EQ(taken.facets.size(), count);
    EXPECT_EQ(taken.counts.facets, count);
    EXPECT_EQ(taken.counts.attributes, 0U);
    for (std::size_t i = 0; i < count; ++i) {
      const Facet& f = facets[i];
      ASSERT_EQ(taken.facets[i], fmt::format("{} {} {}, {} {} {}, {} {} {}", f[0], f[1], f[2], f[3],
                                             f[4], f[5], f[6], f[7], f[8]));
    }
  }
}

TEST(StlReader, CountsAttributesOfBinaryFacets) {
  EXPECT_EQ(take_binary(binary_stl(many_facets(3), 0x8000)).counts.attributes, 3U);
}

TEST(StlReader, ReadsTextOfSeveralSolidsInAnyCase) {
  const StlTaken taken =
      take_text("solid a b c\n" + facet_text() +
                "endsolid a b c\nSOLID\nFACET NORMAL x y z\nOuter "
                "Loop\nVERTEX 1 2 3\nVERTEX 4 5 6\nVERTEX 7 8 9\nENDLOOP\nENDFACET\nENDSOLID");
  EXPECT_THAT(taken.facets, ::testing::ElementsAre("0 0 0, 1 0 0, 0 1 0", "1 2 3, 4 5 6, 7 8 9"));
  EXPECT_EQ(taken.counts.solids, 2U);
  EXPECT_EQ(taken.counts.facets, 2U);
  EXPECT_TRUE(taken.counts.fits_float);
}

/// Returns what blocks read of a text; the error if there is one.
std::string outcome(const std::string& content, bool by_words) {
  StlTaken taken;
  const std::string error = input_error_of([&] {
    taken = take(content, [&](InputStream& stream, const std::filesystem::path& path,
                              const SoupVisitor& visit) {
      if (!by_words)
        return read_text_stl(stream, path, visit);
      StlTextReader reader(path, visit);
      reader.take_rest(stream);
      return reader.finish();
    });
  });
  return error.empty()
             ? fmt::format("{}; {} facets, {} solids, {}", fmt::join(taken.facets, "; "),
                           taken.counts.facets, taken.counts.solids, taken.counts.fits_float)
             : error;
}

TEST(StlReader, BlocksOfFacetsSayWhatTheirWordsSay) {
  const std::string facet = facet_text();
  const std::vector<std::string> pieces = {
      facet,
      facet_text("1e-3 -.5 +2."),
      facet_text("0.1234567890123 1 2"),
      facet_text("1 2"),
      facet_text("1 2 3 4"),
      facet_text("nan 1 2"),
      facet_text("1e39 1 2"),
      facet_text("1 2 3 # here"),
      "\n \t\n",
      "# endfacet\n",
      "endsolid a\nsolid b\n",
      "ENDSOLID\nSOLID c\n",
      "endsolidname\nsolid\n",
      "end solid\nsolid\n",
      "endsolid\n",
      "solid\n",
      "endfacet\n",
      "endloop endfacet\n",
      "facet normal 0 0 1 outer\nouter\nvertex 1 2 3\n",
      "vertex 4 5 6\nvertex 7 8 9\nendloop endfacet facet\n",
      "outer loop\nvertex 1 2 3\n\nvertex 1 2 4\nvertex 1 3 3\n"
      "endloop\n endfacet \n",
      "text\n"};
  // Mostly what is right, so that much is read before an error ends it.
  std::uint64_t state = 1;
  const auto random = [&](std::size_t below) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::size_t>(state >> 33) % below;
  };
  int read = 0;
  for (int round = 0; round < 400; ++round) {
    std::string text = random(4) == 0 ? "" : "solid a\n";
    const std::size_t odd = 1 + random(30);
    for (std::size_t i = random(12); i > 0; --i)
      text += random(odd) == 0 ? pieces[random(pieces.size())] : pieces[random(3)];
    if (random(3) > 0)
      text += "endsolid";
    if (random(3) == 0)
      text = std::regex_replace(text, std::regex("\n"), random(2) == 0 ? "\r\n" : "\r");
    const std::string expected = outcome(text, true);
    ASSERT_EQ(outcome(text, false), expected) << text;
    read += expected.find(" facets, ") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(read, 100);
  EXPECT_LT(read, 390);
}

TEST(StlReader, LargeTextsAreTheSameInBlocks) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    for (const char* odd :
         {"", "\nendsolid a\nsolid b\n", "facet normal\n", "vertex 1 2 x\n", "#\n"}) {
      std::string text = "\xEF\xBB\xBFsolid\n";
      for (int i = 0; i < 9000; ++i) {
        text += facet_text(fmt::format("{} {} {}", i, i * 0.125, i % 7));
        if (i == 7000)
          text += odd;
      }
      text = std::regex_replace(text + "endsolid", std::regex("\n"), end);
      ASSERT_GT(text.size(), 2 * LineBlocks::kBytes);
      const std::string bare = text.substr(3);
      ASSERT_EQ(outcome(text, false), outcome(bare, true)) << odd;
    }
  }
}

TEST(StlReader, AFacetLongerThanABlockIsReadByWords) {
  std::string text = "solid\n" + facet_text();
  text += "facet " + std::string(LineBlocks::kBytes, 'x') + "\n" +
          facet_text().substr(facet_text().find(" outer"));
  text += facet_text() + "endsolid\n";
  EXPECT_EQ(outcome(text, false), outcome(text, true));
  EXPECT_THAT(outcome(text, false), HasSubstr("3 facets"));
}

TEST(StlReader, HandsOutManyFacetsOfAText) {
  std::string text = "solid\n";
  for (int i = 0; i < 5000; ++i)
    text += facet_text(fmt::format("0 1 {}", i));
  const StlTaken taken = take_text(text + "endsolid\n");
  ASSERT_EQ(taken.facets.size(), 5000U);
  EXPECT_EQ(taken.facets[4999], "0 0 0, 1 0 0, 0 1 4999");
}

TEST(StlReader, KnowsWhetherFloatsSayAllThatTheTextDoes) {
  EXPECT_TRUE(take_text("solid\n" + facet_text("0.1 0 0") + "endsolid").counts.fits_float);
  EXPECT_FALSE(take_text("solid\n" + facet_text("400123.123 0 0") + "endsolid").counts.fits_float);
}

TEST(StlReader, CountsWhatLiesBehindBinaryFacets) {
  const std::string file = binary_stl(many_facets(2));
  EXPECT_EQ(take_binary(file).counts.bytes_behind, 0U);
  for (const std::size_t more : {std::size_t{1}, std::size_t{50}, std::size_t{500'000}}) {
    const StlTaken taken = take_binary(file + std::string(more, 'x'));
    EXPECT_EQ(taken.facets.size(), 2U);
    EXPECT_EQ(taken.counts.bytes_behind, more);
  }
}

TEST(StlReader, ACountOf0IsAllFacetsThatAreThere) {
  for (const std::size_t count : {1, 4095, 4096, 4097, 9000}) {
    std::string file = binary_stl(many_facets(count));
    const StlTaken whole = take_binary(file);
    std::fill_n(file.begin() + 80, 4, '\0');
    const StlTaken taken = take_binary(file);
    EXPECT_EQ(taken.facets, whole.facets);
    EXPECT_EQ(taken.counts.facets, count);
    EXPECT_EQ(take_binary(file + "more").counts.bytes_behind, 4U);
  }
}

TEST(StlReader, ASolidMayEndInOtherWords) {
  for (const char* end : {"endsolid", "endsolidScene", "EndSolid\tScene", "end solid",
                          "END SOLID x", "endsolid_1 \n", " end  solid  cube\n\n"}) {
    const StlTaken taken = take_text("solid x\n" + facet_text() + end);
    EXPECT_EQ(taken.facets.size(), 1U) << end;
    EXPECT_EQ(take_text("solid x\n" + facet_text() + end + "\nsolid y\n" + facet_text() + end)
                  .counts.solids,
              2U)
        << end;
  }
}

TEST(StlReader, SolidsMayBeginAndEndTwice) {
  for (const std::string& text :
       {"solid\nsolid x\n" + facet_text() + "endsolid",
        "solid x\n" + facet_text() + "endsolid x\nendsolid\n",
        "solid x\n" + facet_text() + "solid y\n" + facet_text() + "endsolid"}) {
    const StlTaken taken = take_text(text);
    EXPECT_EQ(taken.counts.odd, OddSyntax{.header_lines = 1}) << text;
    EXPECT_EQ(taken.counts.solids, 1U) << text;
    EXPECT_EQ(taken.facets.size(), taken.counts.facets) << text;
  }
}

TEST(StlReader, FacetsThatAreNotFiniteAreLeftOutAndCounted) {
  for (const float bad :
       {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    std::vector<Facet> facets = many_facets(5);
    facets[1][4] = facets[3][8] = bad;
    const StlTaken taken = take_binary(binary_stl(facets));
    EXPECT_EQ(taken.facets.size(), 3U);
    EXPECT_EQ(taken.counts.facets, 5U);
    EXPECT_EQ(taken.counts.dropped.count, 2U);
    EXPECT_EQ(taken.counts.dropped.first,
              fmt::format("mesh: byte {}: expected a coordinate from -8.5e37 to 8.5e37 (2^126) in "
                          "facet 1, found {}",
                          84 + 50 + 12 + 16, bad));
  }
  const StlTaken text =
      take_text("solid\n" + facet_text() + facet_text("1 nan 3") + facet_text() + "endsolid");
  EXPECT_EQ(text.facets.size(), 2U);
  EXPECT_EQ(text.counts.facets, 3U);
  EXPECT_EQ(text.counts.dropped.count, 1U);
  EXPECT_THAT(text.counts.dropped.first, HasSubstr("mesh: line 13: expected a finite number"));
  EXPECT_THAT(text.counts.dropped.first, HasSubstr("(facet 1)"));
}

TEST(StlReader, ColoursOfFacetsAreOfTwoKinds) {
  StlColours viscam;
  viscam.add(std::array<std::uint16_t, 3>{0xfc00, 0x801f, 0});
  ASSERT_TRUE(viscam.any());
  EXPECT_EQ(viscam.colour_of(0xfc00), (StlColour{255, 0, 0}));
  EXPECT_EQ(viscam.colour_of(0x83e0), (StlColour{0, 255, 0}));
  EXPECT_EQ(viscam.colour_of(0x801f), (StlColour{0, 0, 255}));
  EXPECT_EQ(viscam.colour_of(0x8010), (StlColour{0, 0, 132}));
  EXPECT_EQ(viscam.colour_of(0), std::nullopt);

  StlColours magics;
  magics.set_header(StlColour{10, 20, 30});
  magics.add(std::array<std::uint16_t, 2>{0x8000, 0x001f});
  EXPECT_EQ(magics.colour_of(0xffff), (StlColour{10, 20, 30}));
  EXPECT_EQ(magics.colour_of(0x001f), (StlColour{255, 0, 0}));
  EXPECT_EQ(magics.colour_of(0x7c00), (StlColour{0, 0, 255}));
  EXPECT_EQ(magics.colour_of(0), (StlColour{0, 0, 0}));

  StlColours whole;
  whole.set_header(StlColour{10, 20, 30});
  whole.add(std::array<std::uint16_t, 2>{0, 0});
  EXPECT_EQ(whole.colour_of(0), (StlColour{10, 20, 30})) << "nobody has chosen black";
}

TEST(StlReader, NumbersOfOtherKindsAreNoColours) {
  for (const std::array<std::uint16_t, 3>& numbers : {std::array<std::uint16_t, 3>{0, 0, 0},
                                                      {1, 2, 3},
                                                      {0x8000, 0x8000, 0x8000},
                                                      {0xfc00, 7, 0}}) {
    StlColours colours;
    colours.add(numbers);
    EXPECT_FALSE(colours.any()) << numbers[0];
  }
}

TEST(StlReader, TheColourOfAllStandsInTheHeader) {
  std::string file = binary_stl(many_facets(1));
  EXPECT_EQ(take_binary(file).counts.header_colour, std::nullopt);
  file.replace(20, 10, std::string("COLOR=\x01\x02\xff\xff"));
  EXPECT_EQ(take_binary(file).counts.header_colour, (StlColour{1, 2, 255}));
}

TEST(StlReader, RefusesBinaryFilesThatAreCutAnywhere) {
  const std::string file = binary_stl(many_facets(2));
  const auto refusal = [](const std::string& content) {
    return input_error_of([&] { take_binary(content); });
  };
  for (std::size_t size = 0; size < file.size(); ++size)
    EXPECT_NE(refusal(file.substr(0, size)), "") << size;
  EXPECT_EQ(refusal(file.substr(0, 150)),
            "mesh: byte 134: expected facet 1 of 2, found the end of the data (truncated)");
  std::string lying = file;
  lying[83] = '\x7f';  // two billion facets
  EXPECT_THAT(refusal(lying), HasSubstr("mesh: byte 184: expected facet 2 of 213070"));
}

TEST(StlReader, RefusesCoordinatesOutOfRange) {
  for (const float bad : {3e38F, -3e38F}) {
    std::vector<Facet> facets = many_facets(2);
    facets[1][4] = bad;
    EXPECT_EQ(input_error_of([&] { take_binary(binary_stl(facets)); }),
              fmt::format("mesh: byte {}: expected a coordinate from -8.5e37 to 8.5e37 (2^126) in "
                          "facet 1, found {}",
                          84 + 50 + 12 + 16, bad));
  }
}

TEST(StlReader, RefusesTextThatIsNoneAndNamesTheLine) {
  const auto refusal = [](const std::string& content) {
    return input_error_of([&] { take_text(content); });
  };
  EXPECT_EQ(refusal("solid\n"),
            "mesh: line 2: expected 'facet' or 'endsolid', found the end of the file (truncated)");
  EXPECT_EQ(refusal("solid\nfacets\n"),
            "mesh: line 2: expected 'facet' or 'endsolid', found 'facets'");
  EXPECT_EQ(refusal("solid\nend\n"), "mesh: line 2: expected 'facet' or 'endsolid', found 'end'");
  EXPECT_EQ(refusal("solid\nend loop\n"),
            "mesh: line 2: expected 'facet' or 'endsolid', found 'end'");
  EXPECT_EQ(refusal("solid\nendsolid\nmore\n"), "mesh: line 3: expected 'solid', found 'more'");
  EXPECT_EQ(refusal("solid\nfacet\nouter loop\nvertex 1 2 3\nendloop\n"),
            "mesh: line 5: expected 'vertex', found 'endloop'");
  EXPECT_THAT(refusal("solid\n" + facet_text("1 2")), HasSubstr("line 6: expected a number"));
  EXPECT_THAT(refusal("solid\n" + facet_text("1 2 3 4")), HasSubstr("line 6: expected the end of"));
  EXPECT_THAT(refusal("solid\n" + facet_text("1 2 x")), HasSubstr("expected a finite number"));
  EXPECT_THAT(refusal("solid\nfacet\nouter loop\nvertex 1 2 3\nvertex 1 2 3\nvertex 1 2 3\nvertex "
                      "1 2 3\n"),
              HasSubstr("line 7: expected 'endloop', found 'vertex'"));
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
