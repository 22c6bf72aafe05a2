// Rows of numbers from texts, arrays and PLYs.
#include "base/error.h"
#include "query/npy_rows.h"
#include "query/row_source.h"
#include "tests/support/gzip.h"
#include "tests/support/sample_hierarchy.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::querying {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

using Numbers = std::vector<double>;

class RowsTest : public testing::Test {
 protected:
  Numbers read(const std::string& content, RowKind kind = RowKind::points) {
    std::ofstream(path(), std::ios::binary) << content;
    Numbers numbers;
    const std::uint64_t rows = read_rows(
        *files_, path(), kind,
        [&](std::span<const double> some) {
          numbers.insert(numbers.end(), some.begin(), some.end());
        },
        [] {});
    EXPECT_EQ(rows * columns_of(kind), numbers.size());
    return numbers;
  }
  std::string failure(const std::string& content, RowKind kind = RowKind::points) {
    try {
      read(content, kind);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_THAT(error.what(), HasSubstr(path().string()));
      return error.what();
    }
    return "";
  }
  std::filesystem::path path() const { return directory_.path() / "rows"; }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(RowsTest, OfATextStandBetweenBlanksCommasSemicolonsOrTabs) {
  for (const char* text :
       {"1 2.5 -3e2\n4 5 6\n", "1,2.5,-3e2\n4, 5, 6\n", "1;2.5;-3e2;\r\n4;5;6;\r\n",
        "1\t2.5\t-3e2\r4\t5\t6", "# first\n\n  1  2.5  -3e2 # here\n4 5 6\n\n",
        "\xef\xbb\xbf"
        "1 2.5 -3e2\n4 5 6"})
    EXPECT_THAT(read(text), ElementsAre(1, 2.5, -300, 4, 5, 6)) << text;
  EXPECT_THAT(read("1 2 3 0 0 -1\n", RowKind::rays), ElementsAre(1, 2, 3, 0, 0, -1));
  EXPECT_THAT(read(""), SizeIs(0));
  EXPECT_THAT(read("# nothing\n"), SizeIs(0));
}

TEST_F(RowsTest, OfATableAreTheColumnsThatItsFirstLineNames) {
  EXPECT_THAT(read("id,\"name\",Z,y,X\n7,\"a, b\",3,2,1\n8,,6,5,4\n"),
              ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(read("x y z dx dy dz\n1 2 3 4 5 6\n"), ElementsAre(1, 2, 3));
  EXPECT_THAT(read("dx dy dz x y z\n1 2 3 4 5 6\n", RowKind::rays), ElementsAre(4, 5, 6, 1, 2, 3));
}

TEST_F(RowsTest, BetweenSemicolonsCommasSeparateNothing) {
  EXPECT_THAT(read("x;y;z;note\n1;2;3;a,b\n\n4;5;6;\n"), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(read("1,5;-2,25;3\n4.5;5e1;,5\n"), ElementsAre(1.5, -2.25, 3, 4.5, 50, 0.5));
  EXPECT_THAT(read("\"a;b\",x,y,z\n7,1,2,3\n"), ElementsAre(1, 2, 3));
  EXPECT_THAT(failure("1,2,3\n1;2;3\n4 5 6\n"),
              HasSubstr("line 2: expected 3 numbers, found 1 column;"));
  EXPECT_THAT(failure(";;;\n"), HasSubstr("line 1: expected numbers"));
  EXPECT_THAT(failure(";;;\n"), HasSubstr("among them; found nothing"));
  EXPECT_THAT(failure("1;2;3;a,b\n"), HasSubstr("line 1: expected 3 numbers, found 4 columns"));
  EXPECT_THAT(failure("1;2;3\n1,2;3,4,5;6\n"), HasSubstr("a number for y, found 3,4,5"));
  EXPECT_THAT(failure("1;2;3\n1,000.5;2;3\n"), HasSubstr("a number for x, found 1,000.5"));
}

TEST_F(RowsTest, BlankLinesAreNoneWhateverSeparates) {
  for (const char* text :
       {"1,2,3\r\n\r\n  \r\n\t\r\n# what\r\n4,5,6\r\n", "1;2;3\r\r \r4;5;6", "1 2 3\n\n \n4 5 6"})
    EXPECT_THAT(read(text), ElementsAre(1, 2, 3, 4, 5, 6)) << text;
}

TEST_F(RowsTest, OfATextMayBeManyAndInGzip) {
  std::string text;
  for (int i = 0; i < 60000; ++i)
    text += std::to_string(i) + " 0.1 1e-3\n";
  const Numbers plain = read(text);
  ASSERT_THAT(plain, SizeIs(180000));
  EXPECT_EQ(plain[179997], 59999);
  const std::string packed = tests::gzip(text);
  EXPECT_EQ(read(packed), plain);
}

TEST_F(RowsTest, NotANumberIsOneAndInfinityToo) {
  const Numbers numbers = read("nan inf -inf\n");
  EXPECT_TRUE(std::isnan(numbers[0]));
  EXPECT_EQ(numbers[1], std::numeric_limits<double>::infinity());
}

TEST_F(RowsTest, WhatIsWrongIsToldWithItsLine) {
  EXPECT_THAT(failure("1 2 3\n4 5\n"), HasSubstr("line 2: expected 3 numbers, found 2"));
  EXPECT_THAT(failure("1 2 3 4\n"),
              HasSubstr("found 4 columns; a first line with the names x, y, z"));
  EXPECT_THAT(failure("1 2 3\n4 five 6\n"),
              HasSubstr("line 2: expected a number for y, found five"));
  EXPECT_THAT(failure("1,2,3\n4,,6\n"),
              HasSubstr("line 2: expected a number for y, found nothing"));
  EXPECT_THAT(failure("x,y\n1,2\n"),
              HasSubstr("line 1: expected numbers, or the names of columns"));
  EXPECT_THAT(failure("x,y,z\n1,2\n"), HasSubstr("line 2: expected a number for z"));
  EXPECT_THAT(failure("x,y,z,n,n,X\n1,2,3,4,5,6\n"), HasSubstr("line 1: two columns are named x"));
  EXPECT_THAT(failure("1 2 3\n", RowKind::rays), HasSubstr("expected 6 numbers"));
  EXPECT_THAT(failure(std::string(200000, '1')), HasSubstr("the line has more than"));
  EXPECT_THAT(failure(std::string("1 2 3\n\0\1\2\n", 10)), HasSubstr("neither a text"));
}

template <class Number>
std::string npy(const std::string& type, const std::string& shape,
                const std::vector<Number>& numbers, const std::string& order = "False") {
  std::string head =
      "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  head.resize(117, ' ');
  head += '\n';
  std::string content("\x93NUMPY\x01\x00", 8);
  content += {static_cast<char>(head.size()), '\0'};
  content += head;
  content.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
  return content;
}

TEST_F(RowsTest, OfAnArrayAreDoublesOrFloats) {
  EXPECT_THAT(read(npy<double>("<f8", "(2, 3)", {1, 2, 3, 4, 5, 0.1})),
              ElementsAre(1, 2, 3, 4, 5, 0.1));
  EXPECT_THAT(read(npy<float>("<f4", "(1, 6)", {1, 2, 3, 4, 5, 0.5F}), RowKind::rays),
              ElementsAre(1, 2, 3, 4, 5, 0.5));
  EXPECT_THAT(read(npy<double>("<f8", "(0, 3)", {})), SizeIs(0));
}

TEST_F(RowsTest, OfAnArrayAreIntegersOrComeWithTheLargestByteFirst) {
  EXPECT_THAT(read(npy<std::int8_t>("|i1", "(1, 3)", {-1, 0, 127})), ElementsAre(-1, 0, 127));
  EXPECT_THAT(read(npy<std::uint16_t>("<u2", "(1, 3)", {65535, 1, 2})), ElementsAre(65535, 1, 2));
  EXPECT_THAT(read(npy<std::int64_t>("<i8", "(1, 3)", {-1, 1LL << 40, 2})),
              ElementsAre(-1, 0x1p40, 2));
  EXPECT_THAT(read(npy<std::uint16_t>(">i2", "(1, 3)", {0x0100, 0xfeff, 0x0201})),
              ElementsAre(1, -2, 258));
  EXPECT_THAT(read(npy<std::uint32_t>(">f4", "(1, 3)", {0x0000803f, 0x000080bf, 0})),
              ElementsAre(1, -1, 0));
  EXPECT_THAT(read(npy<std::uint64_t>(">f8", "(1, 3)", {0xf03f, 0x9a9999999999b93f, 0xf07f})),
              ElementsAre(1, 0.1, std::numeric_limits<double>::infinity()));
}

TEST_F(RowsTest, WhatIsWrongWithAnArrayIsTold) {
  const Numbers six{1, 2, 3, 4, 5, 6};
  EXPECT_THAT(failure(npy("<f8", "(3, 2)", six)),
              HasSubstr("expected an array of n x 3, found (3, 2)"));
  EXPECT_THAT(failure(npy("<f8", "(6,)", six)), HasSubstr("found (6,)"));
  EXPECT_THAT(failure(npy("<f8", "(2, 3)", six), RowKind::rays), HasSubstr("n x 6"));
  for (const char* type : {"<c16", "|b1", "<U8", "f8", "?f8", "<f2", "<f88"})
    EXPECT_THAT(failure(npy(type, "(2, 3)", six)),
                HasSubstr(std::string("found the type '") + type + "'"));
  std::string records = npy("<f8,<f8", "(3,)", six);
  records.replace(records.find("'<f8,<f8'"), 9, "[('x','f8')]");
  EXPECT_THAT(failure(records), HasSubstr("its rows are records: save numpy"));
  EXPECT_THAT(failure(npy("<f8", "(2, 3)", six, "True")), HasSubstr("Fortran order"));
  EXPECT_THAT(failure(npy("<f8", "(3, 3)", six)), HasSubstr("it ends in row 2 of 3"));
  EXPECT_THAT(failure(npy("<f8", "(1, 3)", six)), HasSubstr("more behind its 1 rows"));
  EXPECT_THAT(failure(npy("<f8", "(99999999999999999999, 3)", six)), HasSubstr("shape is wrong"));
  EXPECT_THAT(failure(npy("<f8", "(-1, 3)", six)), HasSubstr("shape is wrong"));
  EXPECT_THAT(failure(npy("<f8", "(9999999999999, 3)", six)), HasSubstr("it ends in row 2"));
  const std::string whole = npy("<f8", "(2, 3)", six);
  for (std::size_t size = 6; size < whole.size(); size += 5)
    EXPECT_NE(failure(whole.substr(0, size)), "") << size;
}

TEST_F(RowsTest, StopWhenTheyAreAskedTo) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
      "property double z\nend_header\n1 2 3\n";
  for (const std::string& content : {ply, std::string("1 2 3\n")}) {
    std::ofstream(path(), std::ios::binary) << content;
    const auto ask_to_stop = [] { throw Error(ErrorCode::interrupted, "stop"); };
    EXPECT_THROW(read_rows(
                     *files_, path(), RowKind::points, [](std::span<const double>) {}, ask_to_stop),
                 Error)
        << content;
  }
}

TEST_F(RowsTest, OfAPlyAreItsVerticesAndTheirNormals) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n"
      "1 2 3.000000001 0 0 1\n4 5 6 0 1 0\n";
  EXPECT_THAT(read(ply), ElementsAre(1, 2, 3.000000001, 4, 5, 6));
  EXPECT_THAT(read(ply, RowKind::rays), ElementsAre(1, 2, 3.000000001, 0, 0, 1, 4, 5, 6, 0, 1, 0));
  std::string bare = ply;
  bare.replace(bare.find("property float nx"), 54, "");
  EXPECT_THAT(failure(bare, RowKind::rays), HasSubstr("no normals"));
}

TEST(NpyHeadTest, IsOneThatNumpyTakes) {
  const std::string head = npy_head("[('distance', '<f8')]", 7);
  EXPECT_EQ(head.size() % 64, 0U);
  EXPECT_EQ(head.back(), '\n');
  EXPECT_THAT(head, HasSubstr("'shape': (7,)"));
}

}  // namespace
}  // namespace meshhier::querying
