#include "server/byte_range.h"

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

using Kind = RangeAnswer::Kind;

RangeAnswer part(std::uint64_t offset, std::uint64_t bytes) {
  return {Kind::part, {offset, bytes}};
}

void expect(const char* header, const RangeAnswer& expected, std::uint64_t file_bytes = 100) {
  const RangeAnswer answer = find_range(header, file_bytes);
  EXPECT_EQ(answer.kind, expected.kind) << header;
  EXPECT_EQ(answer.range, expected.range) << header;
}

TEST(ByteRangeTest, PartsAreFound) {
  expect("bytes=0-0", part(0, 1));
  expect("bytes=0-99", part(0, 100));
  expect("bytes=10-19", part(10, 10));
  expect("bytes=10-", part(10, 90));
  expect("bytes=99-", part(99, 1));
  expect("bytes=90-1000", part(90, 10));
  expect("bytes= 10-19 ", part(10, 10));
  expect("Bytes=10-19", part(10, 10));
}

TEST(ByteRangeTest, TheLastBytesAreFound) {
  expect("bytes=-1", part(99, 1));
  expect("bytes=-100", part(0, 100));
  expect("bytes=-5000", part(0, 100));
}

TEST(ByteRangeTest, NumbersOfAnyLengthDoNoHarm) {
  expect("bytes=0-99999999999999999999999", part(0, 100));
  expect("bytes=-99999999999999999999999", part(0, 100));
  expect("bytes=99999999999999999999999-", {Kind::outside, {}});
  expect("bytes=18446744073709551615-18446744073709551615", {Kind::outside, {}});
  expect("bytes=0-18446744073709551615", part(0, 100));
}

TEST(ByteRangeTest, WhatLiesOutsideIsTold) {
  expect("bytes=100-", {Kind::outside, {}});
  expect("bytes=100-200", {Kind::outside, {}});
  expect("bytes=-0", {Kind::outside, {}});
  expect("bytes=0-0", {Kind::outside, {}}, 0);
  expect("bytes=-1", {Kind::outside, {}}, 0);
}

TEST(ByteRangeTest, AnythingElseIsTheWholeFile) {
  for (const char* header : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=1", "bytes=5-4",
                             "bytes=--1", "bytes=1--2", "bytes=+1-2", "bytes=0x1-2",
                             "bytes=1-2,4-5", "bytes=0-,0-,0-", "items=0-1", "Bytes 0-1"})
    expect(header, {});
}

}  // namespace
}  // namespace meshhier::server
