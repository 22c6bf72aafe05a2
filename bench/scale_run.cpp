#include "bench/scale_run.h"

#include "bench/child_process.h"
#include "execution/size_text.h"
#include "hierarchy/error.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::bench {
namespace {

namespace fs = std::filesystem;

// Disk a size takes per triangle, at most: the mesh in both orders 38, a hierarchy 28, temporary
// files 45.
constexpr std::uint64_t kRoomPerTriangle = 115;

// A base made from nothing has as many triangles as a common scan.
constexpr std::uint64_t kTorusTriangles = 870'000;

constexpr int kBudgetCode = static_cast<int>(ErrorCode::budget);
constexpr int kInterruptedCode = static_cast<int>(ErrorCode::interrupted);

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A directory of its own; gone at the end.
class WorkPlace {
 public:
  WorkPlace(storage::FileSystem& files, fs::path path) : files_(files), path_(std::move(path)) {
    files_.remove_all(path_);
    files_.make_directories(path_);
  }
  WorkPlace(const WorkPlace&) = delete;
  WorkPlace& operator=(const WorkPlace&) = delete;
  ~WorkPlace() {
    try {
      files_.remove_all(path_);
    } catch (const Error&) {  // what brought us here is the one to report
    }
  }
  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  storage::FileSystem& files_;
  fs::path path_;
};

std::string text_of(storage::FileSystem& files, const fs::path& path) {
  constexpr std::uint64_t kMostBytes = 1 << 24;
  const std::vector<std::byte> bytes = storage::read_file(files, path, kMostBytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A loop that the compiler cannot shorten and that touches no memory. Some 0.3 seconds.
std::uint64_t compute(std::uint64_t seed) {
  std::uint64_t x = seed | 1;
  for (int i = 0; i < 150'000'000; ++i) {
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
  }
  return x;
}

double compute_wall(unsigned threads) {
  std::vector<std::uint64_t> results(threads);
  const Stopwatch watch;
  {
    std::vector<std::jthread> workers;
    for (unsigned t = 0; t < threads; ++t)
      workers.emplace_back([&results, t] { results[t] = compute(t); });
  }
  // The results are looked at, so that they must be there.
  const bool any = std::ranges::any_of(results, [](std::uint64_t x) { return x != 0; });
  return any ? watch.seconds() : 0;
}

class Runner {
 public:
  Runner(storage::FileSystem& files, const ScaleOptions& options, const Tell& tell)
      : files_(files),
        options_(options),
        tell_(tell),
        place_(files, options.work / ".meshhier-scale") {}

  ScaleReport run() {
    report_.usual = {0, false, options_.methods.front(), options_.threads.back(),
                     options_.budgets.front()};
    measure_compute();
    make_base();
    for (const auto& [triangles, times] : sizes()) {
      if (report_.usual.triangles == 0 || triangles <= options_.usual_largest)
        report_.usual.triangles = triangles;
    }
    for (const auto& [triangles, times] : sizes())
      run_size(triangles, times);
    return std::move(report_);
  }

 private:
  void measure_compute() {
    tell_("a loop that only computes");
    for (const unsigned threads : options_.threads) {
      if (threads > 1)
        report_.compute.push_back({threads, compute_gain(threads)});
    }
  }

  /// The base as it is, or a torus with as much detail as a scan.
  void make_base() {
    base_ = options_.base.empty() ? fs::path() : fs::absolute(options_.base);
    if (base_.empty()) {
      base_ = place_ / "base.ply";
      const std::uint64_t wanted = std::min(kTorusTriangles, options_.smallest);
      generate({"surface", "--shape", "torus", "--noise", "0.3", "--triangles",
                std::to_string(wanted), "-o", base_.string()});
      report_.base =
          fmt::format("a generated torus of {} triangles and its amplifications", wanted);
    } else {
      report_.base = fmt::format("{} and its amplifications", base_.stem().string());
    }
    base_triangles_ = triangles_of(base_);
  }

  /// Triangles and how often the base is amplified for them.
  std::vector<std::pair<std::uint64_t, int>> sizes() const {
    std::vector<std::pair<std::uint64_t, int>> result;
    std::uint64_t triangles = base_triangles_;
    for (int times = 0; triangles <= options_.largest; ++times, triangles *= 4) {
      if (triangles >= options_.smallest)
        result.emplace_back(triangles, times);
    }
    if (result.empty())
      throw Error(ErrorCode::usage, "no size lies between the smallest and the largest asked for");
    return result;
  }

  void run_size(std::uint64_t triangles, int times) {
    const std::uint64_t room = triangles * kRoomPerTriangle;
    const std::uint64_t free = files_.free_bytes(options_.work);
    if (free < room) {
      tell_(fmt::format("{} triangles: skipped, {} free, about {} needed", triangles,
                        execution::rounded_size_text(free), execution::rounded_size_text(room)));
      return;
    }
    tell_(fmt::format("{} triangles: making the mesh", triangles));
    input_ = place_ / "mesh.ply";
    generate({"amplify", base_.string(), "--times", std::to_string(times), "-o", input_.string()});
    if (triangles == report_.usual.triangles)
      compare_usual(triangles);
    for (const std::uint64_t budget : options_.budgets)
      measure({triangles, false, report_.usual.method, report_.usual.threads, budget});
    if (triangles <= options_.largest_shuffled)
      run_shuffled(triangles);
    files_.remove_all(input_);
  }

  /// Threads and methods, at one size.
  void compare_usual(std::uint64_t triangles) {
    for (const unsigned threads : options_.threads)
      measure({triangles, false, report_.usual.method, threads, report_.usual.budget_bytes});
    for (const std::string& method : options_.methods)
      measure({triangles, false, method, report_.usual.threads, report_.usual.budget_bytes});
  }

  void run_shuffled(std::uint64_t triangles) {
    tell_(fmt::format("{} triangles: shuffling the mesh", triangles));
    const fs::path shuffled = place_ / "shuffled.ply";
    generate({"shuffle", input_.string(), "-o", shuffled.string()});
    const fs::path own = std::exchange(input_, shuffled);
    measure(
        {triangles, true, report_.usual.method, report_.usual.threads, report_.usual.budget_bytes});
    files_.remove_all(shuffled);
    input_ = own;
  }

  /// Does nothing if it was measured already.
  void measure(const ScaleSetting& setting) {
    const auto same = [&](const ScaleMeasurement& m) { return m.setting == setting; };
    if (std::ranges::any_of(report_.measurements, same))
      return;
    tell_(fmt::format("{} triangles{}, {}, threads {}, {}", setting.triangles,
                      setting.shuffled ? " in random order" : "", setting.method, setting.threads,
                      execution::exact_size_text(setting.budget_bytes)));
    std::optional<ScaleMeasurement> best;
    for (unsigned i = 0; i < options_.repeat; ++i) {
      std::optional<ScaleMeasurement> next = build(setting);
      if (!next)
        return;
      if (!best || next->wall_seconds < best->wall_seconds)
        best = std::move(next);
    }
    best->copy_seconds = copy_seconds(files_, input_, best->output_bytes, place_ / "copy");
    report_.measurements.push_back(std::move(*best));
  }

  /// Nothing if memory or disk do not suffice.
  std::optional<ScaleMeasurement> build(const ScaleSetting& setting) {
    const fs::path config = place_ / "config.json", stats = place_ / "stats.json";
    const nlohmann::json content{{"input", input_.string()},
                                 {"output", (place_ / "mesh.hier").string()},
                                 {"memory_budget", setting.budget_bytes},
                                 {"threads", setting.threads},
                                 {"simplify", {{"method", setting.method}}}};
    const std::string text = content.dump();
    storage::write_file(files_, config, std::as_bytes(std::span(text)));
    const ChildResult child =
        run_child({options_.meshhier.string(), "build", config.string(), "--force", "--progress",
                   "none", "--stats", stats.string()},
                  place_ / "log");
    if (child.code == kBudgetCode) {
      tell_("  skipped: " + text_of(files_, place_ / "log"));
      return std::nullopt;
    }
    check(child, "meshhier build");
    ScaleMeasurement result = parse_stats(text_of(files_, stats), setting);
    result.system_peak_bytes = child.peak_resident_bytes;
    files_.remove_all(place_ / "mesh.hier");
    return result;
  }

  void generate(std::vector<std::string> words) {
    words.insert(words.begin(), options_.meshgen.string());
    check(run_child(words, place_ / "log"), "meshgen");
  }

  void check(const ChildResult& child, const char* name) {
    if (child.code == kInterruptedCode)
      throw Error(ErrorCode::interrupted, "interrupted");
    if (child.code != 0) {
      throw Error(ErrorCode::input, fmt::format("{} ended with code {}: {}", name, child.code,
                                                text_of(files_, place_ / "log")));
    }
  }

  std::uint64_t triangles_of(const fs::path& mesh) {
    const nlohmann::json content{{"input", mesh.string()},
                                 {"output", (place_ / "mesh.hier").string()},
                                 {"memory_budget", "4GiB"}};
    const std::string text = content.dump();
    const fs::path config = place_ / "config.json";
    storage::write_file(files_, config, std::as_bytes(std::span(text)));
    check(run_child({options_.meshhier.string(), "build", config.string(), "--dry-run", "--json"},
                    place_ / "log"),
          "meshhier build --dry-run");
    return nlohmann::json::parse(text_of(files_, place_ / "log")).at("faces");
  }

  storage::FileSystem& files_;
  const ScaleOptions& options_;
  const Tell& tell_;
  WorkPlace place_;
  fs::path base_, input_;
  std::uint64_t base_triangles_ = 0;
  ScaleReport report_;
};

}  // namespace

ScaleReport run_scale(storage::FileSystem& files, const ScaleOptions& options, const Tell& tell) {
  return Runner(files, options, tell).run();
}

double compute_gain(unsigned threads) {
  double alone = compute_wall(1);
  double together = compute_wall(threads);
  for (int i = 0; i < 2; ++i) {  // the best of three, as others may work on the machine
    alone = std::min(alone, compute_wall(1));
    together = std::min(together, compute_wall(threads));
  }
  return together > 0 ? threads * alone / together : 0;
}

double copy_seconds(storage::FileSystem& files, const fs::path& from, std::uint64_t output_bytes,
                    const fs::path& to) {
  std::vector<std::byte> buffer(1 << 20);
  const Stopwatch watch;
  const auto source = files.open(from);
  for (std::uint64_t at = 0; source->read_at(at, buffer) == buffer.size();)
    at += buffer.size();
  const auto target = files.create(to);
  for (std::uint64_t at = 0; at < output_bytes; at += buffer.size()) {
    target->write_at(
        at, std::span(buffer).first(std::min<std::uint64_t>(buffer.size(), output_bytes - at)));
  }
  target->sync();
  const double seconds = watch.seconds();
  files.remove_all(to);
  return seconds;
}

}  // namespace meshhier::bench
