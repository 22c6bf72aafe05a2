// A request's body that is there already, or ends as a test wants it.
#pragma once

#include "server/http.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace meshhier::tests {

class TextBody final : public server::Body {
 public:
  struct How {
    std::size_t most_at_once = std::numeric_limits<std::size_t>::max();
    /// Why no more comes behind the text, if more was announced.
    End end = End::whole;
    std::uint64_t missing_bytes = 0;
    std::function<void()> on_read = [] {};  ///< before each read
  };

  explicit TextBody(std::string text) : TextBody(std::move(text), How()) {}
  TextBody(std::string text, How how) : text_(std::move(text)), how_(std::move(how)) {}

  std::uint64_t bytes() const override { return text_.size() + how_.missing_bytes; }
  std::size_t read(std::span<std::byte> bytes) override {
    how_.on_read();
    const std::size_t count = std::min({bytes.size(), how_.most_at_once, text_.size() - place_});
    std::memcpy(bytes.data(), text_.data() + place_, count);
    place_ += count;
    return count;
  }
  End end() const override { return place_ == text_.size() ? how_.end : End::whole; }
  bool is_stopping() const override { return false; }

 private:
  std::string text_;
  How how_;
  std::size_t place_ = 0;
};

}  // namespace meshhier::tests
