// Texts and bytes of JSON values. nlohmann's parser and writer are called here alone, and compiled
// here alone: each file that calls them by itself takes the compiler two seconds more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

struct JsonLayout {
  int indent = -1;          ///< spaces a level; -1: all in one line
  bool only_ascii = false;  ///< other letters as \uXXXX
  bool throws = false;      ///< nlohmann::json::type_error where it is no UTF-8; else U+FFFD
};

/// Returns the text of a value, without a line's end.
std::string json_text(const nlohmann::json& value, JsonLayout layout = {});
std::string json_text(const nlohmann::ordered_json& value, JsonLayout layout = {});

struct JsonReading {
  bool throws = true;  ///< nlohmann::json::parse_error; else a mistake gives a discarded value
  bool takes_comments = false;  ///< as in C++
};

/// Parses a text. `watch` sees each value and may drop it by returning false, or throw.
nlohmann::json parse_json_text(std::string_view text,
                               const nlohmann::json::parser_callback_t& watch,
                               JsonReading reading = {});
nlohmann::ordered_json parse_ordered_json_text(
    std::string_view text, const nlohmann::ordered_json::parser_callback_t& watch = nullptr,
    JsonReading reading = {});

/// Whether a text is one JSON value; keeps none of it in memory.
bool is_json(std::string_view text);

/// Passes over all that a parser tells; a subclass overrides what it wants to see. A mistake ends
/// the parse, and so do values nested more than 1000 deep.
class JsonVisitor : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) final { return ++depth_ <= kMostDepth; }
  bool start_array(std::size_t) final { return ++depth_ <= kMostDepth; }
  bool end_object() final { return leave(); }
  bool end_array() final { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override {
    return false;
  }

 protected:
  std::size_t depth() const { return depth_; }  ///< number of open objects and arrays

 private:
  static constexpr std::size_t kMostDepth = 1000;

  bool leave() {
    --depth_;
    return true;
  }

  std::size_t depth_ = 0;
};

/// Parses a text of any length without keeping it: `next` gives its characters, below 0 at its end.
/// Returns false if `visitor` ended it, or was told of a mistake.
bool visit_json(const std::function<int()>& next, JsonVisitor& visitor);

/// Returns a value as CBOR (RFC 8949).
std::vector<std::uint8_t> cbor_of(const nlohmann::json& value);

/// Parses CBOR; returns a discarded value if it is none, or if more follows. Never throws.
nlohmann::json parse_cbor(std::span<const std::byte> bytes);

}  // namespace meshhier::storage
