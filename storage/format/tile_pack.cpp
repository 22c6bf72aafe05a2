#include "storage/format/tile_pack.h"

#include "base/error.h"
#include "storage/format/glb.h"
#include "storage/format/meshopt_codec.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse_pack(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::corrupt, name + ": " + what);
}

/// Returns the u16s or u32s of a section.
std::vector<std::uint32_t> numbers_in(const Section& section, std::span<const std::byte> bytes) {
  std::vector<std::uint32_t> numbers(section.count);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::byte* at = bytes.data() + i * section.stride;
    numbers[i] =
        section.component == kU16 ? load_little<std::uint16_t>(at) : load_little<std::uint32_t>(at);
  }
  return numbers;
}

/// Writes such numbers; returns false if one does not fit.
bool put_numbers(const Section& section, std::span<const std::uint32_t> numbers,
                 std::span<std::byte> bytes) {
  const bool is_short = section.component == kU16;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::byte* at = bytes.data() + i * section.stride;
    if (is_short && numbers[i] > UINT16_MAX)
      return false;
    if (is_short)
      store_little(static_cast<std::uint16_t>(numbers[i]), at);
    else
      store_little(numbers[i], at);
  }
  return true;
}

std::vector<std::byte> pack_positions(const Section& section, std::span<const std::byte> plain,
                                      bool& exponential) {
  std::vector<std::byte> words(plain.begin(), plain.end());
  exponential = section.component == kF32 && try_filter_positions(words);
  return encode_attributes(words, section.stride);
}

std::vector<std::byte> pack_section(const TilePlan& plan, TilePart part,
                                    std::span<const std::byte> plain, bool& exponential) {
  const Section& section = plan[part];
  if (part == TilePart::position)
    return pack_positions(section, plain, exponential);
  switch (mode_of(part)) {
    case ViewMode::attributes:
      return encode_attributes(plain, section.stride);
    case ViewMode::triangles:
      return encode_triangles(numbers_in(section, plain),
                              {plan.shape().with_splits(), plan.shape().boundary});
    case ViewMode::indices:
      return encode_indices(numbers_in(section, plain));
    case ViewMode::raw:
      break;
  }
  return {plain.begin(), plain.end()};
}

/// Returns the most bytes that a section can have which was decoded from so many.
std::uint64_t most_bytes(const Section& section, TilePart part, std::uint64_t packed_bytes) {
  switch (mode_of(part)) {
    case ViewMode::attributes:
      return kMostAttributeBytes * packed_bytes;
    case ViewMode::triangles:  // a byte a triangle at least
      return 3 * section.stride * packed_bytes;
    case ViewMode::indices:  // a byte a number at least
      return section.stride * packed_bytes;
    case ViewMode::raw:
      break;
  }
  return packed_bytes;
}

bool unpack_section(const Section& section, TilePart part, std::span<const std::byte> packed,
                    std::span<std::byte> plain) {
  std::vector<std::uint32_t> numbers;
  switch (mode_of(part)) {
    case ViewMode::attributes:
      return decode_attributes(packed, section.stride, plain);
    case ViewMode::triangles:
      numbers.resize(section.count);
      return decode_triangles(packed, numbers) && put_numbers(section, numbers, plain);
    case ViewMode::indices:
      numbers.resize(section.count);
      return decode_indices(packed, numbers) && put_numbers(section, numbers, plain);
    case ViewMode::raw:
      break;
  }
  std::copy(packed.begin(), packed.end(), plain.begin());
  return true;
}

/// Returns the extension of a compressed view; an empty object if there is none.
Json extension_of(const Json& document, int view) {
  const Json::json_pointer place("/bufferViews/" + std::to_string(view) + "/extensions/" +
                                 kMeshoptExtension);
  const bool is_there = document.contains(place) && document[place].is_object();
  return is_there ? document[place] : Json::object();
}

}  // namespace

PackedBin pack_bin(const TilePlan& plan, std::span<const std::byte> plain) {
  PackedBin packed;
  for (std::size_t i = 0; i < kPartCount; ++i) {
    const auto part = static_cast<TilePart>(i);
    const Section& section = plan[part];
    if (section.view < 0)
      continue;
    const auto bytes = pack_section(plan, part, plain.subspan(section.offset, section.bytes()),
                                    packed.packing.exponential);
    packed.packing.bytes[i] = bytes.size();
    packed.bin.resize(begin_of(part, packed.bin.size()));
    packed.bin.insert(packed.bin.end(), bytes.begin(), bytes.end());
    packed.bin.resize(aligned4(packed.bin.size()));
  }
  return packed;
}

Packing read_packing(const Json& document, const TilePlan& plan, std::span<const std::byte> bin,
                     const std::string& name) {
  Packing packing;
  for (std::size_t i = 0; i < kPartCount; ++i) {
    const auto part = static_cast<TilePart>(i);
    const Section& section = plan[part];
    if (section.view < 0)
      continue;
    packing.bytes[i] = section.bytes();
    if (mode_of(part) != ViewMode::raw) {
      const Json extension = extension_of(document, section.view);
      packing.bytes[i] = require_count(extension, "byteLength", bin.size(), name);
      packing.exponential |= part == TilePart::position && extension.contains("filter");
    }
    if (section.bytes() > most_bytes(section, part, packing.bytes[i])) {
      refuse_pack(name, fmt::format("{} of {} bytes cannot come from {} compressed ones",
                                    key_of(part), section.bytes(), packing.bytes[i]));
    }
  }
  if (packing.total() != bin.size()) {
    refuse_pack(
        name, fmt::format("the BIN chunk has {} bytes, expected {}", bin.size(), packing.total()));
  }
  return packing;
}

std::vector<std::byte> unpack_bin(const TilePlan& plan, const Packing& packing,
                                  std::span<const std::byte> bin, const std::string& name) {
  std::vector<std::byte> plain(plan.bytes());
  for (std::size_t i = 0; i < kPartCount; ++i) {
    const auto part = static_cast<TilePart>(i);
    const Section& section = plan[part];
    if (section.view < 0)
      continue;
    const auto target = std::span(plain).subspan(section.offset, section.bytes());
    if (!unpack_section(section, part, bin.subspan(packing.offset(part), packing.bytes[i]), target))
      refuse_pack(name, fmt::format("the compressed {} cannot be decoded", key_of(part)));
    if (part == TilePart::position && packing.exponential &&
        (section.component != kF32 || !unfilter_positions(target)))
      refuse_pack(name, "the filtered positions cannot be decoded");
  }
  return plain;
}

}  // namespace meshhier::storage
