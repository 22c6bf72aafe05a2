// STL files: colours of facets, and facets that are nowhere.
#include "import/import_test.h"

#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Triangles of a strip in a plane, one for each attribute; `bad`: whose last corner is not finite.
std::string stl_of(const std::vector<std::uint16_t>& attributes, const std::string& header = "",
                   std::size_t bad = SIZE_MAX) {
  std::string file = header;
  file.resize(80, ' ');
  const auto put = [&](const auto& value) {
    std::array<char, sizeof value> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    file.append(bytes.data(), bytes.size());
  };
  put(static_cast<std::uint32_t>(attributes.size()));
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    put(std::array<float, 3>{});
    for (std::size_t k = i; k < i + 3; ++k) {
      const bool is_bad = i == bad && k == i + 2;
      put(std::array<float, 3>{static_cast<float>(k), static_cast<float>(k % 2),
                               is_bad ? std::numeric_limits<float>::quiet_NaN() : 0.0F});
    }
    put(attributes[i]);
  }
  return file;
}

/// Returns the colour of each triangle's first corner; all corners have the same.
std::vector<std::string> colours(const Imported& mesh) {
  std::vector<std::string> all;
  for (const auto& triangle : mesh.triangles) {
    const auto colour = [&](std::uint32_t vertex) {
      const float* c = mesh.attributes.data() + vertex * std::size_t{3};
      return fmt::format("{} {} {}", c[0], c[1], c[2]);
    };
    all.push_back(colour(triangle[0]));
    EXPECT_EQ(colour(triangle[1]), all.back());
    EXPECT_EQ(colour(triangle[2]), all.back());
  }
  return all;
}

class StlImportTest : public ImportTest {};

TEST_F(StlImportTest, FacetsHaveColoursOfVisCam) {
  put("a.stl", stl_of({0xfc00, 0xfc00, 0x83e0, 0x801f, 0}));
  const Imported mesh = import_file("a.stl");
  EXPECT_EQ(mesh.layout, AttributeLayout{.colour = ColourType::u8});
  EXPECT_THAT(colours(mesh),
              ElementsAre("255 0 0", "255 0 0", "0 255 0", "0 0 255", "255 255 255"));
  EXPECT_EQ(mesh.positions.size(), 4U + 3 * 3);
  EXPECT_EQ(mesh.count("faces_made_white"), 1U);
  EXPECT_EQ(mesh.count("ignored_facet_attributes"), 0U);
  EXPECT_EQ(import_file("a.stl", {.memory = kTight}).positions, mesh.positions);
}

TEST_F(StlImportTest, FacetsHaveColoursOfMagics) {
  put("a.stl", stl_of({0xffff, 0x001f, 0x7c00}, std::string("part COLOR=\x0a\x14\x1e\xff")));
  EXPECT_THAT(colours(import_file("a.stl")), ElementsAre("10 20 30", "255 0 0", "0 0 255"));
}

TEST_F(StlImportTest, OtherNumbersAreCounted) {
  put("a.stl", stl_of({1, 0x8001, 0}));
  const Imported mesh = import_file("a.stl");
  EXPECT_EQ(mesh.layout, AttributeLayout());
  EXPECT_EQ(mesh.positions.size(), 5U);
  EXPECT_EQ(mesh.count("ignored_facet_attributes"), 2U);
}

TEST_F(StlImportTest, AFacetThatIsNowhereIsLeftOut) {
  put("a.stl", stl_of({0xfc00, 0x83e0, 0x801f, 0x801f}, "", 1));
  const Imported mesh = import_file("a.stl");
  EXPECT_THAT(colours(mesh), ElementsAre("255 0 0", "0 0 255", "0 0 255"));
  EXPECT_EQ(mesh.count("dropped_facets"), 1U);
  EXPECT_THAT(mesh.warnings, ElementsAre(::testing::AllOf(HasSubstr("in facet 1, found nan"),
                                                          HasSubstr("1 such facet left out"))));
  put("b.stl", stl_of({0}, "", 0));
  EXPECT_THAT(failure_of_file("b.stl"), HasSubstr("that is so of most facets"));
}

TEST_F(StlImportTest, ATextMayEndInZerosAndBeginTwice) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\n";
  put("a.stl", "solid a\nsolid b\n" + facet + "endsolid\n" + std::string(3, '\0'));
  const Imported mesh = import_file("a.stl");
  EXPECT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.count("odd_header_lines"), 1U);
  EXPECT_EQ(mesh.count("ignored_bytes_behind"), 3U);
  EXPECT_THAT(mesh.warnings, IsEmpty());
  put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1.0 2 3\n" + std::string(100'000, '\0'));
  EXPECT_EQ(import_file("a.obj").count("ignored_bytes_behind"), 100'000U);
  EXPECT_EQ(import_file("a.obj").count("integers_written_as_floats"), 1U);
  put("a.off", "off\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2" + std::string(7, '\0'));
  EXPECT_EQ(import_file("a.off").count("ignored_bytes_behind"), 7U);
}

}  // namespace
}  // namespace meshhier::tests
