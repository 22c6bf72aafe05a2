#include "app/command.h"
#include "app/options.h"
#include "app/serve_arguments.h"
#include "app/serving.h"
#include "base/error.h"
#include "base/named_value.h"
#include "base/number_text.h"
#include "server/health_question.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {

namespace {

void check_folder(const std::string& option, const std::string& folder, Environment& environment) {
  if (environment.files.is_directory(folder))
    return;
  if (environment.files.exists(folder)) {
    throw Error(ErrorCode::usage,
                fmt::format("{} {}: it is no directory; name the one it lies in", option, folder));
  }
  throw Error(
      ErrorCode::io,
      fmt::format("{} {}: there is no such directory; make it, or name another", option, folder));
}

/// Asks the server that was started with the same words; 0: its reply is what is hoped for.
int ask_health(const ServeArguments& arguments, Environment& environment) {
  const server::HealthAnswer answer =
      server::ask_health(arguments.server.host, arguments.server.port, *arguments.question);
  (answer.is_well ? environment.out : environment.messages) << answer.text << std::endl;
  return answer.is_well ? 0 : 1;
}

int run_serve(const ServeArguments& arguments, Environment& environment) {
  if (arguments.question)
    return ask_health(arguments, environment);
  check_folder("FOLDER", arguments.folder, environment);
  if (!arguments.inbox.empty())
    check_folder(arguments.takes_uploads ? "--inbox" : "--watch", arguments.inbox, environment);
  if (arguments.once)
    return build_inbox(arguments, environment);
  serve_folder(arguments, environment);
  return 0;
}

constexpr const char* kServeFooter =
    R"(Shows every hierarchy below FOLDER, directories and 3tz archives, in a page for browsers, and hands out their
files and those of progressive streams; nothing else, nothing through links, and it changes nothing.
New ones appear without a restart. Only this machine reaches it, unless --host is given: then everybody who
reaches that address may read the models. It prints its URL and runs until Ctrl-C or SIGTERM, which is
its normal end: exit code 0.

With --watch, a mesh file that is put into INBOX becomes FOLDER/NAME.hier as soon as it has stopped changing, and
is in the gallery with its progress until then. One at a time is built, by the config if one is given (its
"input" and "output" do not count), in a process of its own. A file that cannot be built is told in the gallery, and
tried again when it changes. Files in INBOX are never changed, moved or removed. A server that was stopped, or
killed, goes on where it was when it is started again.

With --inbox instead of --watch, meshes may also be sent: dropped onto the page, or by PUT. Several files that belong
together, as an OBJ with its MTL and pictures, are sent as one form; they become a folder in INBOX, and one model.
A folder in INBOX with one mesh in it is built, too. Only this machine may send; with --host and --upload-token-file
everybody who knows the token. Nothing in INBOX is replaced.

With --once, for cron, what is in INBOX is built, and this ends: exit code 0 if all became models, or were, else that
of the builds that failed (10 if theirs differ), 8 while another one is at work. There is no page, and no port is
opened. Files that still change are left for the next time.

  GET /                            the page
  GET /models.json                 what there is
  GET /healthz, /readyz            whether it is alive, and ready, with reasons
  GET /metrics                     figures for Prometheus; for this machine only, or by a token
  GET /models/NAME.hier/FILE       hierarchy.json, tiles.bin, outline.glb, preview.webp, tiles/LL/NNNNNN.glb, ...
  PUT /inbox/NAME.ply              with --inbox: a mesh
  POST /inbox/NAME                 with --inbox: a form of files, one of which is a mesh
  PUT /models/NAME.hier/view       with --inbox: how a hierarchy is shown first, JSON

Examples:
  meshhier serve models
  meshhier serve models --port 0 --open
  meshhier serve models --watch inbox --config scans.json
  meshhier serve models --watch inbox --once
  meshhier serve models --host 0.0.0.0 --cors '*'
  meshhier serve models --log json --verbose
  meshhier serve models --check ready
  meshhier serve models --inbox inbox &
  curl -T scan.ply http://localhost:8080/inbox/scan.ply
  curl -F f=@house.obj -F f=@house.mtl -F f=@wall.jpg http://localhost:8080/inbox/house
)";

std::string check_origin(const std::string& text) {
  const std::size_t scheme = text.find("://");
  const bool is_origin = scheme != std::string::npos && scheme > 0 &&
                         text.find('/', scheme + 3) == std::string::npos &&
                         text.size() > scheme + 3;
  const bool is_plain = text.find_first_of(" \t\r\n,;'\"") == std::string::npos;
  if (text == "*" || (is_origin && is_plain))
    return "";
  return "expected an origin (\"https://example.org\") or \"*\", found \"" + text + "\"";
}

void add_network_options(CLI::App& command, ServeArguments& arguments) {
  command
      .add_option("--host", arguments.server.host,
                  "The address of this machine to listen on; 0.0.0.0: all [127.0.0.1]")
      ->type_name("ADDRESS");
  add_integer_option(command, {"--port", "0: any that is free [8080]", 0, 65535},
                     [&arguments](std::uint64_t port) {
                       arguments.server.port = static_cast<std::uint16_t>(port);
                     });
  command.add_option("--cors", arguments.cors, "Whose pages may read the models, too")
      ->type_name("ORIGIN|*")
      ->check(check_origin);
  command.add_option("--frame", arguments.frame, "Whose pages may show ours in a frame, too")
      ->type_name("ORIGIN|*")
      ->check(check_origin);
}

/// Returns what takes the name of a row, for add_text_option().
template <class Table, class Value>
std::function<bool(const std::string&)> taker(const Table& table, Value& value) {
  return [&table, &value](const std::string& text) {
    const auto named = value_named(table, text);
    if (named)
      value = *named;
    return named.has_value();
  };
}

void add_service_options(CLI::App& command, ServeArguments& arguments) {
  add_text_option(
      command,
      {"--log", "How the lines of the log are written [text]", "json|text", "json or text"},
      taker(server::kLogFormats, arguments.log_format));
  add_size_option(
      command, "--disk-floor",
      "With --watch or --inbox: with less disk left it is not ready and takes no meshes",
      arguments.disk_floor);
  command
      .add_option("--metrics-token-file", arguments.metrics_token_file,
                  "Who reads /metrics must know the word in this file; else only this machine may")
      ->type_name("FILE");
  add_text_option(command,
                  {"--check", "Start nothing; ask the server that was started with the same words",
                   "alive|ready", "alive or ready"},
                  taker(server::kHealths, arguments.question));
}

void add_upload_options(CLI::App& command, CLI::Option& inbox, ServeArguments& arguments) {
  add_size_option(command, "--upload-limit", "With --inbox: larger uploads are refused",
                  arguments.upload_limit)
      ->needs(&inbox);
  command
      .add_option("--upload-token-file", arguments.token_file,
                  "With --inbox: who sends meshes must know the word in this file")
      ->type_name("FILE")
      ->needs(&inbox);
}

void add_watch_options(CLI::App& command, ServeArguments& arguments) {
  CLI::Option* watch =
      command.add_option("--watch", arguments.inbox, "Build what is put into this directory")
          ->type_name("INBOX");
  CLI::Option* inbox = command
                           .add_option_function<std::string>(
                               "--inbox",
                               [&arguments](const std::string& folder) {
                                 arguments.inbox = folder;
                                 arguments.takes_uploads = true;
                               },
                               "The same, and take meshes that are dropped onto the page")
                           ->type_name("INBOX")
                           ->excludes(watch);
  command.add_option("--config", arguments.config, "How to build; default: all defaults")
      ->type_name("CONFIG");
  add_text_option(command,
                  {"--settle", "A file in INBOX that has not changed for so long is whole [2]",
                   "SECONDS", "a number of seconds from 0 to 86400"},
                  [&arguments](const std::string& text) {
                    arguments.settle_seconds = parse_finite(text).value_or(-1);
                    return arguments.settle_seconds >= 0 && arguments.settle_seconds <= 86400;
                  });
  CLI::Option* once = command.add_flag("--once", arguments.once,
                                       "Build what is there and due, and end; no page, no port");
  for (const char* option : {"--host", "--port", "--cors", "--frame", "--open", "--viewer"})
    once->excludes(command.get_option(option));
  add_upload_options(command, *inbox, arguments);
}

/// Throws for options on the inbox if there is none.
void check_needs(const CLI::App& command) {
  if (command.count("--watch") + command.count("--inbox") > 0)
    return;
  for (const char* option : {"--config", "--settle", "--once", "--disk-floor"}) {
    if (command.count(option) > 0)
      throw CLI::RequiresError(option, "--watch or --inbox");
  }
}

}  // namespace

void add_serve_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command =
      parser.add_subcommand("serve", "Show the hierarchies of a folder in the browser");
  command->add_option("FOLDER", arguments->folder, "Where hierarchies lie, at any depth")
      ->required();
  add_network_options(*command, *arguments);
  command->add_flag("--open", arguments->open, "Open the page in the browser");
  command->add_option("--viewer", arguments->viewer, "Where the page lies, if not as installed")
      ->type_name("DIR");
  add_watch_options(*command, *arguments);
  add_service_options(*command, *arguments);
  CLI::Option* verbose =
      command->add_flag("--verbose", arguments->verbose, "Print a line for each request");
  command
      ->add_flag("--quiet", arguments->quiet,
                 "Print nothing but the URL, errors and what is missing")
      ->excludes(verbose);
  command->footer(kServeFooter);
  command->callback([arguments, command, &invocation] {
    check_needs(*command);
    invocation.run = [arguments](Environment& environment) {
      return run_serve(*arguments, environment);
    };
  });
}

}  // namespace meshhier::app
