#include "progressive/detail_file.h"

#include "base/error.h"
#include "storage/format/gzip.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <cassert>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::progressive {
namespace {

// A detail file, little endian: a head, then runs.
//
//   head                             run
//   offset  bytes  what              offset  bytes  what
//        0      8  magic                  0      4  list: 1, 2 or 3, not less than before
//                  "MHDETAIL"             4      4  entries n, 1 to 65536
//        8      4  version, 1             8      4  bytes of what follows, g
//       12      4  step                  12      g  one gzip member
//
// In the gzip member, a varint being 7 bits a byte, low ones first, 128 added to all but the last:
//
//   all lists   n varints: index - (index before + 1), over the list's runs; at first the index
//   1           for each value, for each of its bytes, low one first: n bytes, of each residual
//   2           n varints each: a - a before (0 in each run), b - a, c - b, folded
//   3           n varints: target - vertex, folded
//
// Folded: 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
constexpr std::string_view kDetailMagic = "MHDETAIL";
constexpr std::uint32_t kDetailVersion = 1;
constexpr std::size_t kDetailHeadBytes = 16;
constexpr std::size_t kRunHeadBytes = 12;

/// The most bytes for 32 bits and a sign, and for 63 bits.
constexpr std::size_t kShortVarint = 5;
constexpr std::size_t kLongVarint = 9;
constexpr std::uint64_t kMostShort = UINT32_MAX;
constexpr std::uint64_t kMostLong = INT64_MAX;

void append_varint(std::vector<std::byte>& bytes, std::uint64_t value) {
  for (; value >= 128; value >>= 7)
    bytes.push_back(static_cast<std::byte>(value | 128));
  bytes.push_back(static_cast<std::byte>(value));
}

void append_difference(std::vector<std::byte>& bytes, std::uint32_t value, std::uint32_t from) {
  const std::int64_t difference = std::int64_t{value} - std::int64_t{from};
  append_varint(bytes, static_cast<std::uint64_t>(difference) << 1 ^
                           static_cast<std::uint64_t>(difference >> 63));
}

template <class Index>
void append_gaps(std::vector<std::byte>& bytes, const std::vector<Index>& indices,
                 std::uint64_t first) {
  for (const Index index : indices) {
    append_varint(bytes, index - first);
    first = std::uint64_t{index} + 1;
  }
}

std::vector<std::byte> pack(const VertexRun& run, const AttributeLayout& layout,
                            std::uint64_t first) {
  std::vector<std::byte> bytes;
  append_gaps(bytes, run.indices, first);
  const auto width = static_cast<std::size_t>(vertex_values(layout));
  for (std::size_t value = 0; value < width; ++value) {
    for (int byte = 0; byte < value_bytes(layout, static_cast<int>(value)); ++byte) {
      for (std::size_t i = value; i < run.residuals.size(); i += width)
        bytes.push_back(static_cast<std::byte>(run.residuals[i] >> (8 * byte)));
    }
  }
  return bytes;
}

std::vector<std::byte> pack(const TriangleRun& run, const AttributeLayout&, std::uint64_t first) {
  std::vector<std::byte> bytes;
  append_gaps(bytes, run.indices, first);
  std::uint32_t before = 0;
  for (const auto& corners : run.corners)
    append_difference(bytes, corners[0], std::exchange(before, corners[0]));
  for (const std::size_t corner : {1U, 2U}) {
    for (const auto& corners : run.corners)
      append_difference(bytes, corners[corner], corners[corner - 1]);
  }
  return bytes;
}

std::vector<std::byte> pack(const MergeRun& run, const AttributeLayout&, std::uint64_t first) {
  std::vector<std::byte> bytes;
  append_gaps(bytes, run.indices, first);
  for (std::size_t i = 0; i < run.indices.size(); ++i)
    append_difference(bytes, run.targets[i], run.indices[i]);
  return bytes;
}

std::size_t most_bytes(std::uint32_t list, const AttributeLayout& layout) {
  if (list == 2)
    return kLongVarint + 3 * kShortVarint;
  if (list == 3)
    return 2 * kShortVarint;
  std::size_t bytes = kShortVarint;
  for (int value = 0; value < vertex_values(layout); ++value)
    bytes += static_cast<std::size_t>(value_bytes(layout, value));
  return bytes;
}

/// Takes the content of a run's gzip member apart.
class Unpacker {
 public:
  Unpacker(std::span<const std::byte> bytes, std::size_t entries, std::uint64_t first,
           const std::string& name)
      : bytes_(bytes), entries_(entries), first_(first), name_(name) {}

  VertexRun vertices(const AttributeLayout& layout) {
    VertexRun run;
    take_gaps(run.indices, kMostShort);
    const auto width = static_cast<std::size_t>(vertex_values(layout));
    run.residuals.resize(entries_ * width);
    for (std::size_t value = 0; value < width; ++value) {
      for (int byte = 0; byte < value_bytes(layout, static_cast<int>(value)); ++byte)
        take_plane(run.residuals, value, width, 8 * byte);
    }
    return run;
  }

  TriangleRun triangles() {
    TriangleRun run;
    take_gaps(run.indices, kMostLong);
    run.corners.resize(entries_);
    std::uint32_t before = 0;
    for (auto& corners : run.corners)
      corners[0] = before = take_difference(before);
    for (const std::size_t corner : {1U, 2U}) {
      for (auto& corners : run.corners)
        corners[corner] = take_difference(corners[corner - 1]);
    }
    return run;
  }

  MergeRun merges() {
    MergeRun run;
    take_gaps(run.indices, kMostShort);
    for (const std::uint32_t vertex : run.indices)
      run.targets.push_back(take_difference(vertex));
    return run;
  }

  void finish() const {
    if (place_ != bytes_.size())
      fail(fmt::format("{} bytes are left in a run", bytes_.size() - place_));
  }
  std::uint64_t first() const { return first_; }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

  std::byte take() {
    if (place_ == bytes_.size())
      fail("a run ends within its entries");
    return bytes_[place_++];
  }

  std::uint64_t take_varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const auto byte = std::to_integer<std::uint64_t>(take());
      value |= (byte & 127) << shift;
      if (byte < 128)
        return value;
    }
    fail("a number of more than 63 bits");
  }

  template <class Index>
  void take_gaps(std::vector<Index>& indices, std::uint64_t most) {
    indices.reserve(entries_);
    for (std::size_t i = 0; i < entries_; ++i) {
      const std::uint64_t gap = take_varint();
      if (first_ > most || gap > most - first_)
        fail("an index that is too large");
      indices.push_back(static_cast<Index>(first_ + gap));
      first_ += gap + 1;
    }
  }

  std::uint32_t take_difference(std::uint32_t from) {
    const std::uint64_t folded = take_varint();
    const std::uint64_t half = folded >> 1;
    const bool fits = (folded & 1) != 0 ? half < from : half <= kMostShort - from;
    if (!fits)
      fail("a vertex that is no number of 32 bits");
    return static_cast<std::uint32_t>((folded & 1) != 0 ? from - half - 1 : from + half);
  }

  void take_plane(std::vector<std::uint32_t>& residuals, std::size_t value, std::size_t width,
                  int shift) {
    if (entries_ > bytes_.size() - place_)
      fail("a run ends within its entries");
    for (std::size_t i = 0; i < entries_; ++i) {
      residuals[value + i * width] |= std::to_integer<std::uint32_t>(bytes_[place_ + i]) << shift;
    }
    place_ += entries_;
  }

  std::span<const std::byte> bytes_;
  std::size_t place_ = 0;
  std::size_t entries_;
  std::uint64_t first_;
  const std::string& name_;
};

}  // namespace

std::vector<std::byte> detail_head(std::uint32_t step) {
  const auto magic = std::as_bytes(std::span(kDetailMagic));
  std::vector<std::byte> head(magic.begin(), magic.end());
  storage::append_little(head, kDetailVersion);
  storage::append_little(head, step);
  return head;
}

std::vector<std::byte> encode_run(const DetailRun& run, const AttributeLayout& layout,
                                  std::uint64_t first) {
  const std::size_t entries = std::visit([](const auto& list) { return list.indices.size(); }, run);
  assert(entries > 0 && entries <= kRunEntries);
  const std::vector<std::byte> packed =
      storage::gzip(std::visit([&](const auto& list) { return pack(list, layout, first); }, run),
                    storage::Repetitions::runs);
  std::vector<std::byte> bytes;
  storage::append_little(bytes, static_cast<std::uint32_t>(run.index() + 1));
  storage::append_little(bytes, static_cast<std::uint32_t>(entries));
  storage::append_little(bytes, static_cast<std::uint32_t>(packed.size()));
  bytes.insert(bytes.end(), packed.begin(), packed.end());
  return bytes;
}

DetailFileReader::DetailFileReader(std::span<const std::byte> bytes, std::uint32_t step,
                                   const AttributeLayout& layout, std::string name)
    : bytes_(bytes), layout_(layout), name_(std::move(name)), place_(kDetailHeadBytes) {
  const std::vector<std::byte> head = detail_head(step);
  const auto starts_with = [&](std::size_t count) {
    return bytes.size() >= head.size() &&
           std::equal(head.begin(), head.begin() + count, bytes.begin());
  };
  if (!starts_with(kDetailMagic.size()))
    throw Error(ErrorCode::corrupt, name_ + ": is no file of a progressive stream");
  const auto version = storage::load_little<std::uint32_t>(bytes.data() + kDetailMagic.size());
  if (version != kDetailVersion) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: version is {}, expected {}{}", name_, version, kDetailVersion,
                            version > kDetailVersion ? " (written by a newer meshhier)" : ""));
  }
  if (!starts_with(head.size())) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: does not start as the file of step {}", name_, step));
  }
}

std::optional<DetailRun> DetailFileReader::next() {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::corrupt, fmt::format("{}: byte {}: {}", name_, place_, what));
  };
  if (place_ == bytes_.size())
    return std::nullopt;
  if (bytes_.size() - place_ < kRunHeadBytes)
    fail("a run is cut");
  const auto number = [&](std::size_t offset) {
    return storage::load_little<std::uint32_t>(bytes_.data() + place_ + offset);
  };
  const std::uint32_t list = number(0);
  const std::uint32_t entries = number(4);
  const std::uint32_t packed = number(8);
  if (list < list_ || list > 3)
    fail(fmt::format("list is {}, expected {} to 3", list, list_));
  if (entries == 0 || entries > kRunEntries)
    fail(fmt::format("a run of {} entries, expected 1 to {}", entries, kRunEntries));
  if (packed > bytes_.size() - place_ - kRunHeadBytes)
    fail("a run is cut");
  if (list != list_)
    first_ = 0;
  list_ = list;
  const std::vector<std::byte> plain = storage::gunzip(
      bytes_.subspan(place_ + kRunHeadBytes, packed), entries * most_bytes(list, layout_), name_);
  Unpacker unpacker(plain, entries, first_, name_);
  DetailRun run = list == 1   ? DetailRun(unpacker.vertices(layout_))
                  : list == 2 ? DetailRun(unpacker.triangles())
                              : DetailRun(unpacker.merges());
  unpacker.finish();
  first_ = unpacker.first();
  place_ += kRunHeadBytes + packed;
  return run;
}

}  // namespace meshhier::progressive
