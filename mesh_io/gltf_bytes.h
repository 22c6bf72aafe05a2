// Bytes that accessors of a glTF file read, wherever they lie.
#pragma once

#include "storage/io/file.h"
#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace meshhier::mesh_io {

/// Bytes of a known number that can be read at any place.
class GltfBytes {
 public:
  virtual ~GltfBytes() = default;
  virtual std::uint64_t size() const = 0;
  /// Requires offset + to.size() <= size(). Throws Error(io).
  virtual void read(std::uint64_t offset, std::span<std::byte> to) const = 0;
};

/// A range of a file, whose end was checked.
class GltfFileBytes final : public GltfBytes {
 public:
  GltfFileBytes(std::shared_ptr<const storage::File> file, std::uint64_t offset,
                std::uint64_t bytes)
      : file_(std::move(file)), offset_(offset), bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_; }
  void read(std::uint64_t offset, std::span<std::byte> to) const override {
    file_->read_exact(offset_ + offset, to);
  }

 private:
  std::shared_ptr<const storage::File> file_;
  std::uint64_t offset_;
  std::uint64_t bytes_;
};

/// Decoded bytes, which go to a scratch file and do not stay in memory.
class GltfSpoolBytes final : public GltfBytes {
 public:
  explicit GltfSpoolBytes(storage::ScratchFile& scratch) : spool_(scratch, kBlockBytes) {}
  void append(std::span<const std::byte> bytes) { spool_.append(bytes); }
  std::uint64_t size() const override { return spool_.size(); }
  void read(std::uint64_t offset, std::span<std::byte> to) const override {
    spool_.read(offset, to);
  }

 private:
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 16;
  storage::Spool spool_;
};

/// A part of other bytes, which must outlive it.
struct GltfRange {
  const GltfBytes* bytes = nullptr;
  std::uint64_t offset = 0, size = 0;

  void read(std::uint64_t from, std::span<std::byte> to) const { bytes->read(offset + from, to); }
};

}  // namespace meshhier::mesh_io
