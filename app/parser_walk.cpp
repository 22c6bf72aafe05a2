#include "app/parser_walk.h"

#include "storage/io/web_address.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace meshhier::app {

namespace {

bool is_choice(std::string_view word) {
  return !word.empty() &&
         word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string_view::npos;
}

/// The names of types, which stand behind an option, that are files to be read.
constexpr std::array<std::string_view, 4> kReadTypes{"FILE", "DIR", "MESH", "LINE|@FILE"};
constexpr std::array<const char*, 4> kWrittenOptions{"output", "stats", "input-note", "work"};

/// Returns the file of "@FILE" if a value may be something else.
std::string_view file_in(std::string_view value, std::string_view type) {
  if (!type.ends_with("@FILE"))
    return value;
  return value.starts_with('@') ? value.substr(1) : std::string_view();
}

void add_arguments(const CLI::App& command, Arguments& arguments) {
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty())
      (option->nonpositional() ? arguments.options : arguments.positionals).push_back(option);
  }
  const auto is_group = [](const CLI::App* below) { return below->get_name().empty(); };
  for (const CLI::App* group : command.get_subcommands(is_group))
    add_arguments(*group, arguments);
}

}  // namespace

std::vector<const CLI::App*> commands_of(const CLI::App& parser) {
  return parser.get_subcommands([](const CLI::App* command) {
    return !command->get_name().empty() && !command->get_group().empty();
  });
}

Arguments arguments_of(const CLI::App& command) {
  Arguments arguments;
  add_arguments(command, arguments);
  return arguments;
}

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  std::vector<std::string> choices;
  for (std::size_t begin = 0; begin <= type.size();) {
    const std::size_t end = std::min(type.find_first_of("|,:{}", begin), type.size());
    if (std::string word = type.substr(begin, end - begin); is_choice(word))
      choices.push_back(std::move(word));
    begin = end + 1;
  }
  return choices;
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

FileUse file_use_of(const CLI::Option& option) {
  if (!takes_value(option))
    return FileUse::none;
  const auto is_called = [&](const char* name) { return option.check_lname(name); };
  if (std::ranges::any_of(kWrittenOptions, is_called))
    return FileUse::written;
  const bool is_read = !option.nonpositional() ||
                       std::ranges::find(kReadTypes, option.get_type_name()) != kReadTypes.end();
  return is_read ? FileUse::read : FileUse::none;
}

std::vector<std::filesystem::path> files_named(const CLI::App& command, FileUse use) {
  std::vector<std::filesystem::path> paths;
  const Arguments arguments = arguments_of(command);
  for (const auto& list : {arguments.positionals, arguments.options}) {
    for (const CLI::Option* option : list) {
      if (file_use_of(*option) != use)
        continue;
      for (const std::string& value : option->results()) {
        const std::string_view file = file_in(value, option->get_type_name());
        if (!file.empty() && !storage::is_web_address(file))
          paths.emplace_back(file);
      }
    }
  }
  return paths;
}

}  // namespace meshhier::app
