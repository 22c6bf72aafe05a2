#include "server/url_path.h"

#include "tests/server/path_tricks.h"

#include <string>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

TEST(UrlPathTest, PlainPathsAreDecodedOnce) {
  EXPECT_EQ(decode_path("/"), "");
  EXPECT_EQ(decode_path("/?model=a/../b"), "");
  EXPECT_EQ(decode_path("/models.json?again"), "models.json");
  EXPECT_EQ(decode_path("/models/sub%20dir/a.hier/tiles/00/000000.glb"),
            "models/sub dir/a.hier/tiles/00/000000.glb");
  EXPECT_EQ(decode_path("/%C3%A9"), "\xc3\xa9");
  EXPECT_EQ(decode_path("/a+b&c=d"), "a+b&c=d");
  EXPECT_EQ(decode_path("/%252e%252e/a"), "%2e%2e/a") << "a name with signs of per cent in it";
  EXPECT_EQ(decode_path("/a.b./c.."), "a.b./c..") << "dots elsewhere are letters";
}

TEST(UrlPathTest, TricksAreNoPaths) {
  for (const std::string& trick : tests::kPathTricks) {
    const auto path = decode_path(trick);
    EXPECT_TRUE(!path || path->find("..") == std::string::npos || path->find("%2") != path->npos)
        << trick << " became " << *path;
  }
  for (const char* target : {"",           "models", "*",       "http://localhost/models.json",
                             "//",         "/a//b",  "/a/",     "/.",
                             "/..",        "/a/..",  "/%2e%2e", "/.hidden",
                             "/%2Ehidden", "/a%2fb", "/a%5cb",  "/a\\b",
                             "/%00",       "/a%0a",  "/a%7f",   "/%",
                             "/%2",        "/%2x",   "/%x2",    "/%u002e"})
    EXPECT_EQ(decode_path(target), std::nullopt) << target;
}

TEST(UrlPathTest, QueriesSayWhatTheySay) {
  EXPECT_EQ(query_value("/a?build=1f", "build"), "1f");
  EXPECT_EQ(query_value("/a?x=1&build=1f&y", "build"), "1f");
  EXPECT_EQ(query_value("/a?build=", "build"), "");
  EXPECT_EQ(query_value("/a?build=1=2?3", "build"), "1=2?3");
  for (const char* target : {"/a", "/a?", "/a?build", "/a?rebuild=1", "/build=1", "/a?x&&", ""})
    EXPECT_EQ(query_value(target, "build"), std::nullopt) << target;
}

TEST(UrlPathTest, LongPathsAreRefusedWhereFileSystemsRefuseThem) {
  const std::string longest(255, 'a');
  EXPECT_EQ(decode_path('/' + longest), longest);
  EXPECT_EQ(decode_path('/' + longest + 'a'), std::nullopt);
  std::string deep;
  for (int i = 0; i < 16; ++i)
    deep += '/' + longest;
  EXPECT_EQ(decode_path(deep), deep.substr(1));
  EXPECT_EQ(decode_path(deep + "/a"), std::nullopt);
}

TEST(UrlPathTest, AnyBytesComeBack) {
  std::string name;
  for (int byte = 1; byte < 256; ++byte) {
    if (byte >= ' ' && byte != 0x7f && byte != '\\' && byte != '/')
      name += static_cast<char>(byte);
  }
  const std::string text = encode_path("x/" + name.substr(0, 200));
  EXPECT_EQ(text.find_first_of("\" <>?#%&+") == std::string::npos, false) << "% is there";
  EXPECT_EQ(text.find_first_of("\" <>?#&+"), std::string::npos);
  EXPECT_EQ(decode_path('/' + text), "x/" + name.substr(0, 200));
}

}  // namespace
}  // namespace meshhier::server
