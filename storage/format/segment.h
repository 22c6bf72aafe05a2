// The result of one task of a build on many machines is one sealed file, a segment.
//
// clang-format off
//   offset    bytes
//   0         d       data, which the entries place
//   d         e       entries, each 4 bytes of length, little endian, and so many of CBOR
//   d + e     40      "meshseg" and the version, 1; then, little endian, 8 bytes each: the plan's
//                     fingerprint, d, e, and the XXH3-64 of the entries, seeded with that of the segment's name
// clang-format on
//
// The seal does not cover the data: each entry has checksums of what it places, which are compared
// when that is read. So a task reads only what it needs.
#pragma once

#include "storage/io/journal.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Identifies a segment.
struct SegmentName {
  std::uint64_t plan = 0;  ///< the plan's fingerprint
  std::string stage;
  std::uint32_t index = 0;
};

/// Returns WORK/segments/STAGE-NNNNN.
std::filesystem::path segment_path(const std::filesystem::path& work, const SegmentName& name);

/// Collects entries until all data is there. One thread at a time may use it.
class SegmentWriter final : public EntrySink {
 public:
  explicit SegmentWriter(SegmentName name) : name_(std::move(name)) {}

  void append(const Entry& entry) override;
  void sync() override {}

  /// Writes entries and seal behind the data, which are the file's first `data_bytes`, and forces
  /// all to the disk. Throws Error(io).
  void seal(File& file, std::uint64_t data_bytes) const;

 private:
  SegmentName name_;
  std::vector<std::byte> entries_;
};

/// A segment whose seal and entries are as they were written; its data is not looked at.
class Segment {
 public:
  /// Opens a segment; null if there is none. Throws Error(corrupt) if it is not sealed, damaged or
  /// of another plan, Error(io).
  static std::unique_ptr<Segment> open(FileSystem& files, const std::filesystem::path& work,
                                       const SegmentName& name);

  /// Whether it is there and sealed; false also if it is damaged or of another plan. Throws
  /// Error(io).
  static bool is_whole(FileSystem& files, const std::filesystem::path& work,
                       const SegmentName& name);

  /// Calls visit(entry) for each entry, in order. Throws Error(corrupt) if it returns false for
  /// one.
  void for_each(const std::function<bool(const EntrySink::Entry&)>& visit) const;

  /// Hands over the file, whose first data_bytes() are the data. May be called once.
  std::unique_ptr<File> take_file() { return std::move(file_); }
  std::uint64_t data_bytes() const { return data_bytes_; }

 private:
  Segment(std::unique_ptr<File> file, const SegmentName& name);

  std::filesystem::path path_;
  std::unique_ptr<File> file_;
  std::uint64_t data_bytes_ = 0;
  std::vector<std::byte> entries_;
};

}  // namespace meshhier::storage
