#include "mesh_io/inflated_file.h"

#include "base/error.h"
#include "mesh_io/input_error.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include <zlib.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint64_t kBetweenStates = std::uint64_t{1} << 20;
constexpr std::size_t kPackedBlock = std::size_t{1} << 16;
/// zlib's largest window, and 16 more: a gzip header and its checksum.
constexpr int kGzipMember = 15 + 16;

/// A decoder somewhere in a file.
class Inflater {
 public:
  Inflater() {
    if (inflateInit2(&state_, kGzipMember) != Z_OK)
      throw Error(ErrorCode::internal, "zlib cannot be used");
  }
  /// Bytes that wait to be unpacked are read again.
  Inflater(const Inflater& other) : packed_(other.packed_ - other.state_.avail_in), at_(other.at_) {
    if (inflateCopy(&state_, const_cast<z_stream*>(&other.state_)) != Z_OK)
      throw Error(ErrorCode::internal, "zlib cannot copy its state");
    state_.avail_in = 0;
  }
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&state_); }

  /// Returns the place in what the file holds.
  std::uint64_t at() const { return at_; }

  void read(const storage::File& file, std::vector<std::byte>& block, std::span<std::byte> to) {
    state_.next_out = reinterpret_cast<Bytef*>(to.data());
    state_.avail_out = static_cast<uInt>(to.size());
    while (state_.avail_out > 0) {
      if (inflate_some(file, block) && state_.avail_out > 0)
        fail(file, "the gzip data end before what they should hold");
    }
    at_ += to.size();
  }

  /// Reads the checksum behind what a file holds.
  void require_end(const storage::File& file, std::vector<std::byte>& block) {
    Bytef more = 0;
    state_.next_out = &more;
    state_.avail_out = 1;
    while (!inflate_some(file, block)) {
    }
    if (state_.avail_out == 0)
      fail(file, "the gzip data hold more than they tell");
  }

 private:
  [[noreturn]] void fail(const storage::File& file, const char* message) const {
    fail_at_byte(file.path(), packed_ - state_.avail_in, message);
  }

  /// Returns whether that was the end.
  bool inflate_some(const storage::File& file, std::vector<std::byte>& block) {
    if (state_.avail_in == 0)
      refill(file, block);
    const int result = inflate(&state_, Z_NO_FLUSH);
    if (result == Z_BUF_ERROR)
      fail(file, "expected more gzip data, found the end of the file (truncated)");
    if (result != Z_OK && result != Z_STREAM_END)
      fail(file, "expected gzip data, found damaged bytes");
    return result == Z_STREAM_END || state_.avail_out == 0;
  }

  /// At the end of the file there may still be bytes to come from what was read.
  void refill(const storage::File& file, std::vector<std::byte>& block) {
    block.resize(kPackedBlock);
    const std::size_t count = file.read_at(packed_, block);
    packed_ += count;
    state_.next_in = reinterpret_cast<Bytef*>(block.data());
    state_.avail_in = static_cast<uInt>(count);
  }

  z_stream state_{};
  std::uint64_t packed_ = 0;  ///< the byte of the file behind those that it was given
  std::uint64_t at_ = 0;
};

class InflatedFile final : public storage::ReadOnlyFile {
 public:
  InflatedFile(std::unique_ptr<storage::File> packed, std::uint64_t bytes)
      : ReadOnlyFile(packed->path()), packed_(std::move(packed)), bytes_(bytes) {
    states_.push_back(std::make_unique<Inflater>());
  }

  std::uint64_t size() const override { return bytes_; }

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= bytes_)
      return 0;
    const std::lock_guard lock(mutex_);
    go_to(offset);
    const std::size_t count = std::min<std::uint64_t>({bytes.size(), bytes_ - offset, to_state()});
    live_->read(*packed_, block_, bytes.first(count));
    if (live_->at() == bytes_)
      live_->require_end(*packed_, block_);
    return count;
  }

 private:
  /// Returns the bytes up to the next state; keeps the one that stands here.
  std::uint64_t to_state() const {
    if (live_->at() == states_.size() * kBetweenStates)
      states_.push_back(std::make_unique<Inflater>(*live_));
    return kBetweenStates - live_->at() % kBetweenStates;
  }

  void go_to(std::uint64_t offset) const {
    const std::size_t state = std::min<std::uint64_t>(offset / kBetweenStates, states_.size() - 1);
    if (!live_ || live_->at() > offset || live_->at() < state * kBetweenStates)
      live_ = std::make_unique<Inflater>(*states_[state]);
    std::array<std::byte, 4096> passed;
    while (live_->at() < offset) {
      const std::uint64_t count =
          std::min<std::uint64_t>({passed.size(), offset - live_->at(), to_state()});
      live_->read(*packed_, block_, std::span(passed).first(count));
    }
  }

  std::unique_ptr<storage::File> packed_;
  std::uint64_t bytes_;
  mutable std::mutex mutex_;  ///< guards the members below
  mutable std::vector<std::unique_ptr<Inflater>> states_;
  mutable std::unique_ptr<Inflater> live_;
  mutable std::vector<std::byte> block_;  ///< bytes that live_ unpacks
};

}  // namespace

std::unique_ptr<storage::File> inflated(std::unique_ptr<storage::File> packed,
                                        std::uint64_t bytes) {
  return std::make_unique<InflatedFile>(std::move(packed), bytes);
}

std::uint64_t told_bytes(const storage::File& packed) {
  std::array<std::byte, 4> end{};
  const std::uint64_t size = packed.size();
  if (size < end.size())
    return 0;
  packed.read_exact(size - end.size(), end);
  return storage::load_little<std::uint32_t>(end.data());
}

}  // namespace meshhier::mesh_io
