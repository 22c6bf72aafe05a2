#include "server/client_key.h"

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

TEST(ClientKeyTest, AnIPv4AddressIsItsOwnKey) {
  EXPECT_EQ(client_key("192.0.2.7"), "192.0.2.7");
  EXPECT_NE(client_key("192.0.2.7"), client_key("192.0.2.8"));
}

TEST(ClientKeyTest, AnIPv6ClientIsItsNetwork) {
  EXPECT_EQ(client_key("2001:db8:1:2::1"), "2001:db8:1:2::/64");
  EXPECT_EQ(client_key("2001:db8:1:2:ffff:ffff:ffff:ffff"), "2001:db8:1:2::/64");
  EXPECT_NE(client_key("2001:db8:1:3::1"), "2001:db8:1:2::/64");
  EXPECT_EQ(client_key("fe80::1%eth0"), client_key("fe80::2%eth0"));
}

TEST(ClientKeyTest, AMappedAddressIsThatOfIPv4) {
  EXPECT_EQ(client_key("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_NE(client_key("::ffff:192.0.2.7"), client_key("::ffff:192.0.2.8"));
}

TEST(ClientKeyTest, TheLoopbackIsKnownHoweverItIsWritten) {
  for (const char* own : {"127.0.0.1", "127.255.0.9", "::1", "::ffff:127.0.0.1", "0:0:0:0:0:0:0:1"})
    EXPECT_TRUE(is_loopback_client(own)) << own;
  for (const char* other : {"", "128.0.0.1", "12.7.0.0", "::", "::2", "::ffff:10.0.0.1", "1::1",
                            "::7f00:1", "localhost", "fe80::1%lo"})
    EXPECT_FALSE(is_loopback_client(other)) << other;
}

TEST(ClientKeyTest, OtherTextStays) {
  for (const char* text : {"", "unknown", "1:2"})
    EXPECT_EQ(client_key(text), text);
}

}  // namespace
}  // namespace meshhier::server
