// A config as it is written, and what the command line says of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace meshhier::config {

/// Throws Error(usage).
[[noreturn]] void refuse(const std::string& where, const std::string& what);
std::string in_quotes(std::string_view text);
/// A value for a message: "the string "abc"", "an object".
std::string described(const nlohmann::ordered_json& value);
/// The end of a message: "; did you mean "output"?", or nothing.
std::string did_you_mean(const std::optional<std::string>& word);

/// The dotted path of a key; `section` is empty at the top.
std::string with_key(const std::string& section, const std::string& key);
/// The last name of a dotted path.
std::string leaf_of(std::string_view path);

/// The document with its overrides, and where each value comes from.
class Draft {
 public:
  /// `name` begins messages. Throws Error(usage) if the text is no JSON object of reasonable size.
  Draft(std::string_view text, std::string name);

  const nlohmann::ordered_json& document() const { return document_; }

  /// Puts what "key=value" says. A key that wants text takes it as it stands: output=2024 is a
  /// directory, not a number.
  void apply(const std::string& setting);
  /// `source`: which words of the command line say so.
  void put(const std::string& path, nlohmann::ordered_json value, const std::string& source);
  bool has(const std::string& path) const;
  /// Makes objects of the values that stand in the place of a section (ConfigSection::short_for).
  void open_short_sections();
  /// Two keys exclude each other: one that was overridden replaces one that was not.
  void settle(const std::string& section, const std::string& one, const std::string& other);

  bool is_overridden(const std::string& path) const;
  /// For messages: "config.json: partition.vertices" or "--set partition.vertices".
  std::string origin_of(const std::string& path) const;
  std::string source_of(const std::string& path) const;
  [[noreturn]] static void refuse_unknown(const std::string& where, const std::string& path);

 private:
  using Overriding = std::map<std::string, std::string>::const_iterator;

  Overriding overriding(const std::string& path) const;
  nlohmann::ordered_json& open_section(const std::string& path);

  nlohmann::ordered_json document_;
  std::string name_;
  std::map<std::string, std::string> overridden_;  ///< by what
};

}  // namespace meshhier::config
