#include "mesh_io/mtl_reader.h"

#include "mesh_io/streams.h"

#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

std::vector<MtlMaterial> read_library(const std::string& text) {
  std::vector<MtlMaterial> all;
  Streamed file(text);
  read_mtl(file.stream(), "a.mtl", [&](const MtlMaterial& material) { all.push_back(material); });
  return all;
}

MtlMaterial read_one(const std::string& lines) {
  const std::vector<MtlMaterial> all = read_library("newmtl m\n" + lines);
  EXPECT_THAT(all, SizeIs(1));
  return all.at(0);
}

/// Returns the colours of materials that are a library.
std::vector<std::array<float, 3>> shown(const std::vector<MtlMaterial>& all) {
  MtlColours colours;
  for (const MtlMaterial& material : all)
    colours.add(material);
  std::vector<std::array<float, 3>> shown;
  for (const MtlMaterial& material : all)
    shown.push_back(colours.shown(material));
  return shown;
}

std::string message_of(const std::string& text) {
  return input_error_of([&] { read_library(text); });
}

TEST(MtlReader, ReadsMaterialsInTheirOrder) {
  const auto all = read_library(
      "\xEF\xBB\xBF# library\nKd 9 9 x\n\nnewmtl  red wall \r\nKd 1 0.5 0\r\nd 0.5\rnewmtl\n"
      "map_Kd a b.png\nnewmtl red wall\nKd 0.25");
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_EQ(all[0].name, "red wall");
  EXPECT_THAT(shown(all)[0], ElementsAre(1, 0.5F, 0));
  EXPECT_EQ(all[0].opacity, 0.5F);
  EXPECT_FALSE(all[0].picture);
  EXPECT_EQ(all[1].name, "");
  EXPECT_THAT(shown(all)[1], ElementsAre(1, 1, 1));
  EXPECT_EQ(all[1].picture.value().file, "a b.png");
  EXPECT_THAT(shown(all)[2], ElementsAre(0.25F, 0.25F, 0.25F));
}

TEST(MtlReader, WordsAreOfAnyCaseAndOthersArePassedOver) {
  const MtlMaterial material = read_one(
      "\tKA 1 0 0\n  KD 2 -1 0.5 # bright\nmap_kd A.png\nmap_Kd b.png\nMAP_D c.png\nillum 2\n"
      "Pr 0.5\nbump -bm 1 n.png\nrefl -type sphere x\n\\\n\nKd xyz 1 2 3\nKd spectral a.rfl 1\n");
  EXPECT_THAT(shown({material})[0], ElementsAre(1, 0, 0.5F));
  EXPECT_EQ(material.picture.value().file, "A.png");
  EXPECT_EQ(material.alpha.value().file, "c.png");
}

TEST(MtlReader, ABackslashEndsNoComment) {
  for (const char* before : {"# made in C:\\models\\", "Ns 10 # C:\\", "Kd 1 0 0 # C:\\",
                             "map_Kd a.png # C:\\", "d 1 #\\", "illum 2 # \\"}) {
    for (const char* end : {"\n", "\r\n", "\r"}) {
      const auto all =
          read_library("newmtl a\n" + std::string(before) + end + "newmtl b\nKd 0 1 0\n");
      ASSERT_THAT(all, SizeIs(2)) << before;
      EXPECT_EQ(all[1].name, "b");
      EXPECT_THAT(shown(all)[1], ElementsAre(0, 1, 0));
    }
  }
  EXPECT_EQ(read_library("newmtl a # C:\\\nnewmtl b\n").size(), 2U);
}

TEST(MtlReader, ColoursOfALibraryAreBytesIfAllAreAndSomeGoBeyondTwo) {
  const auto colours = [](const std::string& library) { return shown(read_library(library)); };
  EXPECT_THAT(
      colours("newmtl a\nKd 255 51 0\nnewmtl b\nKd 1 0 0\nnewmtl c\n"),
      ElementsAre(ElementsAre(1, 0.2F, 0), ElementsAre(1 / 255.0F, 0, 0), ElementsAre(1, 1, 1)));
  EXPECT_THAT(colours("newmtl a\nKd 200\n"), ElementsAre(::testing::Each(200 / 255.0F)));
  for (const char* lights :
       {"newmtl a\nKd 2 1 0\n", "newmtl a\nKd 5.5 1 0\n", "newmtl a\nKd 256 1 0\n",
        "newmtl b\nKd 0.5 0 0\nnewmtl a\nKd 9 1 0\n"})
    EXPECT_THAT(colours(lights).back(), ElementsAre(1, 1, 0)) << lights;
}

TEST(MtlReader, OpacityIsWhatDSaysElseTr) {
  EXPECT_EQ(read_one("Tr 0.25").opacity, 0.75F);
  EXPECT_EQ(read_one("Tr 1").opacity, 1.0F);
  EXPECT_EQ(read_one("d 0").opacity, 1.0F);
  EXPECT_EQ(read_one("Tr 0.25\nd 0.5").opacity, 0.5F);
  EXPECT_EQ(read_one("d 0.5\nTr 0.25").opacity, 0.5F);
  EXPECT_EQ(read_one("d -halo 0.5").opacity, 0.5F);
  EXPECT_EQ(read_one("d 7").opacity, 1);
  EXPECT_EQ(read_library("newmtl a\nd 0.5\nnewmtl b\nTr 0.25")[1].opacity, 0.75F);
}

TEST(MtlReader, OptionsStandBeforeTheFile) {
  const MtlMap map =
      *read_one("map_Kd -clamp ON -o 1 -s 2 3 -mm 0 1 -t 1 2 3 -imfchan l  -x  y.png ").picture;
  EXPECT_EQ(map.file, "-x  y.png") << "no option";
  EXPECT_THAT(map.offset, ElementsAre(1, 0));
  EXPECT_THAT(map.scale, ElementsAre(2, 3));
  EXPECT_TRUE(map.clamp);
  EXPECT_EQ(read_one("map_Kd -o 1 2 3 4").picture.value().file, "4");
  EXPECT_EQ(read_one("map_Kd -o 1 2").picture.value().file, "2") << "the last is the name";
  EXPECT_EQ(read_one("map_Kd \"my a.png\"").picture.value().file, "my a.png");
  EXPECT_EQ(read_one("map_Kd -s 1 1 \\\n 1 b.png").picture.value().file, "b.png");
  EXPECT_FALSE(read_one("map_Kd\nmap_d -clamp on").picture);
}

TEST(MtlReader, FailuresNameTheLine) {
  EXPECT_EQ(message_of("newmtl a\n\nKd 1 2 three"),
            "a.mtl: line 3: expected a finite number for a colour, found 'three'");
  EXPECT_THAT(message_of("newmtl a\nKd 0,5 0 1"), HasSubstr("decimal point, not a comma"));
  EXPECT_THAT(message_of("newmtl a\nKd 1 2"), HasSubstr("line 2: expected a finite number"));
  EXPECT_THAT(message_of("newmtl a\nd"), HasSubstr("line 2: expected a finite number"));
  EXPECT_THAT(message_of("newmtl a\nTr nan"), HasSubstr("for a transparency, found 'nan'"));
  EXPECT_EQ(message_of("newmtl a\nmap_Kd -o a.png"),
            "a.mtl: line 2: expected numbers behind -o and then the name of a picture, found "
            "'a.png'");
  EXPECT_THAT(message_of("newmtl " + std::string(4097, 'x')), HasSubstr("more than 4096 bytes"));
}

TEST(MtlReader, BlanksAroundAFileDoNotCount) {
  EXPECT_EQ(read_one("map_Kd" + std::string(300'000, ' ') + "a.png" + std::string(300'000, '\t'))
                .picture.value()
                .file,
            "a.png");
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
