// Texts of any bytes in the journal's JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

inline nlohmann::json::binary_t to_binary(std::span<const std::byte> bytes) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  return nlohmann::json::binary_t({first, first + bytes.size()});
}
inline nlohmann::json::binary_t to_binary(const std::string& text) {
  return to_binary(std::as_bytes(std::span(text)));
}

/// Throws nlohmann::json::exception if it is none.
inline std::string text_of(const nlohmann::json& json) {
  const nlohmann::json::binary_t& bytes = json.get_binary();
  return {bytes.begin(), bytes.end()};
}

}  // namespace meshhier::pipeline
