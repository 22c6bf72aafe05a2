#include "storage/format/metadata_ids.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace meshhier::storage {
namespace {

bool is_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

}  // namespace

std::string as_word(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return !is_alphanumeric(c); }, '_');
  return name;
}

void add_unique(std::vector<std::string>& names, const std::string& name) {
  std::string unique = name;
  for (int number = 2; std::ranges::find(names, unique) != names.end(); ++number)
    unique = name + '_' + std::to_string(number);
  names.push_back(std::move(unique));
}

std::vector<std::string> metadata_ids(std::span<const std::string> names) {
  std::vector<std::string> ids;
  for (const std::string& name : names) {
    std::string word = as_word(name);
    if (word == "__proto__")  // which JavaScript takes for something else
      word = "_proto_";
    if (word.empty() || (word[0] >= '0' && word[0] <= '9'))
      word.insert(word.begin(), '_');
    add_unique(ids, word);
  }
  return ids;
}

}  // namespace meshhier::storage
