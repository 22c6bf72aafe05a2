#include "storage/io/json_text.h"

#include <iterator>

namespace meshhier::storage {
namespace {

/// A function's characters as an iterator, for the parser.
class Characters {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Characters() = default;
  explicit Characters(const std::function<int()>& next) : next_(&next) { ++*this; }
  const char& operator*() const { return c_; }
  Characters& operator++() {
    const int c = (*next_)();
    c_ = static_cast<char>(c);
    if (c < 0)
      next_ = nullptr;
    return *this;
  }
  Characters operator++(int) {
    const Characters before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const Characters& a, const Characters& b) { return a.next_ == b.next_; }

 private:
  const std::function<int()>* next_ = nullptr;
  char c_ = 0;
};

template <class Json>
std::string text_of(const Json& value, JsonLayout layout) {
  using Handler = typename Json::error_handler_t;
  return value.dump(layout.indent, ' ', layout.only_ascii,
                    layout.throws ? Handler::strict : Handler::replace);
}

template <class Json>
Json parse(std::string_view text, const typename Json::parser_callback_t& watch,
           JsonReading reading) {
  return Json::parse(text.data(), text.data() + text.size(), watch, reading.throws,
                     reading.takes_comments);
}

}  // namespace

std::string json_text(const nlohmann::json& value, JsonLayout layout) {
  return text_of(value, layout);
}

std::string json_text(const nlohmann::ordered_json& value, JsonLayout layout) {
  return text_of(value, layout);
}

nlohmann::json parse_json_text(std::string_view text,
                               const nlohmann::json::parser_callback_t& watch,
                               JsonReading reading) {
  return parse<nlohmann::json>(text, watch, reading);
}

nlohmann::ordered_json parse_ordered_json_text(
    std::string_view text, const nlohmann::ordered_json::parser_callback_t& watch,
    JsonReading reading) {
  return parse<nlohmann::ordered_json>(text, watch, reading);
}

bool is_json(std::string_view text) {
  return nlohmann::json::accept(text.data(), text.data() + text.size());
}

bool visit_json(const std::function<int()>& next, JsonVisitor& visitor) {
  return nlohmann::json::sax_parse(Characters(next), Characters(), &visitor);
}

std::vector<std::uint8_t> cbor_of(const nlohmann::json& value) {
  return nlohmann::json::to_cbor(value);
}

nlohmann::json parse_cbor(std::span<const std::byte> bytes) {
  constexpr bool kStrict = true, kThrow = false;
  return nlohmann::json::from_cbor(bytes, kStrict, kThrow);
}

}  // namespace meshhier::storage
