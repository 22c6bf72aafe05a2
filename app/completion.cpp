#include "app/completion.h"

#include "app/parser_walk.h"
#include "config/config_schema.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <variant>

namespace meshhier::app {

namespace {

using Words = std::vector<std::string>;

/// The names in --help of arguments that are files.
constexpr std::array<std::string_view, 9> kFileNames{
    "CONFIG", "DIR", "FILE", "FOLDER", "HIERARCHY", "INBOX", "MESH", "PATH", "STREAM"};
constexpr std::string_view kConfigKey = "KEY=VALUE";

bool names_file(std::string_view name) {
  return std::find(kFileNames.begin(), kFileNames.end(), name) != kFileNames.end();
}

/// Returns all names of an option with their dashes; only the long one of -o,--output.
Words names_of(const CLI::Option& option) {
  Words names;
  for (const std::string& name : option.get_lnames())
    names.push_back("--" + name);
  if (names.empty()) {
    for (const std::string& name : option.get_snames())
      names.push_back("-" + name);
  }
  return names;
}

bool is_option_word(std::string_view word) {
  return word.starts_with('-') && word != "-";
}

/// Returns the option that `word` names: "--output", "-o" or "--output=x"; null if there is none.
const CLI::Option* find_option(const Arguments& arguments, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const auto found =
      std::find_if(arguments.options.begin(), arguments.options.end(),
                   [&](const CLI::Option* option) { return option->check_name(name); });
  return found == arguments.options.end() ? nullptr : *found;
}

/// Returns the option whose value the last word is; null if it is none's.
const CLI::Option* option_of_value(const Arguments& arguments, const Words& words) {
  const auto last = words.rbegin() + 1;
  const auto named = std::find_if(last, words.rend(), is_option_word);
  if (named == words.rend() || named->find('=') != std::string::npos)
    return nullptr;
  const CLI::Option* option = find_option(arguments, *named);
  const auto given = named - last;
  return option != nullptr && given < option->get_items_expected_max() ? option : nullptr;
}

class Collector {
 public:
  explicit Collector(std::string typed) : typed_(std::move(typed)) {}

  void add(const std::string& word, const std::string& meaning = {}) {
    if (word.starts_with(typed_))
      completion_.suggestions.push_back({word, meaning.substr(0, meaning.find('\n'))});
  }

  void add_commands(const CLI::App& parser) {
    for (const CLI::App* command : commands_of(parser))
      add(command->get_name(), command->get_description());
  }

  void add_options(const Arguments& arguments) {
    for (const CLI::Option* option : arguments.options) {
      for (const std::string& name : names_of(*option)) {
        add(name, option->get_description());
        if (!takes_value(*option))
          add_values(*option, name + '=');
      }
    }
  }

  /// `before`: the text that precedes the value in the same word.
  void add_values(const CLI::Option& option, const std::string& before = {}) {
    for (const std::string& choice : choices_of(option))
      add(before + choice);
    if (option.get_type_name() == kConfigKey)
      add_config_keys();
    if (names_file(option.get_type_name()) || names_file(option.get_name(true)))
      completion_.takes_files = true;
  }

  Completion take() { return std::move(completion_); }

 private:
  void add_config_keys() {
    const std::size_t equals = typed_.find('=');
    if (equals != std::string::npos)
      return add_config_values(typed_.substr(0, equals));
    for (const config::ConfigKey& key : config::config_keys())
      add(key.path + '=', key.meaning);
  }

  void add_config_values(const std::string& path) {
    const config::ConfigKey* key = config::find_config_key(path);
    if (key == nullptr)
      return;
    for (const std::string& choice : key->choices)
      add(path + '=' + choice);
    const bool is_flag =
        key->kind == config::KeyKind::boolean ||
        (key->view != nullptr && std::holds_alternative<bool ModelView::*>(key->view->field));
    if (is_flag) {
      add(path + "=true");
      add(path + "=false");
    }
    completion_.takes_files =
        key->kind == config::KeyKind::path || key->kind == config::KeyKind::paths;
  }

  std::string typed_;
  Completion completion_;
};

Completion complete_arguments(const CLI::App& command, const Words& words) {
  const Arguments arguments = arguments_of(command);
  const std::string& typed = words.back();
  Collector collector(typed);
  const std::size_t equals = typed.find('=');
  const CLI::Option* const named = find_option(arguments, typed);
  if (is_option_word(typed) && equals != std::string::npos && named != nullptr) {
    collector.add_values(*named, typed.substr(0, equals + 1));
  } else if (is_option_word(typed)) {
    collector.add_options(arguments);
  } else if (const CLI::Option* option = option_of_value(arguments, words)) {
    collector.add_values(*option);
  } else {
    for (const CLI::Option* positional : arguments.positionals)
      collector.add_values(*positional);
  }
  return collector.take();
}

}  // namespace

Completion complete(const CLI::App& parser, const Words& words) {
  if (words.empty())
    return {};
  for (const CLI::App* command : commands_of(parser)) {
    if (words.size() > 1 && command->get_name() == words.front())
      return complete_arguments(*command, {words.begin() + 1, words.end()});
  }
  Collector collector(words.back());
  if (words.size() == 1) {
    collector.add_commands(parser);
    collector.add_options(arguments_of(parser));
  }
  return collector.take();
}

}  // namespace meshhier::app
