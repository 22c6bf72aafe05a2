#include "mesh_io/gltf_uri.h"

#include "base/percent_code.h"
#include "mesh_io/named_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kPieceBytes = 48 * 1024;

/// The value of a digit; 64 if it is none.
unsigned base64_digit(char c) {
  if (c >= 'A' && c <= 'Z')
    return static_cast<unsigned>(c - 'A');
  if (c >= 'a' && c <= 'z')
    return static_cast<unsigned>(c - 'a') + 26;
  if (c >= '0' && c <= '9')
    return static_cast<unsigned>(c - '0') + 52;
  return c == '+' ? 62 : c == '/' ? 63 : 64;
}

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && uri.substr(0, colon).find('/') == colon;
}

}  // namespace

std::optional<std::string_view> base64_of(std::string_view uri) {
  constexpr std::string_view kScheme = "data:";
  constexpr std::string_view kEncoding = ";base64";
  const std::size_t comma = uri.find(',');
  if (!uri.starts_with(kScheme) || comma == std::string_view::npos ||
      !uri.substr(0, comma).ends_with(kEncoding))
    return std::nullopt;
  return uri.substr(comma + 1);
}

bool decode_base64(std::string_view text,
                   const std::function<void(std::span<const std::byte>)>& visit) {
  for (int i = 0; i < 2 && text.ends_with('='); ++i)
    text.remove_suffix(1);
  if (text.size() % 4 == 1)
    return false;
  std::vector<std::byte> piece;
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned digit = base64_digit(text[i]);
    if (digit > 63)
      return false;
    bits = bits << 6 | digit;
    if (i % 4 > 0)
      piece.push_back(static_cast<std::byte>(bits >> (6 - 2 * (i % 4))));
    if (piece.size() >= kPieceBytes) {
      visit(piece);
      piece.clear();
    }
  }
  visit(piece);
  return true;
}

std::vector<std::string> names_of_uri(std::string_view uri) {
  std::vector<std::string> names;
  if (auto decoded = percent_decoded(uri))
    names.push_back(*std::move(decoded));
  if (names.empty() || names[0] != uri)
    names.emplace_back(uri);
  return names;
}

std::optional<std::filesystem::path> file_of_uri(std::string_view uri,
                                                 const std::filesystem::path& folder) {
  if (has_scheme(uri))
    return std::nullopt;
  const auto text = percent_decoded(uri);
  if (!text)
    return std::nullopt;
  const std::filesystem::path path(*text);
  const std::filesystem::path file = folder / path;
  if (path.is_absolute() || path.filename().empty() || !is_possible(file) ||
      std::ranges::find(path, std::filesystem::path("..")) != path.end())
    return std::nullopt;
  return file;
}

}  // namespace meshhier::mesh_io
