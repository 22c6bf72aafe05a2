#include "base/plain_text.h"

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

namespace {

std::string singular_word(std::string_view word) {
  struct Ending {
    std::string_view plural, singular;
  };
  constexpr Ending kEndings[] = {{"ices", "ex"}, {"ies", "y"}, {"s", ""}};
  for (const Ending& ending : kEndings) {
    if (word.ends_with(ending.plural)) {
      return std::string(word.substr(0, word.size() - ending.plural.size()))
          .append(ending.singular);
    }
  }
  return std::string(word);
}

}  // namespace

std::string singular(std::string_view words) {
  const std::size_t space = words.find(' ');
  if (space == std::string_view::npos)
    return singular_word(words);
  return singular_word(words.substr(0, space)) + ' ' + singular(words.substr(space + 1));
}

std::string counted(std::uint64_t count, std::string_view plural) {
  return std::to_string(count) + ' ' + (count == 1 ? singular(plural) : std::string(plural));
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

std::string counted_vertices(std::uint64_t vertices, std::uint64_t places) {
  const std::string text = counted(vertices, "vertices");
  return places == vertices ? text : text + " at " + counted(places, "places");
}

}  // namespace meshhier
