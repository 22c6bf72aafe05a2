#include "app/serving.h"

#include "app/token_file.h"
#include "app/viewer_place.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "config/config.h"
#include "server/build_process.h"
#include "server/hierarchies.h"
#include "server/http_server.h"
#include "server/log_text.h"
#include "server/site.h"
#include "server/uploads.h"
#include "server/view_requests.h"
#include "server/vitals.h"
#include "server/watch.h"
#include "storage/io/child_process.h"
#include "storage/io/file_rights.h"
#include "storage/io/output_file.h"
#include "storage/io/own_program.h"

#include <algorithm>
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

#include <fmt/format.h>

namespace meshhier::app {
namespace {

/// Prints lines on standard error, whole ones from any thread.
class Console {
 public:
  Console(std::ostream& out, bool quiet, server::LogFormat format)
      : out_(out), quiet_(quiet), format_(format) {}

  /// Errors even if it is quiet: somebody must hear of them.
  void tell(server::LogLevel level, const std::string& message) {
    if (!quiet_ || level == server::LogLevel::error)
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
  options.folder = environment.files.canonical(arguments.folder);
  options.disk_floor = arguments.disk_floor;
  options.suffix = suffix_of(arguments.config, environment);
  options.is_loopback = server::is_loopback_host(arguments.server.host);
  if (!arguments.token_file.empty())
    options.token = read_token(environment.files, "--upload-token-file", arguments.token_file);
  return options;
}

server::VitalsOptions vitals_options(const ServeArguments& arguments,
                                     std::shared_ptr<const storage::Folder> folder,
                                     Environment& environment) {
  storage::FileSystem& files = environment.files;
  server::VitalsOptions options;
  options.readiness = {
      .folder = std::move(folder),
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
        folder_(storage::open_folder(arguments.folder)),
        vitals_(
            vitals_options(arguments, folder_, environment), environment.files,
            [this] { return figures(); }, tell_),
        hierarchies_(folder_, warn_) {
    ViewerPlace viewer = find_viewer(environment.files, arguments.viewer);
    if (!viewer.folder)
      console_.print(server::LogLevel::warning, viewer.missing + ' ' + kServedWithoutPage);
    tell_if_open("--upload-token-file", arguments.token_file);
    tell_if_open("--metrics-token-file", arguments.metrics_token_file);
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
    if (server::is_every_address(arguments.server.host))
      tell_(server::LogLevel::info,
            fmt::format("listening on all addresses of this machine: others open "
                        "http://ADDRESS:{}/, ADDRESS being one of them",
                        http_->port()));
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
  /// Tells if a secret is none for other users.
  void tell_if_open(const char* option, const std::string& file) const {
    if (!file.empty() && storage::is_open_to_others(file)) {
      warn_(fmt::format("{} {}: other users may read or change it: chmod 600", option,
                        plain_text(file, kLongestFolderName)));
    }
  }

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
  std::shared_ptr<const storage::Folder> folder_;
  server::Vitals vitals_;  ///< asks the others, but only for http_
  server::Hierarchies hierarchies_;
  std::optional<server::Site> site_;  ///< asks watch_ for jobs, but only for http_
  std::optional<server::Watch> watch_;
  std::optional<server::Uploads> uploads_;
  std::optional<server::ViewRequests> views_;
  std::optional<server::HttpServer> http_;
};

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

}  // namespace

void serve_folder(const ServeArguments& arguments, Environment& environment) {
  Service(arguments, environment).run(arguments);
}

int build_inbox(const ServeArguments& arguments, Environment& environment) {
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
  const bool is_told = !arguments.quiet || !watch.outcome().failures.empty();
  environment.out << (is_told ? once_text(watch.outcome()) : "") << std::flush;
  if (environment.cancel.cancelled())
    throw Error(ErrorCode::interrupted, "interrupted; the same command goes on where it was");
  return server::exit_code_of(watch.outcome().failures);
}

}  // namespace meshhier::app
