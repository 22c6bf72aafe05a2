#include "mesh_io/line_blocks.h"

#include "base/text_mark.h"
#include "mesh_io/text_chars.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

namespace meshhier::mesh_io {
namespace {

/// Returns whether a line ends with the character at `at`, and the next one can begin behind it.
bool ends_line(std::string_view text, std::size_t at) {
  if (!is_line_end(text[at]))
    return false;
  if (text[at] == '\r' && (at + 1 == text.size() || text[at + 1] == '\n'))
    return false;
  const bool is_second = text[at] == '\n' && at > 0 && text[at - 1] == '\r';
  const std::size_t end = at - (is_second ? 1 : 0);
  return end == 0 || text[end - 1] != '\\';
}

}  // namespace

std::size_t whole_lines(std::string_view text) {
  std::size_t end = text.size();
  while (end > 0 && !ends_line(text, end - 1))
    --end;
  return end;
}

/// The text that was read, then the stream.
class LineBlocks::Rest final : public InputStream {
 public:
  /// Without a stream nothing follows the text.
  Rest(std::vector<char> text, InputStream* stream) : text_(std::move(text)), stream_(stream) {}

  std::size_t read(std::span<std::byte> to) override {
    const std::size_t count = std::min(to.size(), text_.size() - begin_);
    if (count > 0)
      std::memcpy(to.data(), text_.data() + begin_, count);
    begin_ += count;
    const bool goes_on = count < to.size() && stream_ != nullptr;
    return goes_on ? count + stream_->read(to.subspan(count)) : count;
  }

 private:
  std::vector<char> text_;
  std::size_t begin_ = 0;
  InputStream* stream_;
};

LineBlocks::LineBlocks(InputStream& stream, LineCut cut) : stream_(stream), cut_(cut) {}
LineBlocks::~LineBlocks() = default;

bool LineBlocks::next(std::vector<char>& block) {
  if (rest_)
    return false;
  block.resize(kBytes);
  std::ranges::copy(left_, block.begin());
  std::size_t size = left_.size();
  if (!has_ended_) {
    const auto room = std::span(block).subspan(size);
    const std::size_t count = stream_.read(std::as_writable_bytes(room));
    has_ended_ = count < room.size();
    size += count;
  }
  block.resize(size);
  if (!has_begun_ && std::string_view(block.data(), size).starts_with(kByteOrderMark))
    block.erase(block.begin(), block.begin() + kByteOrderMark.size());
  has_begun_ = true;
  const std::size_t whole = has_ended_ ? block.size() : cut_({block.data(), block.size()});
  left_.assign(block.begin() + static_cast<std::ptrdiff_t>(whole), block.end());
  block.resize(whole);
  if (whole > 0)
    return true;
  rest();
  return false;
}

InputStream& LineBlocks::rest() {
  if (!rest_)
    rest_ = std::make_unique<Rest>(std::move(left_), has_ended_ ? nullptr : &stream_);
  return *rest_;
}

}  // namespace meshhier::mesh_io
