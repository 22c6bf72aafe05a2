#include "app/command.h"
#include "app/parser_walk.h"

#include <memory>
#include <ostream>
#include <sstream>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

/// Returns a text that roff prints as it is.
std::string escaped(std::string_view text) {
  std::string result;
  bool is_line_start = true;
  for (const char c : text) {
    if (is_line_start && (c == '.' || c == '\''))
      result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    is_line_start = c == '\n';
  }
  return result;
}

void print_as_is(std::ostream& out, const std::string& text) {
  if (!text.empty())
    out << ".PP\n.nf\n" << escaped(text) << (text.ends_with('\n') ? "" : "\n") << ".fi\n";
}

void print_argument(std::ostream& out, const CLI::Option& option, const std::string& name) {
  out << ".TP\n\\fB" << escaped(name) << "\\fR";
  if (takes_value(option) && option.nonpositional())
    out << " \\fI" << escaped(option.get_type_name()) << "\\fR";
  out << '\n' << escaped(option.get_description()) << '\n';
}

/// Returns "--help-config" for "--help-config{text}": the help says what it means without a value.
std::string name_of(const CLI::Option& option) {
  const std::string name = option.get_name(false, true);
  return name.substr(0, name.find('{'));
}

void print_arguments(std::ostream& out, const CLI::App& command) {
  const Arguments arguments = arguments_of(command);
  for (const CLI::Option* positional : arguments.positionals)
    print_argument(out, *positional, positional->get_name(true));
  for (const CLI::Option* option : arguments.options)
    print_argument(out, *option, name_of(*option));
}

void print_command(std::ostream& out, const CLI::App& command) {
  out << ".SS \"meshhier " << escaped(command.get_name()) << "\"\n"
      << escaped(command.get_description()) << ".\n";
  print_arguments(out, command);
  print_as_is(out, command.get_footer());
}

/// Prints the manual page, in roff: all that --help tells, of all commands.
void print_manual(std::ostream& out, const CLI::App& parser) {
  out << ".TH MESHHIER 1 \"\" \"meshhier " MESHHIER_VERSION "\" \"User Commands\"\n"
      << ".SH NAME\nmeshhier \\- prepare huge triangle meshes for fast display\n"
      << ".SH SYNOPSIS\n\\fBmeshhier\\fR \\fICOMMAND\\fR [\\fIARGUMENTS\\fR]\n"
      << ".SH DESCRIPTION\n"
      << escaped(parser.get_description()) << '\n';
  print_as_is(out, parser.get_footer());
  out << ".SH OPTIONS\n";
  print_arguments(out, parser);
  out << ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(parser))
    print_command(out, *command);
}

/// Prints a table of the commands in Markdown, each with a link to a heading of its name.
void print_table(std::ostream& out, const CLI::App& parser) {
  out << "| command | in one line |\n|---|---|\n";
  for (const CLI::App* command : commands_of(parser)) {
    const std::string& name = command->get_name();
    out << "| [" << name << "](#" << name << ") | " << command->get_description() << " |\n";
  }
}

}  // namespace

void add_manual_command(CLI::App& parser, Invocation& invocation) {
  CLI::App* command = parser.add_subcommand("manual", "Print the manual page, for man");
  command->footer("Example:\n  meshhier manual | man -l -\n");
  const auto is_table = std::make_shared<bool>(false);
  command->add_flag(
      "--commands", *is_table,
      "Print a table of the commands instead, in Markdown, as docs/command_line.md has it");
  command->callback([&parser, &invocation, is_table] {
    invocation.run = [&parser, is_table](Environment& environment) {
      (*is_table ? print_table : print_manual)(environment.out, parser);
      return 0;
    };
  });
}

}  // namespace meshhier::app
