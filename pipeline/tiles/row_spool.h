// Rows of numbers that come in any order, each known by its number.
#pragma once

#include "base/error.h"
#include "pipeline/tiles/joined_spool.h"
#include "pipeline/tiles/spool_json.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// Rows of `width` numbers, spooled in runs, each with the number of its first row. Parts and
/// threads are as JoinedSpool's; rows of each part are numbered behind those of the parts before.
class RowSpool {
 public:
  RowSpool(storage::ScratchFile& scratch, std::size_t block_bytes, std::size_t width)
      : runs_(scratch, block_bytes), width_(width) {}

  /// Appends the rows `first`, first + 1, ...; each number may come once.
  void append(std::uint32_t first, std::span<const float> rows) {
    const auto count = static_cast<std::uint32_t>(rows.size() / width_);
    runs_.append(Header{std::bit_cast<float>(first), std::bit_cast<float>(count)});
    runs_.append(rows);
    counts_[0] += count;
  }

  /// Returns the number of rows that are there.
  std::uint64_t size() const {
    return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  }

  /// Calls visit(number of the first, rows) for runs of all rows, as they came, `batch` rows or
  /// fewer. Throws Error(corrupt) if their numbers are not those of size() rows.
  template <class Visit>
  void for_each(std::size_t batch, const Visit& visit) const {
    std::uint64_t before = 0;
    auto count = counts_.begin();
    runs_.for_each_part([&](const storage::RecordSpool<float>& part) {
      Reader reader(part, std::max(batch * width_, Header().size()));
      std::uint64_t rows = 0;
      while (!reader.is_at_end())
        rows += visit_run(reader, before, *count, visit);
      if (rows != *count)
        throw_corrupt();
      before += *count++;
    });
  }

  void clear() {
    runs_.clear();
    counts_ = {0};
  }
  /// Returns what spool_json.h does, with the number of rows behind.
  nlohmann::json store() {
    nlohmann::json stored = pipeline::store(runs_);
    stored.push_back(counts_[0]);
    return stored;
  }
  bool restore(const nlohmann::json& stored) {
    const std::uint32_t count = stored.at(4);
    const bool is_empty = runs_.size() == 0;
    if (!pipeline::restore(runs_, stored))
      return false;
    if (is_empty)
      counts_[0] = count;
    else if (count > 0)
      counts_.push_back(count);
    return stored.at(0) != 0 || count == 0;
  }
  std::optional<Error> find_change() const { return runs_.find_change(); }

 private:
  using Header = std::array<float, 2>;  ///< bits: number of the first row, rows

  /// Reads the numbers of a spool, some at a time.
  class Reader {
   public:
    Reader(const storage::RecordSpool<float>& spool, std::size_t room)
        : spool_(spool), buffer_(std::min<std::uint64_t>(room, spool.size())) {}

    bool is_at_end() const { return begin_ == end_ && next_ == spool_.size(); }
    /// Returns the numbers that follow: a multiple of `least`, no more than `most`. Throws
    /// Error(corrupt) if there are fewer than `least`.
    std::span<const float> take(std::size_t least, std::uint64_t most) {
      if (end_ - begin_ < least)
        fill();
      if (end_ - begin_ < least)
        throw_corrupt();
      const std::size_t count = std::min<std::uint64_t>(end_ - begin_, most) / least * least;
      begin_ += count;
      return std::span(buffer_).subspan(begin_ - count, count);
    }

   private:
    void fill() {
      std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
                buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
      end_ -= begin_;
      begin_ = 0;
      const std::uint64_t count =
          std::min<std::uint64_t>(buffer_.size() - end_, spool_.size() - next_);
      spool_.read(next_, std::span(buffer_).subspan(end_, count));
      next_ += count;
      end_ += count;
    }

    const storage::RecordSpool<float>& spool_;
    std::vector<float> buffer_;
    std::size_t begin_ = 0, end_ = 0;  ///< range of the buffer that is still to be taken
    std::uint64_t next_ = 0;           ///< next number of the spool to be read
  };

  [[noreturn]] static void throw_corrupt() {
    throw Error(ErrorCode::corrupt, "rows of a spool are not those that it should have");
  }

  /// Returns how many rows it has.
  template <class Visit>
  std::uint32_t visit_run(Reader& reader, std::uint64_t before, std::uint32_t rows,
                          const Visit& visit) const {
    const std::span<const float> header = reader.take(Header().size(), Header().size());
    auto first = std::bit_cast<std::uint32_t>(header[0]);
    const auto all = std::bit_cast<std::uint32_t>(header[1]);
    std::uint32_t left = all;
    if (left > rows || first > rows - left)
      throw_corrupt();
    while (left > 0) {
      const std::span<const float> some = reader.take(width_, std::uint64_t{left} * width_);
      visit(before + first, some);
      const auto count = static_cast<std::uint32_t>(some.size() / width_);
      first += count;
      left -= count;
    }
    return all;
  }

  JoinedSpool<float> runs_;
  std::size_t width_;
  std::vector<std::uint32_t> counts_{0};  ///< rows of each part
};

}  // namespace meshhier::pipeline
