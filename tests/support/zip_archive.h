// Zip archives, made in code.
#pragma once

#include "storage/io/little_endian.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::tests {

namespace zip {

template <class T>
std::string zip_number(T value) {
  std::string bytes(sizeof(T), '\0');
  storage::store_little(value, reinterpret_cast<std::byte*>(bytes.data()));
  return bytes;
}
inline std::string u16(std::size_t value) {
  return zip_number(static_cast<std::uint16_t>(value));
}
inline std::string u32(std::size_t value) {
  return zip_number(static_cast<std::uint32_t>(value));
}
inline std::string u64(std::uint64_t value) {
  return zip_number(value);
}

inline std::uint32_t zip_crc(const std::string& text) {
  std::uint32_t sum = 0xffffffff;
  for (const char c : text) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit)
      sum = sum >> 1 ^ (sum & 1 ? 0xedb88320U : 0U);
  }
  return ~sum;
}

/// Text in a block of Deflate, or in a frame of Zstandard, that packs nothing.
inline std::string deflated(const std::string& text) {
  constexpr std::size_t kMost = 65535;
  if (text.size() <= kMost)
    return "\x01" + u16(text.size()) + u16(~text.size()) + text;
  return std::string(1, '\0') + u16(kMost) + u16(~kMost) + text.substr(0, kMost) +
         deflated(text.substr(kMost));
}
inline std::string in_zstd(const std::string& text) {
  return "\x28\xB5\x2F\xFD\x20" + std::string(1, static_cast<char>(text.size())) +
         u32(text.size() << 3 | 1).substr(0, 3) + text;
}

}  // namespace zip

/// A file of an archive: 0 stored, 8 in Deflate, 93 in Zstandard; `flags`: 1 says that it is
/// encrypted.
struct ZipPart {
  std::string name, content;
  std::uint16_t method = 0;
  std::uint16_t flags = 0;
  bool is_zip64 = false;
};

inline std::string packed_text(const ZipPart& part) {
  return part.method == 8    ? zip::deflated(part.content)
         : part.method == 93 ? zip::in_zstd(part.content)
                             : part.content;
}

/// Returns an archive.
inline std::string zip_of(const std::vector<ZipPart>& parts, const std::string& comment = "") {
  using zip::u16, zip::u32, zip::u64, zip::zip_crc;
  std::string bytes, directory;
  bool is_zip64 = false;
  for (const ZipPart& part : parts) {
    const std::string packed = packed_text(part);
    const std::string middle =
        u16(part.flags) + u16(part.method) + u32(0) + u32(zip_crc(part.content));
    const std::string sizes = part.is_zip64 ? u32(0xffffffff) + u32(0xffffffff)
                                            : u32(packed.size()) + u32(part.content.size());
    const std::string extra = part.is_zip64 ? u16(1) + u16(24) + u64(part.content.size()) +
                                                  u64(packed.size()) + u64(bytes.size())
                                            : "";
    directory += "PK\1\2" + u16(45) + u16(45) + middle + sizes + u16(part.name.size()) +
                 u16(extra.size()) + u16(0) + u16(0) + u16(0) + u32(0) +
                 u32(part.is_zip64 ? 0xffffffff : bytes.size()) + part.name + extra;
    bytes += "PK\3\4" + u16(45) + middle + sizes + u16(part.name.size()) + u16(3) + part.name +
             "xyz" + packed;
    is_zip64 = is_zip64 || part.is_zip64;
  }
  const std::size_t begin = bytes.size();
  bytes += directory;
  if (is_zip64) {
    const std::size_t end64 = bytes.size();
    bytes += "PK\6\6" + u64(44) + u16(45) + u16(45) + u32(0) + u32(0) + u64(parts.size()) +
             u64(parts.size()) + u64(directory.size()) + u64(begin) + "PK\6\7" + u32(0) +
             u64(end64) + u32(1);
  }
  return bytes + "PK\5\6" + u16(0) + u16(0) + u16(parts.size()) + u16(parts.size()) +
         u32(is_zip64 ? 0xffffffff : directory.size()) + u32(is_zip64 ? 0xffffffff : begin) +
         u16(comment.size()) + comment;
}

}  // namespace meshhier::tests
