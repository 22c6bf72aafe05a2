#include "server/watch.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/format/layout.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

using Clock = std::chrono::steady_clock;

/// So many folders of the inbox that are left out are told.
constexpr std::size_t kMostLeftOut = 100;

constexpr int kExists = static_cast<int>(ErrorCode::exists);
constexpr int kLocked = static_cast<int>(ErrorCode::locked);

/// Returns a text without the path of a directory: nobody on the network needs to know where things
/// lie on this machine.
std::string without(std::string text, const std::string& directory) {
  const std::string start = directory + '/';
  for (std::size_t at = text.find(start); at != std::string::npos; at = text.find(start))
    text.erase(at, start.size());
  return text;
}

constexpr const char* kGrowing = "waits until the file no longer changes";
constexpr const char* kMoved =
    "waits, as the folder of hierarchies is not the one that was there at the start: start the "
    "server again";

}  // namespace

Watch::Watch(WatchOptions options, storage::FileSystem& files, Hierarchies& hierarchies, Tell tell)
    : options_(std::move(options)),
      files_(files),
      hierarchies_(hierarchies),
      tell_(std::move(tell)),
      folder_(storage::open_folder(options_.folder)),
      notes_(files_, folder_),
      inbox_(options_.inbox,
             {.settle = options_.settle,
              .folders = options_.folders,
              .mark = [this](const std::string& name) { return sources_.mark(name); }}),
      sources_(inbox_, notes_, cancel_,
               [this](const std::string& message) { tell_(LogLevel::warning, message); }) {}

Watch::~Watch() {
  stop();
}

void Watch::start() {
  thread_ = std::thread([this] { run(); });
}

void Watch::stop() {
  {
    const std::lock_guard lock(mutex_);
    cancel_.cancel();
  }
  stopped_.notify_all();
  if (thread_.joinable())
    thread_.join();
}

nlohmann::ordered_json Watch::jobs() const {
  auto list = nlohmann::ordered_json::array();
  const std::lock_guard lock(mutex_);
  for (const auto& [name, entry] : entries_) {
    if (entry.state == State::done)
      continue;
    Job shown = entry.job;
    shown.message = shown_text(shown.message);
    list.push_back(to_json(shown));
  }
  return list;
}

BuildCounts Watch::counts() const {
  const std::lock_guard lock(mutex_);
  BuildCounts counts = counts_;
  for (const auto& [name, entry] : entries_) {
    counts.at_work += entry.state == State::building ? 1 : 0;
    counts.not_built += entry.state == State::failed ? 1 : 0;
    counts.waiting += entry.job.state == JobState::waiting && entry.state != State::done ? 1 : 0;
  }
  return counts;
}

/// Counts a build that has ended; one that was stopped, or found another at work, is none.
void Watch::count(const BuildEnd& outcome, Clock::duration time) {
  if (is_stopping() || outcome.code == kExists || outcome.code == kLocked)
    return;
  const std::lock_guard lock(mutex_);
  ++(outcome.code == 0 ? counts_.done : counts_.failed);
  counts_.seconds += std::chrono::duration<double>(time).count();
}

bool Watch::is_over() const {
  const std::lock_guard lock(mutex_);
  return is_over_;
}

Watch::Outcome Watch::outcome() const {
  Outcome outcome;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, entry] : entries_) {
    if (entry.state == State::failed)
      ++outcome.failed;
    else if (entry.state != State::done)
      ++outcome.left;
    if (entry.state == State::fresh)  // its hierarchy cannot be looked at
      outcome.failures.push_back(static_cast<int>(ErrorCode::io));
    else if (entry.state != State::done && entry.code != 0)
      outcome.failures.push_back(entry.code);
    if (entry.state == State::done)
      ++(entry.was_built ? outcome.built : outcome.up_to_date);
  }
  if (!trouble_.empty())
    outcome.failures.push_back(static_cast<int>(ErrorCode::io));
  return outcome;
}

void Watch::run() {
  if (options_.once)
    return run_once();
  while (!is_stopping()) {
    look();
    const std::string name = next_waiting();
    if (name.empty()) {
      sleep();
    } else {
      handle(name);
    }
  }
}

/// Does what is there. A file is whole if it does not change while it is waited for.
void Watch::run_once() {
  look();
  if (!names_in(State::growing).empty()) {
    std::unique_lock lock(mutex_);
    stopped_.wait_for(lock, options_.settle, [this] { return is_stopping(); });
  }
  look();
  for (std::string name = next_waiting(); !name.empty() && !is_stopping(); name = next_waiting()) {
    handle(name);
    look();
  }
  for (const std::string& name : names_in(State::growing))
    tell_(LogLevel::info, name + ": is left for the next time, as it still changes");
  const std::lock_guard lock(mutex_);
  is_over_ = true;
}

void Watch::sleep() {
  std::unique_lock lock(mutex_);
  stopped_.wait_for(lock, options_.look_every, [this] { return is_stopping(); });
}

/// Looks into the inbox. A folder that is away for a while (a network's) comes back: the failure is
/// told once.
void Watch::look() {
  last_look_ = Clock::now();
  try {
    const std::vector<InboxFile> files = inbox_.look();
    const auto is_gone = [&](const auto& entry) {
      return std::none_of(files.begin(), files.end(),
                          [&](const InboxFile& file) { return file.name == entry.first; });
    };
    sources_.forget_all_but(files);
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(entries_, is_gone);
    }
    for (const InboxFile& file : files)
      note(file);
    drop_what_is_done();
    tell_left_out();
    trouble_.clear();
  } catch (const std::exception& error) {
    if (std::exchange(trouble_, error.what()) != error.what())
      tell_(LogLevel::error, error.what());
  }
}

/// Tells each folder that is left out once; another reason is told anew.
void Watch::tell_left_out() {
  for (const auto& [folder, why] : inbox_.left_out()) {
    const auto told = told_left_out_.find(folder);
    if ((told != told_left_out_.end() && told->second == why) ||
        told_left_out_.size() >= kMostLeftOut)
      continue;
    told_left_out_[folder] = why;
    tell_(LogLevel::info, fmt::format("{}/ is left out: {}", folder, why));
    if (told_left_out_.size() == kMostLeftOut)
      tell_(LogLevel::info, "no more folders that are left out are told");
  }
}

/// Drops fresh files that have their hierarchies, as most have after a start: they are not to be
/// shown as if they had none. A file whose hierarchy cannot be looked at stays fresh, to be looked
/// at again, and the others go on.
void Watch::drop_what_is_done() {
  for (const std::string& name : names_in(State::fresh)) {
    try {
      if (target_of(name, Sources::Unknown::is_another).kind == BuildTarget::Kind::done)
        set_done(name);
      else
        set_state(name, State::growing, kGrowing);
    } catch (const std::exception& error) {
      keep_fresh(name, error.what());
    }
  }
}

void Watch::keep_fresh(const std::string& name, const std::string& cause) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(entries_[name].job.message, cause) == cause)
      return;
  }
  tell_(LogLevel::warning, fmt::format("{}: {}", name, cause));
}

std::vector<std::string> Watch::names_in(std::optional<State> state) const {
  std::vector<std::string> names;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, entry] : entries_) {
    if (!state || entry.state == *state)
      names.push_back(name);
  }
  return names;
}

/// Notes the state of a file in the inbox.
void Watch::note(const InboxFile& file) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[file.name];
  const bool is_building = entry.state == State::building;
  if (entry.version != file.version) {
    entry.version = file.version;
    if (!is_building)
      entry = {file.version, State::fresh, {.name = file.name, .message = kGrowing}, {}};
  }
  if (entry.state == State::growing && file.is_whole) {
    entry.state = State::waiting;
    entry.job.message.clear();
  }
}

std::string Watch::next_waiting() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [name, entry] : entries_) {
    if (entry.state == State::waiting && entry.not_before <= Clock::now())
      return name;
  }
  return {};
}

/// Builds the hierarchy of a file. A failure with one file does not keep the others waiting.
void Watch::handle(const std::string& name) {
  try {
    const BuildTarget target = target_of(name, Sources::Unknown::is_read);
    if (target.kind == BuildTarget::Kind::done)
      return set_done(name);
    check_target(target, name, options_.folder);
    if (!folder_->is_in_place())  // what is built there would not be shown
      return put_off(name, kMoved, static_cast<int>(ErrorCode::io));
    if (is_in_hand(target))
      return put_off(name, "waits for another build that is at work on " + target.name, kLocked);
    build(name, target);
  } catch (const storage::Busy& error) {
    put_off(name, error.what(), static_cast<int>(error.code()));
  } catch (const Error& error) {
    fail(name, error.what(), static_cast<int>(error.code()));
  } catch (const std::exception& error) {
    fail(name, error.what(), static_cast<int>(ErrorCode::internal));
  }
}

BuildTarget Watch::target_of(const std::string& name, Sources::Unknown unknown) {
  const storage::FileVersion version = version_of(name).mesh;
  return find_target(
      {hierarchies_, *folder_, options_.suffix}, name, names_in(std::nullopt),
      [&](const Model& model) { return sources_.is_made_of(name, version, model, unknown); });
}

InputVersion Watch::version_of(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(name);
  return found == entries_.end() ? InputVersion() : found->second.version;
}

/// Whether another process builds there. A build would wait for it as well, but not as long.
bool Watch::is_in_hand(const BuildTarget& target) {
  return files_.is_locked(storage::lock_path(storage::work_path(options_.folder / target.name)));
}

void Watch::put_off(const std::string& name, const std::string& message, int code) {
  set_state(name, State::waiting, message);
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(name);
  if (found == entries_.end())
    return;
  found->second.code = code;
  found->second.not_before = options_.once ? Time::max() : Clock::now() + options_.try_again;
}

void Watch::fail(const std::string& name, const std::string& message, int code) {
  if (is_stopping())
    return;
  tell_(LogLevel::error, fmt::format("{}: {}", name, message));
  set_state(name, State::failed, message);
  const std::lock_guard lock(mutex_);
  if (const auto found = entries_.find(name); found != entries_.end())
    found->second.code = code;
}

void Watch::build(const std::string& name, const BuildTarget& target) {
  const InputVersion version = version_of(name);
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[name];
    entry.state = State::building;
    entry.job = {.name = name, .state = JobState::building};
  }
  tell_(LogLevel::info, fmt::format("{}: building {}", name, target.name));
  const auto start = Clock::now();
  const BuildEnd outcome = run_build(name, target);
  count(outcome, Clock::now() - start);
  settle(name, target, version, outcome);
}

BuildEnd Watch::run_build(const std::string& name, const BuildTarget& target) {
  std::size_t told = 0;
  const auto heard = [&](std::string_view /*line*/, const Job& job) {
    for (; told < job.warnings.size(); ++told)
      tell_(LogLevel::warning, fmt::format("{}: {}", name, job.warnings[told]));
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(name);
    if (found != entries_.end() && found->second.state == State::building)
      found->second.job = job;
  };
  // Meanwhile the inbox is looked at as ever, and the file that is built may go from it.
  const auto is_to_stop = [&] {
    if (Clock::now() - last_look_ >= options_.look_every)
      look();
    return is_stopping();
  };
  return run_build_process(words(name, target), {.name = name, .state = JobState::building},
                           {heard, is_to_stop});
}

/// A build that was begun with another config, or from another version of the file, is of no use
/// any more.
std::vector<std::string> Watch::words(const std::string& name, const BuildTarget& target) const {
  std::vector<std::string> list{options_.program, "build"};
  if (!options_.config.empty())
    list.push_back(options_.config.string());
  list.insert(list.end(),
              {"--restart-other", "--progress", "json", "--within", options_.inbox.string(),
               "--input-note", notes_.path(target.name).string()});
  if (target.kind == BuildTarget::Kind::replace)
    list.emplace_back("--force");
  list.insert(list.end(), {"--set", "input=" + (options_.inbox / name).string(),
                           "output=" + (options_.folder / target.name).string()});
  return list;
}

void Watch::settle(const std::string& name, const BuildTarget& target, const InputVersion& version,
                   const BuildEnd& outcome) {
  if (is_stopping())
    return;
  if (outcome.code == 0)
    return settle_built(name, target, version, outcome.warnings);
  look();  // the file may be gone by now, or be another one
  if (version_of(name) == version && outcome.code != kExists && outcome.code != kLocked)
    return fail(name, outcome.message, outcome.code);
  tell_(LogLevel::info, fmt::format("{}: {}", name, outcome.message));
  if (version_of(name) != version)
    set_state(name, State::growing, kGrowing);
  else
    put_off(name, outcome.message, outcome.code);
}

/// Settles a build that succeeded. Files that are now as they were when the build read them are
/// those that it was made of: whoever changes one, or puts another one in its place and it back
/// again, changes one of its times.
void Watch::settle_built(const std::string& name, const BuildTarget& target,
                         const InputVersion& version, const std::vector<std::string>& warnings) {
  options_.on_new();
  const std::optional<Model> model = hierarchies_.look(target.name);
  if (model && sources_.is_still(name, version.mesh) &&
      sources_.is_made_of(name, version.mesh, *model, Sources::Unknown::is_another)) {
    keep_warnings(name, *model, warnings);
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = entries_.find(name); found != entries_.end())
        found->second.was_built = true;
    }
    tell_(LogLevel::info,
          name + ": done" +
              (warnings.empty() ? "" : ", with " + counted(warnings.size(), "warnings")));
    return set_done(name);
  }
  tell_(LogLevel::info, name + ": it was changed while it was built; it is looked at again");
  set_state(name, State::growing, kGrowing);
}

/// Keeps warnings beside the hierarchy, in its note: a server that is started anew lists them, too.
void Watch::keep_warnings(const std::string& name, const Model& model,
                          const std::vector<std::string>& warnings) {
  if (warnings.empty())
    return;
  std::vector<std::string> shown;
  for (const std::string& warning : warnings)
    shown.push_back(shown_text(warning));
  sources_.keep_warnings(name, model, std::move(shown));
  options_.on_new();
}

std::string Watch::shown_text(const std::string& message) const {
  std::string shown = without(without(message, options_.inbox.string()), options_.folder.string());
  return options_.config.empty() ? shown : without(shown, options_.config.parent_path().string());
}

/// Settles a file that has its hierarchy: from here on only changes after the last look count.
void Watch::set_done(const std::string& name) {
  set_state(name, State::done, "");
  const std::lock_guard lock(mutex_);
  if (const auto found = entries_.find(name); found != entries_.end())
    found->second.version.companions = sources_.mark_when_asked(name);
}

void Watch::set_state(const std::string& name, State state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(name);
  if (found == entries_.end())
    return;
  found->second.state = state;
  const JobState shown = state == State::failed ? JobState::failed : JobState::waiting;
  found->second.job = {.name = name, .state = shown, .message = message};
}

}  // namespace meshhier::server
