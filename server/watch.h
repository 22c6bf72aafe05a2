// Mesh files that are dropped into a folder become hierarchies in another one, one after the other.
#pragma once

#include "execution/cancel.h"
#include "server/build_counts.h"
#include "server/build_process.h"
#include "server/build_target.h"
#include "server/hierarchies.h"
#include "server/inbox.h"
#include "server/input_notes.h"
#include "server/job.h"
#include "server/log_text.h"
#include "server/sources.h"
#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::server {

struct WatchOptions {
  std::filesystem::path inbox;   ///< absolute
  std::filesystem::path folder;  ///< absolute; the hierarchies'
  std::filesystem::path config;  ///< absolute; empty: all defaults
  std::string suffix = ".hier";  ///< the hierarchies' names end with it
  std::string program;           ///< path of meshhier
  Inbox::Folders folders = Inbox::Folders::ignored;
  std::chrono::milliseconds settle{2000};
  std::chrono::milliseconds look_every{1000};
  bool once = false;  ///< ends when all that is there is built, but for files that still change
  /// A build that another process has in hand is tried again after so long.
  std::chrono::milliseconds try_again{5000};
  std::function<void()> on_new = [] {
  };  ///< called when a hierarchy has appeared, before its job goes
};

/// Each build is a process of its own: whatever ends it, this goes on. A file whose build failed is
/// tried again when it has changed. A build that was going on when this process ended, however it
/// ended, is gone on with by the next one.
class Watch {
 public:
  using Tell = std::function<void(LogLevel level, const std::string& message)>;

  /// `tell` hears messages for people, from the thread of this object, as `options.on_new` is
  /// called. `files` and `hierarchies`, of the same folder, must outlive this. Throws Error(io) if
  /// a folder cannot be opened.
  Watch(WatchOptions options, storage::FileSystem& files, Hierarchies& hierarchies, Tell tell);
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  /// Stops, as stop().
  ~Watch();

  /// Starts the thread that looks and builds.
  void start();
  /// Asks the build at work to stop, which keeps its work for the next one, and waits for it.
  void stop();

  /// Whether it has ended by itself, as WatchOptions::once has it. Thread-safe.
  bool is_over() const;
  /// The files of the inbox when it has ended.
  struct Outcome {
    std::size_t built = 0, up_to_date = 0, failed = 0;
    std::size_t left = 0;       ///< they still change, or another process builds there
    std::vector<int> failures;  ///< exit codes, of what another process builds, too
  };
  Outcome outcome() const;

  /// Returns the jobs of all files that are no hierarchies yet, by name. Thread-safe.
  nlohmann::ordered_json jobs() const;
  /// Thread-safe.
  BuildCounts counts() const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  /// fresh: not yet looked for in the folder, or its hierarchy cannot be read.
  enum class State { fresh, growing, waiting, building, failed, done };
  struct Entry {
    InputVersion version;
    State state = State::fresh;
    Job job;
    Time not_before;  ///< another process was at work on the output
    int code = 0;     ///< exit code of the last try
    bool was_built = false;
  };
  void run();
  void run_once();
  void look();
  void note(const InboxFile& file);
  std::string next_waiting() const;
  void handle(const std::string& name);
  void drop_what_is_done();
  void tell_left_out();
  void count(const BuildEnd& outcome, std::chrono::steady_clock::duration time);
  void keep_fresh(const std::string& name, const std::string& cause);
  std::vector<std::string> names_in(std::optional<State> state) const;
  BuildTarget target_of(const std::string& name, Sources::Unknown unknown);
  InputVersion version_of(const std::string& name) const;
  bool is_in_hand(const BuildTarget& target);
  void put_off(const std::string& name, const std::string& message, int code);
  void fail(const std::string& name, const std::string& message, int code);
  void build(const std::string& name, const BuildTarget& target);
  BuildEnd run_build(const std::string& name, const BuildTarget& target);
  void settle(const std::string& name, const BuildTarget& target, const InputVersion& version,
              const BuildEnd& outcome);
  void settle_built(const std::string& name, const BuildTarget& target, const InputVersion& version,
                    const std::vector<std::string>& warnings);
  void keep_warnings(const std::string& name, const Model& model,
                     const std::vector<std::string>& warnings);
  void set_done(const std::string& name);
  void set_state(const std::string& name, State state, const std::string& message);
  std::string shown_text(const std::string& message) const;
  std::vector<std::string> words(const std::string& name, const BuildTarget& target) const;
  void sleep();
  bool is_stopping() const { return cancel_.cancelled(); }

  WatchOptions options_;
  storage::FileSystem& files_;
  Hierarchies& hierarchies_;
  Tell tell_;
  std::shared_ptr<const storage::Folder> folder_;
  InputNotes notes_;
  Inbox inbox_;
  Sources sources_;
  Time last_look_;
  std::string trouble_;                               ///< the failure of the last look, told once
  std::map<std::string, std::string> told_left_out_;  ///< folders of the inbox, and why

  execution::CancelToken cancel_;
  mutable std::mutex mutex_;  ///< guards what follows
  std::map<std::string, Entry> entries_;
  BuildCounts counts_;
  bool is_over_ = false;
  std::condition_variable stopped_;
  std::thread thread_;
};

}  // namespace meshhier::server
