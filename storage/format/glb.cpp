#include "storage/format/glb.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

// GLB container, little endian:
//
//   offset  bytes  what
//        0      4  magic "glTF"
//        4      4  container version, 2
//        8      4  length of the file in bytes
//       12      4  length of the JSON chunk's data, a multiple of 4
//       16      4  "JSON"
//       20      n  JSON text, padded with spaces
//     20+n      4  length of the BIN chunk's data, a multiple of 4
//     24+n      4  "BIN\0"
//     28+n      m  binary data
constexpr std::uint32_t kGlbMagic = 0x46546C67;
constexpr std::uint32_t kGlbVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinChunk = 0x004E4942;
constexpr std::size_t kGlbHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

/// A tile's JSON has 1 to 2 kB, whatever the tile; 30 times that is surely not one of ours.
constexpr std::size_t kMaxJsonBytes = 64 * 1024;

/// The published files nest 8 levels; a config within the manifest some more.
constexpr int kMaxJsonDepth = 32;

/// A manifest of 33 levels has about 500 keys, a tile's JSON 100. Looking for a key goes through
/// those before it: without a limit a MiB of keys would keep the parser busy for a minute.
constexpr std::size_t kMaxJsonKeys = 4096;

/// The parser's messages begin with the place and the cause; what they quote may be the whole file.
constexpr std::size_t kMaxParserMessage = 200;

/// A key in the extras of the root tile and of the outline.
constexpr const char* kFirstView = "firstView";

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::corrupt, name + ": " + what);
}

/// Returns JSON for a message, cut to a length that fits a line.
std::string brief(const Json& value) {
  constexpr std::size_t kLength = 40;
  std::string text = json_text(value, {.only_ascii = true});
  if (text.size() > kLength)
    text = text.substr(0, kLength) + "...";
  return text;
}

/// Returns where and how `found` first differs; nothing if it does not. The recursion is as deep as
/// `expected`.
std::optional<std::string> first_difference(const Json& expected, const Json& found,
                                            const std::string& path) {
  if (expected.is_object() && found.is_object()) {
    for (const auto& [key, value] : expected.items()) {
      if (!found.contains(key))
        return path + "/" + key + " is missing";
      if (auto difference = first_difference(value, found[key], path + "/" + key))
        return difference;
    }
    for (const auto& [key, value] : found.items()) {
      if (!expected.contains(key))
        return path + "/" + brief(key) + " is not expected";
    }
    return std::nullopt;
  }
  if (expected.is_array() && found.is_array() && expected.size() == found.size()) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (auto difference = first_difference(expected[i], found[i], path + "/" + std::to_string(i)))
        return difference;
    }
    return std::nullopt;
  }
  if (expected == found)
    return std::nullopt;
  return fmt::format("{} is {}, expected {}", path, brief(found), brief(expected));
}

/// Returns an array of `count` finite numbers. Throws Error(corrupt) if it is none.
std::vector<double> require_numbers(const Json& document, const Json::json_pointer& place,
                                    std::size_t count, const std::string& name) {
  const Json found = document.contains(place) ? document[place] : Json();
  const bool fits = found.is_array() && found.size() == count &&
                    std::ranges::all_of(found, [](const Json& number) {
                      return number.is_number() && std::isfinite(number.get<double>());
                    });
  if (!fits)
    fail(name, fmt::format("JSON: {} is not {} finite numbers", place.to_string(), count));
  return found.get<std::vector<double>>();
}

void append_chunk_header(std::vector<std::byte>& bytes, std::uint64_t length, std::uint32_t type) {
  append_little(bytes, static_cast<std::uint32_t>(length));
  append_little(bytes, type);
}

/// Returns the data of the chunk whose header is at `offset`. Throws Error(corrupt) if it does not
/// end within the file.
std::span<const std::byte> read_chunk(std::span<const std::byte> bytes, std::size_t offset,
                                      std::uint32_t type, const std::string& name) {
  const char* word = type == kJsonChunk ? "JSON" : "BIN";
  if (bytes.size() - offset < kChunkHeaderBytes) {
    fail(name, fmt::format("ends at byte {}, expected the {} chunk's header at byte {}",
                           bytes.size(), word, offset));
  }
  const auto length = load_little<std::uint32_t>(bytes.data() + offset);
  const auto found = load_little<std::uint32_t>(bytes.data() + offset + 4);
  if (found != type) {
    fail(name, fmt::format("chunk type at byte {} is {:#010x}, expected {:#010x} ({})", offset + 4,
                           found, type, word));
  }
  const std::size_t left = bytes.size() - offset - kChunkHeaderBytes;
  if (length % 4 != 0 || length > left) {
    fail(name, fmt::format(
                   "length of the {} chunk at byte {} is {}, expected a multiple of 4, at most {}",
                   word, offset, length, left));
  }
  return bytes.subspan(offset + kChunkHeaderBytes, length);
}

void check_header(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.size() < kGlbHeaderBytes) {
    fail(name, fmt::format("has {} bytes, expected at least {}", bytes.size(), kGlbHeaderBytes));
  }
  const auto magic = load_little<std::uint32_t>(bytes.data());
  const auto version = load_little<std::uint32_t>(bytes.data() + 4);
  const auto length = load_little<std::uint32_t>(bytes.data() + 8);
  if (magic != kGlbMagic) {
    fail(name, fmt::format("starts with {:#010x}, expected {:#010x} (glTF)", magic, kGlbMagic));
  }
  if (version != kGlbVersion) {
    fail(name, fmt::format("GLB version at byte 4 is {}, expected {}", version, kGlbVersion));
  }
  if (length != bytes.size()) {
    fail(name,
         fmt::format("length at byte 8 is {}, but the file has {} bytes", length, bytes.size()));
  }
}

}  // namespace

Json parse_json(std::string_view text, const std::string& name) {
  std::size_t keys = 0;
  const auto guard = [&](int depth, Json::parse_event_t event, Json&) {
    if (depth > kMaxJsonDepth) {
      fail(name, fmt::format("JSON is nested deeper than {} levels", kMaxJsonDepth));
    }
    if (event == Json::parse_event_t::key && ++keys > kMaxJsonKeys) {
      fail(name, fmt::format("JSON has more than {} keys", kMaxJsonKeys));
    }
    return true;
  };
  try {
    return parse_ordered_json_text(text, guard);
  } catch (const Json::exception& error) {
    fail(name, "is not valid JSON: " + plain_text(json_fault(error.what()), kMaxParserMessage));
  }
}

void require_same_json(const Json& expected, const Json& found, const std::string& name) {
  if (const auto difference = first_difference(expected, found, "")) {
    fail(name, "JSON: " + *difference);
  }
}

std::uint64_t require_count(const Json& object, const char* key, std::uint64_t max,
                            const std::string& name) {
  const auto found = object.find(key);
  if (found == object.end())
    fail(name, fmt::format("JSON: \"{}\" is missing", key));
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > max) {
    fail(name, fmt::format("JSON: \"{}\" is {}, expected an integer from 0 to {}", key,
                           brief(*found), max));
  }
  return found->get<std::uint64_t>();
}

const Json& require_extension(const Json& document, const char* extension, unsigned version,
                              const std::string& name) {
  const Json::json_pointer place{std::string("/extensions/") + extension};
  if (!document.contains(place) || !document[place].is_object()) {
    fail(name, fmt::format("JSON: the extension {} is missing", extension));
  }
  const Json& found = document[place];
  const std::uint64_t found_version = require_count(found, "version", UINT32_MAX, name);
  if (found_version != version) {
    fail(name, fmt::format("version of {} is {}, expected {}{}", extension, found_version, version,
                           found_version > version ? " (written by a newer meshhier)" : ""));
  }
  return found;
}

Json mesh_node(const Frame& frame, double scale) {
  const Vec3d& o = frame.origin;
  const double s = scale;
  Json node = {{"mesh", 0}};
  if (frame.up == UpAxis::z) {
    node["matrix"] = {s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, o.x, o.z, -o.y, 1};
    return node;
  }
  if (o != Vec3d{})
    node["translation"] = {o.x, o.y, o.z};
  if (scale != 1)
    node["scale"] = {scale, scale, scale};
  return node;
}

Frame read_frame(const Json& document, const std::string& name) {
  const Json::json_pointer matrix("/nodes/0/matrix"), translation("/nodes/0/translation");
  if (document.contains(matrix)) {
    const std::vector<double> m = require_numbers(document, matrix, 16, name);
    return {{m[12], -m[14], m[13]}, UpAxis::z};
  }
  if (!document.contains(translation))
    return {};
  const std::vector<double> t = require_numbers(document, translation, 3, name);
  return {{t[0], t[1], t[2]}, UpAxis::y};
}

Json first_view_extras(const Standpoint& view) {
  return {{kFirstView, Json::array({view.azimuth, view.elevation})}};
}

std::optional<Standpoint> read_first_view(const Json& document, const std::string& name) {
  if (!document.contains("extras"))
    return std::nullopt;
  const Json::json_pointer place{std::string("/extras/") + kFirstView};
  const std::vector<double> angles = require_numbers(document, place, 2, name);
  const Standpoint view{angles[0], angles[1]};
  if (!view.is_sound())
    fail(name, fmt::format("JSON: {} is not two angles in degrees", place.to_string()));
  return view;
}

std::vector<std::byte> begin_glb(std::string_view json, std::size_t bin_bytes,
                                 std::size_t json_bytes) {
  assert(bin_bytes % 4 == 0);
  json_bytes = aligned4(std::max(json_bytes, json.size()));
  const std::uint64_t length = glb_bytes(json_bytes, bin_bytes);
  if (length > UINT32_MAX)
    throw Error(ErrorCode::internal, "a GLB would exceed 4 GiB");

  std::vector<std::byte> bytes;
  bytes.reserve(length);
  append_little(bytes, kGlbMagic);
  append_little(bytes, kGlbVersion);
  append_little(bytes, static_cast<std::uint32_t>(length));
  append_chunk_header(bytes, json_bytes, kJsonChunk);
  const auto text = std::as_bytes(std::span(json));
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.insert(bytes.end(), json_bytes - json.size(), std::byte{' '});
  if (bin_bytes > 0)
    append_chunk_header(bytes, bin_bytes, kBinChunk);
  bytes.resize(length);
  return bytes;
}

std::vector<std::byte> join_glb(std::string_view json, std::span<const std::byte> bin,
                                std::size_t json_bytes) {
  std::vector<std::byte> bytes = begin_glb(json, bin.size(), json_bytes);
  std::copy(bin.begin(), bin.end(), bytes.end() - static_cast<std::ptrdiff_t>(bin.size()));
  return bytes;
}

GlbView split_glb(std::span<const std::byte> bytes, const std::string& name) {
  check_header(bytes, name);
  const auto json = read_chunk(bytes, kGlbHeaderBytes, kJsonChunk, name);
  if (json.size() > kMaxJsonBytes) {
    fail(name, fmt::format("the JSON chunk has {} bytes, expected at most {}", json.size(),
                           kMaxJsonBytes));
  }
  GlbView view{{reinterpret_cast<const char*>(json.data()), json.size()}, {}};
  std::size_t end = kGlbHeaderBytes + kChunkHeaderBytes + json.size();
  if (end < bytes.size()) {
    view.bin = read_chunk(bytes, end, kBinChunk, name);
    end += kChunkHeaderBytes + view.bin.size();
  }
  if (end != bytes.size()) {
    fail(name,
         fmt::format("expected the end at byte {}, found {} more bytes", end, bytes.size() - end));
  }
  return view;
}

}  // namespace meshhier::storage
