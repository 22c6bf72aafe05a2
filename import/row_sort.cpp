#include "import/row_sort.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <utility>

namespace meshhier::importing {
namespace {

constexpr std::size_t kRowHead = 2 * sizeof(std::uint32_t);

}  // namespace

void RowSpool::append(const Row& row) {
  const std::array lengths{static_cast<std::uint32_t>(row.key.size()),
                           static_cast<std::uint32_t>(row.bytes.size())};
  bytes_.append(std::as_bytes(std::span(lengths)));
  bytes_.append(std::as_bytes(std::span(row.key)));
  bytes_.append(std::as_bytes(std::span(row.bytes)));
  ++rows_;
}

void RowSpool::clear() {
  bytes_.clear();
  rows_ = 0;
}

RowCursor::RowCursor(const RowSpool& rows, std::uint64_t begin, std::uint64_t end,
                     std::size_t window)
    : spool_(&rows.bytes_), at_(begin), end_(end), window_(window) {}

/// Valid until the next call.
std::string_view RowCursor::take(std::size_t bytes) {
  const std::size_t left = buffer_.size() - begin_;
  if (bytes > left) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    const std::size_t more = std::max(bytes, window_) - left;
    buffer_.resize(left + static_cast<std::size_t>(std::min<std::uint64_t>(more, end_ - at_)));
    const std::span added = std::span(buffer_).subspan(left);
    spool_->read(at_, std::as_writable_bytes(added));
    at_ += added.size();
  }
  begin_ += bytes;
  return {buffer_.data() + begin_ - bytes, bytes};
}

bool RowCursor::next() {
  if (at_ == end_ && begin_ == buffer_.size())
    return false;
  std::array<std::uint32_t, 2> lengths{};
  std::memcpy(lengths.data(), take(kRowHead).data(), kRowHead);
  const std::string_view all = take(std::size_t{lengths[0]} + lengths[1]);
  row_ = {all.substr(0, lengths[0]), all.substr(lengths[0])};
  return true;
}

RowSort::RowSort(const ImportRoom& room, std::uint64_t memory_bytes)
    : room_(room),
      memory_(static_cast<std::size_t>(std::max<std::uint64_t>(memory_bytes, kLeastMemory))) {}

Row RowSort::held(std::size_t i) const {
  const Held& held = held_[i];
  return {{text_.data() + held.at, held.key}, {text_.data() + held.at + held.key, held.bytes}};
}

/// Vectors that grow take twice their size, and half as much while they are copied.
bool RowSort::is_full(const Row& row) const {
  const std::size_t bytes = text_.size() + row.key.size() + row.bytes.size();
  return 3 * (bytes + (held_.size() + 1) * sizeof(Held)) > memory_;
}

void RowSort::add(const Row& row) {
  if (!held_.empty() && is_full(row))
    spill();
  held_.push_back({text_.size(), static_cast<std::uint32_t>(row.key.size()),
                   static_cast<std::uint32_t>(row.bytes.size())});
  text_.insert(text_.end(), row.key.begin(), row.key.end());
  text_.insert(text_.end(), row.bytes.begin(), row.bytes.end());
}

void RowSort::sort_held() {
  const auto key = [&](const Held& one) {
    return std::string_view(text_.data() + one.at, one.key);
  };
  // Places in memory ascend as rows were added.
  std::ranges::sort(held_, [&](const Held& a, const Held& b) {
    const int order = key(a).compare(key(b));
    return order != 0 ? order < 0 : a.at < b.at;
  });
}

void RowSort::spill() {
  room_.cancel.check();
  sort_held();
  if (!spool_)
    spool_ = std::make_unique<RowSpool>(room_.scratch);
  const std::uint64_t begin = spool_->bytes();
  for (std::size_t i = 0; i < held_.size(); ++i)
    spool_->append(held(i));
  runs_.push_back({begin, spool_->bytes()});
  held_.clear();
  text_.clear();
}

void RowSort::sort() {
  if (runs_.empty())
    return sort_held();
  if (!held_.empty())
    spill();
  held_ = {};
  text_ = {};
  while (runs_.size() > kMostMerged)
    merge_runs();
  open(0, runs_.size());
}

/// Makes one run of each kMostMerged, in a spool of their own.
void RowSort::merge_runs() {
  auto merged = std::make_unique<RowSpool>(room_.scratch);
  std::vector<Run> runs;
  for (std::size_t first = 0; first < runs_.size(); first += kMostMerged) {
    const std::uint64_t begin = merged->bytes();
    open(first, std::min(kMostMerged, runs_.size() - first));
    while (next_merged())
      merged->append(row_);
    runs.push_back({begin, merged->bytes()});
  }
  spool_ = std::move(merged);
  runs_ = std::move(runs);
}

void RowSort::open(std::size_t first, std::size_t count) {
  heads_.clear();
  is_begun_ = false;
  const std::size_t window = std::max(memory_ / count, kLeastWindow);
  for (std::size_t i = first; i < first + count; ++i) {
    heads_.push_back(
        {RowCursor(*spool_, runs_[i].begin, runs_[i].end, std::min(window, RowCursor::kWindow)),
         i});
    heads_.back().cursor.next();
  }
}

bool RowSort::next_merged() {
  const auto is_later = [](const Head& a, const Head& b) {
    const int order = a.cursor.row().key.compare(b.cursor.row().key);
    return order != 0 ? order > 0 : a.run > b.run;
  };
  if (!is_begun_) {
    std::ranges::make_heap(heads_, is_later);
    is_begun_ = true;
  } else if (heads_.back().cursor.next()) {
    std::ranges::push_heap(heads_, is_later);
  } else {
    heads_.pop_back();
  }
  if (heads_.empty())
    return false;
  std::ranges::pop_heap(heads_, is_later);
  row_ = heads_.back().cursor.row();
  return true;
}

bool RowSort::next() {
  if (!runs_.empty())
    return next_merged();
  if (next_ == held_.size())
    return false;
  row_ = held(next_++);
  return true;
}

}  // namespace meshhier::importing
