#include "hierarchy/plain_text.h"

namespace meshhier {

std::string plain_text(std::string_view text, std::size_t most_bytes) {
  const bool cut = text.size() > most_bytes;
  const auto continues = [&](std::size_t i) {
    return (static_cast<unsigned char>(text[i]) & 0xc0U) == 0x80U;
  };
  std::size_t end = cut ? most_bytes : text.size();
  while (cut && end > 0 && continues(end))
    --end;
  std::string plain(text.substr(0, end));
  for (char& c : plain) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      c = '?';
  }
  return cut ? plain + "..." : plain;
}

std::string json_fault(std::string_view message) {
  if (message.starts_with('[') && message.find("] ") != std::string_view::npos)
    message.remove_prefix(message.find("] ") + 2);
  for (const std::string_view prefix : {"parse error at ", "parse error: "}) {
    if (message.starts_with(prefix))
      message.remove_prefix(prefix.size());
  }
  return std::string(message);
}

}  // namespace meshhier
