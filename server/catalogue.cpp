#include "server/catalogue.h"

#include "base/named_value.h"
#include "base/number_text.h"
#include "base/percent_code.h"
#include "base/utf8.h"
#include "server/url_path.h"
#include "storage/format/folded_words.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <span>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

constexpr std::array kModelOrders{
    NamedValue{"folder", ModelOrder::folder}, NamedValue{"name", ModelOrder::name},
    NamedValue{"newest", ModelOrder::newest}, NamedValue{"size", ModelOrder::size},
    NamedValue{"triangles", ModelOrder::triangles}};
constexpr std::size_t kMostCount = 1000;  // models of one reply
constexpr std::size_t kMostSearchBytes = 1000;

const storage::LetterTable& letters() {
  static const storage::LetterTable table(storage::kLetterTable, "letters");
  return table;
}

std::vector<std::string> folded(std::string_view text) {
  return letters().words_of(sound_utf8(text));
}

std::string joined_words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += word + ' ';
  return text;
}

std::size_t digits_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && text[end] >= '0' && text[end] <= '9')
    ++end;
  return end - at;
}

/// Compares texts as people sort them: "scan 9" before "scan 10".
bool comes_before(std::string_view a, std::string_view b) {
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    std::size_t m = digits_at(a, i), n = digits_at(b, k);
    if (m == 0 || n == 0) {
      if (a[i] != b[k])
        return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[k]);
      ++i, ++k;
      continue;
    }
    for (; m > 1 && a[i] == '0'; --m)
      ++i;
    for (; n > 1 && b[k] == '0'; --n)
      ++k;
    const int order = a.substr(i, m).compare(b.substr(k, n));
    if (m != n || order != 0)
      return m != n ? m < n : order < 0;
    i += m, k += n;
  }
  return a.size() - i < b.size() - k;
}

/// Returns the place of each model when the keys are sorted; equal ones stay as they are.
std::vector<std::uint32_t> ranks_of(const std::vector<std::string>& keys) {
  std::vector<std::uint32_t> order(keys.size()), ranks(keys.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, [&](auto a, auto b) { return comes_before(keys[a], keys[b]); });
  for (std::uint32_t i = 0; i < order.size(); ++i)
    ranks[order[i]] = i;
  return ranks;
}

/// Returns all that a listing tells of a model and may change.
std::string identity_of(const Model& m) {
  std::string text = fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n", m.path, m.build, m.bytes,
                                 m.modified, m.has_story, m.title, m.folder);
  for (const auto* list : {&m.tags, &m.warnings})
    for (const std::string& each : *list)
      text += each + '\n';
  return m.place ? text + fmt::format("{} {}\n", m.place->longitude, m.place->latitude) : text;
}

/// Returns the path of the model that a listing calls `listed`, "models/a%20b.hier"; one that no
/// model has if it calls none so.
std::string path_of(const std::string& listed) {
  constexpr std::string_view kModels = "models/", kNoPath = "/";
  if (listed.empty())
    return listed;
  const bool has_slash = listed.ends_with('/');
  const auto path = decode_path('/' + listed.substr(0, listed.size() - (has_slash ? 1 : 0)));
  return std::string(path && path->starts_with(kModels)
                         ? std::string_view(*path).substr(kModels.size())
                         : kNoPath);
}

std::optional<std::size_t> read_count(std::optional<std::string_view> text) {
  return text ? parse_number<std::size_t>(*text) : std::nullopt;
}

}  // namespace

std::string_view folder_of(const Model& model) {
  if (!model.folder.empty())
    return model.folder;
  const std::size_t slash = model.path.rfind('/');
  return std::string_view(model.path).substr(0, slash == std::string::npos ? 0 : slash);
}

const std::string& shown_name(const Model& model) {
  return model.title.empty() ? model.name : model.title;
}

std::optional<ListingWish> read_wish(std::string_view target) {
  const auto text = [&](std::string_view key) {
    const auto value = query_value(target, key);
    std::string plus(value.value_or("").substr(0, kMostSearchBytes));
    std::ranges::replace(plus, '+', ' ');
    return percent_decoded(plus).value_or("");
  };
  const auto count = read_count(query_value(target, "count"));
  ListingWish wish{.search = text("search"),
                   .tag = text("tag"),
                   .path = path_of(text("path")),
                   .order = value_named(kModelOrders, text("order")).value_or(ModelOrder::folder),
                   .first = read_count(query_value(target, "first")).value_or(0),
                   .count = std::min(count.value_or(0), kMostCount),
                   .wants_places = text("places") == "1",
                   .state = text("state")};
  return count || wish.wants_places ? std::optional(std::move(wish)) : std::nullopt;
}

Catalogue::Catalogue(std::vector<Model> models) : models_(std::move(models)) {
  std::vector<std::string> names, folders;
  std::uint64_t sum = 0;
  for (const Model& model : models_) {
    const std::string name = joined_words(folded(shown_name(model)));
    const std::string folder = joined_words(folded(folder_of(model)));
    std::string words = name + folder + joined_words(folded(model.name));
    for (const std::string& tag : model.tags)
      words += joined_words(folded(tag));
    words_.push_back(std::move(words));
    folders.push_back(folder + '\1' + std::string(folder_of(model)) + '\1' + name);
    names.push_back(name);
    const std::string identity = identity_of(model);
    sum = storage::checksum(std::as_bytes(std::span(identity)), sum);
  }
  const std::vector<std::uint32_t> by_name = ranks_of(names), by_folder = ranks_of(folders);
  for (std::size_t i = 0; i < models_.size(); ++i)
    ranks_.push_back({by_name[i], by_folder[i]});
  state_ = fmt::format("{:016x}", sum);
}

std::vector<std::uint32_t> Catalogue::find(const ListingWish& wish) const {
  const std::vector<std::string> asked = folded(wish.search);
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < models_.size(); ++i) {
    const Model& model = models_[i];
    const bool fits =
        std::ranges::all_of(
            asked, [&](const auto& word) { return words_[i].find(word) != std::string::npos; }) &&
        (wish.path.empty() || model.path == wish.path) &&
        (wish.tag.empty() || std::ranges::find(model.tags, wish.tag) != model.tags.end());
    if (fits)
      found.push_back(i);
  }
  const auto key = [&](std::uint32_t i) -> std::pair<std::uint64_t, std::uint32_t> {
    const Model& model = models_[i];
    switch (wish.order) {
      case ModelOrder::folder:
        return {0, ranks_[i].by_folder};
      case ModelOrder::name:
        return {0, ranks_[i].by_name};
      case ModelOrder::newest:
        return {~static_cast<std::uint64_t>(std::max<std::int64_t>(model.modified, 0)),
                ranks_[i].by_name};
      case ModelOrder::size:
        return {~model.bytes, ranks_[i].by_name};
      case ModelOrder::triangles:
        return {~model.triangles, ranks_[i].by_name};
    }
    return {};
  };
  std::ranges::sort(found, std::less(), key);
  return found;
}

std::vector<std::pair<std::string, std::size_t>> Catalogue::tags(
    const std::vector<std::uint32_t>& found, std::size_t most) const {
  std::map<std::string, std::size_t> counts;
  for (const std::uint32_t i : found)
    for (const std::string& tag : models_[i].tags)
      ++counts[tag];
  std::vector<std::pair<std::string, std::size_t>> tags(counts.begin(), counts.end());
  std::ranges::stable_sort(tags, std::greater(), [](const auto& tag) { return tag.second; });
  tags.resize(std::min(tags.size(), most));
  return tags;
}

}  // namespace meshhier::server
