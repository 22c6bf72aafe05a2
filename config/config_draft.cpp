#include "config/config_draft.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "config/config_schema.h"
#include "config/suggest.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::config {
namespace {

using Json = nlohmann::ordered_json;

/// Sections are two levels deep; a little more lets the message be about the key instead.
constexpr std::size_t kDeepestNesting = 8;
/// There are a few dozen keys; looking for one goes through those before it, and a MiB of them
/// would take a minute.
constexpr std::size_t kMostKeys = 256;
/// A found key or value is quoted up to so many bytes.
constexpr std::size_t kLongestQuote = 60;
/// The parser's messages begin with the place and the cause; what they quote may be the whole file.
constexpr std::size_t kLongestParserMessage = 200;

std::string joined(const std::vector<std::string>& names) {
  return plain_text(fmt::format("{}", fmt::join(names, ".")), kLongestQuote);
}

/// The known key nearest to an unknown one: by its whole path, or else by its last name, which
/// finds keys that were written in the wrong section.
std::optional<std::string> nearest_key(const std::string& path) {
  std::vector<std::string> paths;
  std::vector<std::string> leaves;
  for (const ConfigKey& key : config_keys()) {
    paths.push_back(key.path);
    leaves.push_back(leaf_of(key.path));
  }
  if (std::optional<std::string> near = nearest_word(path, paths))
    return near;
  const std::optional<std::string> leaf = nearest_word(leaf_of(path), leaves);
  if (!leaf)
    return std::nullopt;
  return paths[static_cast<std::size_t>(std::find(leaves.begin(), leaves.end(), *leaf) -
                                        leaves.begin())];
}

/// Watches the parser: a key that is there twice, bottomless nesting and endless keys are mistakes
/// that JSON itself allows.
class ParseGuard {
 public:
  explicit ParseGuard(std::string name) : name_(std::move(name)) {}

  bool operator()(Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start)
      enter();
    if (event == Json::parse_event_t::object_end || event == Json::parse_event_t::array_end)
      leave();
    if (event == Json::parse_event_t::key)
      add(parsed.get<std::string>());
    return true;
  }

 private:
  void enter() {
    keys_.emplace_back();
    path_.emplace_back();
    if (keys_.size() > kDeepestNesting)
      refuse(name_, "expected a config, found values nested too deeply");
  }
  void leave() {
    keys_.pop_back();
    path_.pop_back();
  }
  void add(const std::string& key) {
    if (++count_ > kMostKeys)
      refuse(name_, fmt::format("expected a config, found more than {} keys", kMostKeys));
    path_.back() = key;
    if (!keys_.back().insert(key).second)
      refuse(name_, joined(path_) + ": this key is there twice; remove one");
  }

  std::string name_;
  std::size_t count_ = 0;                    ///< of all keys so far
  std::vector<std::set<std::string>> keys_;  ///< of each open object
  std::vector<std::string> path_;            ///< the current key of each
};

Json::parser_callback_t watched_by(ParseGuard& guard) {
  return [&guard](int, Json::parse_event_t event, Json& parsed) { return guard(event, parsed); };
}

Json parse_text(std::string_view text, const std::string& name) {
  Json document;
  ParseGuard guard(name);
  try {
    document = storage::parse_ordered_json_text(text, watched_by(guard), {.takes_comments = true});
  } catch (const nlohmann::json::exception& failure) {
    refuse(name, plain_text(json_fault(failure.what()), kLongestParserMessage) +
                     " (expected JSON; // comments are allowed, trailing commas are not)");
  }
  if (!document.is_object())
    refuse(name, "expected an object with the keys of a config, found " + described(document));
  return document;
}

struct Override {
  std::string path;
  std::string text;
};

Override split_override(const std::string& setting) {
  const std::size_t sign = setting.find('=');
  if (sign == std::string::npos || sign == 0) {
    refuse("--set",
           "expected key=value (\"partition.vertices=4096\"), found " + in_quotes(setting));
  }
  return {setting.substr(0, sign), setting.substr(sign + 1)};
}

Json override_value(const Override& setting) {
  const ConfigKey* key = find_config_key(setting.path);
  const bool wants_text =
      key != nullptr &&
      (key->kind == KeyKind::path || key->kind == KeyKind::paths || key->kind == KeyKind::text ||
       key->kind == KeyKind::choice || key->kind == KeyKind::names ||
       (key->view != nullptr &&
        std::holds_alternative<std::string ModelView::*>(key->view->field)));
  ParseGuard guard("--set " + plain_text(setting.path, kLongestQuote));
  Json value = storage::parse_ordered_json_text(setting.text, watched_by(guard), {.throws = false});
  const bool is_list = value.is_array() && key != nullptr &&
                       (key->kind == KeyKind::paths || key->kind == KeyKind::names);
  if (value.is_discarded() || (wants_text && !value.is_string() && !is_list))
    value = setting.text;
  return value;
}

}  // namespace

void refuse(const std::string& where, const std::string& what) {
  throw Error(ErrorCode::usage, where + ": " + what);
}

std::string with_key(const std::string& section, const std::string& key) {
  return section.empty() ? key : section + '.' + key;
}

std::string leaf_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return std::string(dot == std::string_view::npos ? path : path.substr(dot + 1));
}

std::string in_quotes(std::string_view text) {
  return '"' + plain_text(text, kLongestQuote) + '"';
}

std::string described(const Json& value) {
  if (value.is_null())
    return "null";
  if (value.is_object())
    return "an object";
  if (value.is_array())
    return "a list";
  const std::string text = plain_text(storage::json_text(value), kLongestQuote);
  if (value.is_string())
    return "the string " + text;
  return value.is_number() ? "the number " + text : text;
}

std::string did_you_mean(const std::optional<std::string>& word) {
  return word ? fmt::format("; did you mean \"{}\"?", *word) : std::string();
}

Draft::Draft(std::string_view text, std::string name)
    : document_(parse_text(text, name)), name_(std::move(name)) {
  open_short_sections();
}

void Draft::apply(const std::string& setting) {
  const Override parts = split_override(setting);
  put(parts.path, override_value(parts), "--set");
}

void Draft::put(const std::string& path, Json value, const std::string& source) {
  const auto [before, is_new] = overridden_.emplace(path, source);
  if (before->second != source) {
    refuse(source, fmt::format("\"{}\" is given by {} as well; remove one", path, before->second));
  }
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) {
    const ConfigSection* section = find_config_section(path);
    if (section != nullptr && !section->short_for.empty() && value.is_string())
      open_section(path)[section->short_for] = std::move(value);
    else
      document_[path] = std::move(value);
    return;
  }
  const std::string section = path.substr(0, dot);
  if (!is_config_section(section))
    refuse_unknown(source, path);
  open_section(section)[leaf_of(path)] = std::move(value);
}

bool Draft::has(const std::string& path) const {
  const Json::json_pointer place = json_pointer_to(path);
  return document_.contains(place);
}

void Draft::open_short_sections() {
  for (const ConfigSection& section : config_sections()) {
    if (section.short_for.empty() || !document_.contains(section.path) ||
        !document_[section.path].is_string())
      continue;
    Json value = std::move(document_[section.path]);
    document_[section.path] = Json::object({{section.short_for, std::move(value)}});
  }
}

void Draft::settle(const std::string& section, const std::string& one, const std::string& other) {
  if (!document_.contains(section) || !document_[section].is_object())
    return;
  Json& inner = document_[section];
  if (!inner.contains(one) || !inner.contains(other))
    return;
  const bool one_is_newer = overridden_.contains(with_key(section, one));
  if (one_is_newer == overridden_.contains(with_key(section, other))) {
    refuse(origin_of(section),
           fmt::format("expected either \"{}\" or \"{}\", found both; remove one", one, other));
  }
  inner.erase(one_is_newer ? other : one);
}

bool Draft::is_overridden(const std::string& path) const {
  return overriding(path) != overridden_.end();
}

std::string Draft::origin_of(const std::string& path) const {
  return is_overridden(path) ? source_of(path) + ' ' + path : name_ + ": " + path;
}

void Draft::refuse_unknown(const std::string& where, const std::string& path) {
  refuse(where, "unknown key " + in_quotes(path) + did_you_mean(nearest_key(path)));
}

std::string Draft::source_of(const std::string& path) const {
  const auto found = overriding(path);
  return found == overridden_.end() ? name_ : found->second;
}

/// Finds the command line's word on the key or on a section around it.
Draft::Overriding Draft::overriding(const std::string& path) const {
  for (std::size_t end = path.find('.'); end != std::string::npos; end = path.find('.', end + 1)) {
    const auto found = overridden_.find(path.substr(0, end));
    if (found != overridden_.end())
      return found;
  }
  return overridden_.find(path);
}

/// The object of that dotted path, made if it is not there.
nlohmann::ordered_json& Draft::open_section(const std::string& path) {
  Json* object = &document_;
  for (std::size_t end = 0; end != std::string::npos;) {
    const std::size_t begin = end == 0 ? 0 : end + 1;
    end = path.find('.', begin);
    object = &(*object)[path.substr(begin, end - begin)];
    if (object->is_null())
      *object = Json::object();
    if (!object->is_object())
      refuse(origin_of(path.substr(0, end)), "expected an object, found " + described(*object));
  }
  return *object;
}

}  // namespace meshhier::config
