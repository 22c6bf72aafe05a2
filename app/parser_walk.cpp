#include "app/parser_walk.h"

#include <algorithm>
#include <string_view>

namespace meshhier::app {

namespace {

bool is_choice(std::string_view word) {
  return !word.empty() &&
         word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string_view::npos;
}

void add_arguments(const CLI::App& command, Arguments& arguments) {
  for (const CLI::Option* option : command.get_options())
    (option->nonpositional() ? arguments.options : arguments.positionals).push_back(option);
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

}  // namespace meshhier::app
