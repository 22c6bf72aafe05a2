#include "server/conditions.h"

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

TEST(ConditionsTest, TagsTellFilesAndVersionsApart) {
  const storage::FileVersion file{.device = 1, .inode = 2, .bytes = 3, .modified_ns = 4};
  const auto changed = [&](auto change) {
    storage::FileVersion other = file;
    change(other);
    return file_tag(other, 0);
  };
  const std::string tag = file_tag(file, 0);
  EXPECT_EQ(tag, file_tag(file, 0));
  EXPECT_NE(tag, changed([](auto& f) { f.inode = 5; }));
  EXPECT_NE(tag, changed([](auto& f) { f.bytes = 5; }));
  EXPECT_NE(tag, changed([](auto& f) { f.modified_ns = 5; }));
  EXPECT_NE(tag, file_tag(file, 5));
  EXPECT_TRUE(tag.starts_with('"') && tag.ends_with('"')) << tag;
  EXPECT_NE(text_tag("a"), text_tag("b"));
}

TEST(ConditionsTest, ATagIsFoundInAList) {
  for (const char* list : {"\"a\"", "\"x\", \"a\"", "\"x\",W/\"a\" ,\"y\"", "*", " * ", "W/\"a\""})
    EXPECT_TRUE(names_tag(list, "\"a\"")) << list;
  for (const char* list : {"", ",", "\"b\"", "a", "\"a", "\"ab\"", "w/\"a\"", "W/", "\"A\""})
    EXPECT_FALSE(names_tag(list, "\"a\"")) << list;
}

TEST(ConditionsTest, EncodingsAreWeighed) {
  for (const char* header : {"gzip", "GZIP", "deflate, gzip", "gzip;q=0.5", "gzip; q=1.0", "*",
                             "br, *;q=0.1", "x-gzip", "gzip;q=0.001", "identity;q=0, gzip"})
    EXPECT_TRUE(allows_gzip(header)) << header;
  for (const char* header :
       {"", "identity", "br", "gzip;q=0", "gzip; q=0.000", "*;q=0", "gzip;q=0, *", "gzi", "gzipp"})
    EXPECT_FALSE(allows_gzip(header)) << header;
}

TEST(ConditionsTest, OnlyTheLoopbacksOwnNamesAreItsNames) {
  for (const char* host : {"localhost", "LocalHost:8080", "127.0.0.1", "127.0.0.1:1", "[::1]",
                           "[::1]:65535", "127.0.0.2", "127.255.255.254:8080", "127.1"})
    EXPECT_TRUE(is_loopback_name(host)) << host;
  for (const char* host : {"",
                           "evil.example",
                           "localhost.evil.example",
                           "127.0.0.1.evil.example",
                           "evil.example:8080",
                           "localhost:80a",
                           "localhost:999999",
                           "127.evil.example",
                           "127.",
                           "127.0.0.1a",
                           "1127.0.0.1",
                           "128.0.0.1",
                           "[127.0.0.1]",
                           "[localhost]",
                           ":8080",
                           "127.0.0.1:80:80",
                           "::1",
                           "[::1",
                           "[::1]evil",
                           "localhost@evil",
                           "0.0.0.0",
                           "2130706433"})
    EXPECT_FALSE(is_loopback_name(host)) << host;
}

}  // namespace
}  // namespace meshhier::server
