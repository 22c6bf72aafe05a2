#include "app/command.h"
#include "app/options.h"
#include "app/token_file.h"
#include "app/viewer_place.h"
#include "base/error.h"
#include "base/named_value.h"
#include "base/plain_text.h"
#include "config/config.h"
#include "server/health_question.h"
#include "server/http_server.h"
#include "server/log_text.h"
#include "server/site.h"
#include "server/uploads.h"
#include "server/vitals.h"
#include "server/watch.h"
#include "storage/io/child_process.h"
#include "storage/io/output_file.h"
#include "storage/io/own_program.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {

namespace {

struct ServeArguments {
  std::string folder;
  server::ServerOptions server;
  bool open = false;
  std::string viewer;
  std::string cors;
  std::string frame;
  std::string inbox;
  bool takes_uploads = false;
  std::uint64_t upload_limit = server::UploadOptions().limit_bytes;
  std::string token_file;
  std::string metrics_token_file;
  std::uint64_t disk_floor = server::ReadinessOptions{}.disk_floor;
  server::LogFormat log_format = server::LogFormat::text;
  std::optional<server::Health> question;  ///< asked of a server that runs
  std::string config;
  double settle_seconds = 2;
  bool once = false;
  bool verbose = false;
  bool quiet = false;
};

/// Prints lines on standard error, whole ones from any thread.
class Console {
 public:
  Console(std::ostream& out, bool quiet, server::LogFormat format)
      : out_(out), quiet_(quiet), format_(format) {}

  void tell(server::LogLevel level, const std::string& message) {
    if (!quiet_)
      print(level, message);
  }
  void print(server::LogLevel level, const std::string& message) {
    print_line(server::log_line(format_, std::chrono::system_clock::now(), level, message));
  }
  void print(const server::Served& served) {
    print_line(server::log_line(format_, std::chrono::system_clock::now(), served));
  }

 private:
  void print_line(const std::string& line) {
    const std::lock_guard lock(mutex_);
    out_ << line << std::endl;
  }

  std::ostream& out_;
  bool quiet_;
  server::LogFormat format_;
  std::mutex mutex_;
};

/// The inbox is looked at no more often, however soon files count as whole.
constexpr std::chrono::milliseconds kShortestLook{50};

/// Names of folders are cut there, and cleaned, before a terminal shows them.
constexpr std::size_t kLongestFolderName = 200;

void check_folder(const std::string& option, const std::string& folder, Environment& environment) {
  if (environment.files.is_directory(folder))
    return;
  if (environment.files.exists(folder)) {
    throw Error(ErrorCode::usage,
                fmt::format("{} {}: it is no directory; name the one it lies in", option, folder));
  }
  throw Error(ErrorCode::io, fmt::format("{} {}: there is no such directory", option, folder));
}

/// Checks the config of all builds to come, so that a mistake is told now, not with the first
/// build. Returns the ending that hierarchies get.
std::string suffix_of(const std::string& config, Environment& environment) {
  const std::vector<std::string> settings{"input=mesh.ply", "output=mesh.hier"};
  const config::Config checked = config.empty()
                                     ? config::parse_config("{}", {"--set", {}}, settings)
                                     : config::load_config(environment.files, config, settings);
  return checked.storage.container == config::Container::archive ? ".3tz" : ".hier";
}

server::WatchOptions watch_options(const ServeArguments& arguments, Environment& environment) {
  storage::FileSystem& files = environment.files;
  server::WatchOptions options;
  options.inbox = files.canonical(arguments.inbox);
  options.folder = files.canonical(arguments.folder);
  options.config =
      arguments.config.empty() ? std::filesystem::path() : files.canonical(arguments.config);
  options.suffix = suffix_of(arguments.config, environment);
  options.program = storage::own_program();
  if (arguments.takes_uploads)
    options.folders = server::Inbox::Folders::taken;
  options.settle = std::chrono::milliseconds(std::llround(arguments.settle_seconds * 1000));
  options.look_every = std::min(options.look_every, std::max(options.settle, kShortestLook));
  return options;
}

server::UploadOptions upload_options(const ServeArguments& arguments, Environment& environment) {
  server::UploadOptions options;
  options.inbox = environment.files.canonical(arguments.inbox);
  options.limit_bytes = arguments.upload_limit;
  options.suffix = suffix_of(arguments.config, environment);
  options.is_loopback = server::is_loopback_host(arguments.server.host);
  if (!arguments.token_file.empty())
    options.token = read_token(environment.files, "--upload-token-file", arguments.token_file);
  return options;
}

server::VitalsOptions vitals_options(const ServeArguments& arguments, Environment& environment) {
  storage::FileSystem& files = environment.files;
  server::VitalsOptions options;
  options.readiness = {
      .folder = files.canonical(arguments.folder),
      .inbox = arguments.inbox.empty() ? std::filesystem::path() : files.canonical(arguments.inbox),
      .takes_uploads = arguments.takes_uploads,
      .disk_floor = arguments.disk_floor};
  if (!arguments.metrics_token_file.empty())
    options.token = read_token(files, "--metrics-token-file", arguments.metrics_token_file);
  return options;
}

/// Opens the browser; the process is held until this one ends. It may be the browser itself, which
/// logs without end.
std::unique_ptr<storage::ChildProcess> open_browser(const std::string& url, Console& console,
                                                    storage::FileSystem& files) {
  const char* const path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::filesystem::path program = std::filesystem::path(rest.substr(0, end)) / "xdg-open";
    if (files.exists(program))
      return std::make_unique<storage::ChildProcess>(
          std::vector<std::string>{program.string(), url}, storage::ChildProcess::Errors::dropped);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  console.print(server::LogLevel::warning,
                "--open: there is no xdg-open here (package xdg-utils); open the URL by hand");
  return nullptr;
}

void wait_for_end(const execution::CancelToken& cancel, const server::HttpServer& http) {
  constexpr std::chrono::milliseconds kLook{50};
  while (!cancel.cancelled() && !http.is_lost())
    std::this_thread::sleep_for(kLook);
}

/// Returns the name of a folder for the page: whole paths stay on this machine, others get the last
/// part.
std::string place_name(const std::string& folder, bool stays_here, storage::FileSystem& files) {
  if (folder.empty())
    return {};
  const std::filesystem::path path = files.canonical(folder);
  return (stays_here ? path : path.filename()).string();
}

server::PlaceNames place_names(const ServeArguments& arguments, storage::FileSystem& files) {
  const bool stays_here = server::is_loopback_host(arguments.server.host) && arguments.cors.empty();
  return {place_name(arguments.folder, stays_here, files),
          place_name(arguments.inbox, stays_here, files)};
}

std::string empty_text(const ServeArguments& arguments) {
  const std::string folder = plain_text(arguments.folder, kLongestFolderName);
  if (arguments.inbox.empty()) {
    return fmt::format(
        "there are no hierarchies in {} yet; those that \"meshhier build\" puts "
        "there are shown at once",
        folder);
  }
  return fmt::format(
      "there are no hierarchies in {} yet; mesh files that are put into {} become some", folder,
      plain_text(arguments.inbox, kLongestFolderName));
}

/// Probes of a service manager come every few seconds: those that went well are not told.
bool is_told(const server::Served& served) {
  const std::string path = served.target.substr(0, served.target.find('?'));
  return served.status >= 400 || path.empty() ||
         !server::Vitals::is_vital(std::string_view(path).substr(1));
}

constexpr const char* kNoUploads =
    "no meshes are taken over the network: --host lets other machines in, and there is no "
    "--upload-token-file; files that are put into the inbox are built as ever";

/// All that runs. Members that others use come before them, so that they end after them.
class Service {
 public:
  Service(const ServeArguments& arguments, Environment& environment)
      : environment_(environment),
        console_(environment.messages, arguments.quiet, arguments.log_format),
        tell_([this](server::LogLevel level, const std::string& message) {
          console_.tell(level, message);
        }),
        warn_([this](const std::string& message) { tell_(server::LogLevel::warning, message); }),
        complain_([this](const std::string& message) { tell_(server::LogLevel::error, message); }),
        vitals_(
            vitals_options(arguments, environment), environment.files, [this] { return figures(); },
            tell_),
        hierarchies_(storage::open_folder(arguments.folder), warn_) {
    ViewerPlace viewer = find_viewer(environment.files, arguments.viewer);
    if (!viewer.folder)
      console_.print(server::LogLevel::warning, viewer.missing + ' ' + kServedWithoutPage);
    if (!arguments.inbox.empty()) {
      server::WatchOptions options = watch_options(arguments, environment);
      options.on_new = [this] { site_->refresh(); };
      watch_.emplace(std::move(options), environment.files, hierarchies_, tell_);
    }
    if (arguments.takes_uploads) {
      uploads_.emplace(upload_options(arguments, environment), environment.files, complain_);
      if (!uploads_->offer())
        tell_(server::LogLevel::warning, kNoUploads);
      views_.emplace(environment.files.canonical(arguments.folder), *uploads_, hierarchies_,
                     environment.files, complain_);
    }
    site_.emplace(
        server::SiteOptions{std::move(viewer.folder), page_without_viewer(),
                            server::is_loopback_host(arguments.server.host), arguments.cors,
                            arguments.frame, place_names(arguments, environment.files),
                            uploads_ ? &*uploads_ : nullptr, views_ ? &*views_ : nullptr, &vitals_},
        hierarchies_, watch_ ? [this] { return watch_->jobs(); } : server::Site::Jobs(), complain_);
    http_.emplace(
        arguments.server, [this](const server::Request& request) { return site_->answer(request); },
        [this, is_verbose = arguments.verbose](const server::Served& served) {
          vitals_.count(served);
          if (is_verbose && is_told(served))
            console_.print(served);
        });
  }

  void run(const ServeArguments& arguments) {
    http_->start();
    const std::string url = server::url_of(arguments.server.host, http_->port());
    environment_.out << url << std::endl;
    tell_if_empty(arguments);
    if (watch_)
      watch_->start();
    const auto browser = arguments.open ? open_browser(url, console_, environment_.files) : nullptr;
    wait_for_end(environment_.cancel, *http_);
    tell_(server::LogLevel::info, "stopping");
    http_->stop();
    if (watch_)
      watch_->stop();
    if (http_->is_lost())
      throw Error(ErrorCode::io, "the system took the port away; start this again");
  }

 private:
  /// Tells if there are no hierarchies. A folder that cannot be listed now may be listed later.
  void tell_if_empty(const ServeArguments& arguments) {
    try {
      if (hierarchies_.list().empty())
        tell_(server::LogLevel::info, empty_text(arguments));
    } catch (const Error& error) {
      warn_(error.what());
    }
  }

  server::Figures figures() {
    server::Figures figures{.traffic = http_->traffic()};
    try {
      figures.models = site_->model_count();
    } catch (const Error&) {  // the folder cannot be listed now, as /readyz tells
    }
    if (watch_)
      figures.builds = watch_->counts();
    if (uploads_)
      figures.uploads = uploads_->counts();
    return figures;
  }

  Environment& environment_;
  Console console_;
  server::Watch::Tell tell_;
  server::Hierarchies::Tell warn_, complain_;
  server::Vitals vitals_;  ///< asks the others, but only for http_
  server::Hierarchies hierarchies_;
  std::optional<server::Site> site_;  ///< asks watch_ for jobs, but only for http_
  std::optional<server::Watch> watch_;
  std::optional<server::Uploads> uploads_;
  std::optional<server::ViewRequests> views_;
  std::optional<server::HttpServer> http_;
};

/// Asks the server that was started with the same words; 0: its reply is what is hoped for.
int ask_health(const ServeArguments& arguments, Environment& environment) {
  const server::HealthAnswer answer =
      server::ask_health(arguments.server.host, arguments.server.port, *arguments.question);
  (answer.is_well ? environment.out : environment.messages) << answer.text << std::endl;
  return answer.is_well ? 0 : 1;
}

/// Locks the folder against another one that does the same.
std::unique_ptr<storage::FileLock> lock_once(const ServeArguments& arguments,
                                             storage::FileSystem& files) {
  auto lock =
      files.try_lock(storage::output_lock_path(files.canonical(arguments.folder) / "serve-once"));
  if (!lock) {
    throw Error(ErrorCode::locked, fmt::format("another \"meshhier serve --once\" is at work on {}",
                                               arguments.folder));
  }
  return lock;
}

std::string once_text(const server::Watch::Outcome& outcome) {
  return fmt::format("{} built, {} up to date, {} failed, {} left for the next time\n",
                     outcome.built, outcome.up_to_date, outcome.failed, outcome.left);
}

/// Builds what is in the inbox and due, without a server.
int run_once(const ServeArguments& arguments, Environment& environment) {
  constexpr std::chrono::milliseconds kLook{20};
  const auto lock = lock_once(arguments, environment.files);
  Console console(environment.messages, arguments.quiet, arguments.log_format);
  const server::Watch::Tell tell = [&](server::LogLevel level, const std::string& message) {
    console.tell(level, message);
  };
  server::Hierarchies hierarchies(
      storage::open_folder(arguments.folder),
      [&](const std::string& message) { tell(server::LogLevel::warning, message); });
  server::WatchOptions options = watch_options(arguments, environment);
  options.once = true;
  server::Watch watch(std::move(options), environment.files, hierarchies, tell);
  watch.start();
  while (!environment.cancel.cancelled() && !watch.is_over())
    std::this_thread::sleep_for(kLook);
  watch.stop();
  environment.out << once_text(watch.outcome()) << std::flush;
  if (environment.cancel.cancelled())
    throw Error(ErrorCode::interrupted, "interrupted; the same command goes on where it was");
  return server::exit_code_of(watch.outcome().failures);
}

int run_serve(const ServeArguments& arguments, Environment& environment) {
  if (arguments.question)
    return ask_health(arguments, environment);
  check_folder("FOLDER", arguments.folder, environment);
  if (!arguments.inbox.empty())
    check_folder(arguments.takes_uploads ? "--inbox" : "--watch", arguments.inbox, environment);
  if (arguments.once)
    return run_once(arguments, environment);
  Service service(arguments, environment);
  service.run(arguments);
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
  add_size_option(command, "--disk-floor",
                  "With --watch or --inbox: with less disk left it is not ready",
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
  command
      .add_option("--settle", arguments.settle_seconds,
                  "A file in INBOX that has not changed for so long is whole [2]")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, 86400.0));
  CLI::Option* once = command.add_flag("--once", arguments.once,
                                       "Build what is there and due, and end; no page, no port");
  for (const char* option : {"--host", "--port", "--cors", "--open", "--viewer"})
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
  command->add_flag("--quiet", arguments->quiet, "Print nothing but the URL and what is missing")
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
