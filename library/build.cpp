#include "pipeline/build.h"

#include "config/named_files.h"
#include "execution/cancel.h"
#include "execution/job_progress.h"
#include "execution/progress.h"
#include "library/errors.h"
#include "storage/io/file.h"

#include <mutex>
#include <string_view>
#include <utility>

namespace meshhier::v1 {
namespace {

/// Tells the caller the progress, from whatever thread, and asks the job to stop if the caller says
/// so.
class Told final : public execution::Progress {
 public:
  Told(const BuildRequest& request, execution::CancelToken& cancel)
      : request_(request), cancel_(cancel), clock_(execution::steady_clock()) {}

  void expect(std::vector<execution::ExpectedStage> stages) override {
    job_.expect(std::move(stages));
  }

  void stage(std::string_view name, std::uint64_t total, std::string_view unit) override {
    const std::scoped_lock lock(mutex_);
    job_.begin(name, unit, total, clock_());
    now_ = {std::string(name), 0, total, std::string(unit)};
    tell();
  }

  void advance(std::uint64_t count) override {
    const std::scoped_lock lock(mutex_);
    now_.done += count;
    if (clock_() - told_ >= kSeconds)
      tell();
  }

  void warn(std::string_view message) override {
    if (request_.warn)
      request_.warn(std::string(message));
  }

  void finish(std::string_view) override {}

 private:
  static constexpr double kSeconds = 0.25;

  void tell() {
    told_ = clock_();
    if (!request_.progress)
      return;
    now_.job_done = job_.part(now_.done).value_or(-1);
    now_.seconds_left = job_.seconds_left(now_.done, told_).value_or(-1);
    if (!request_.progress(now_))
      cancel_.cancel();
  }

  const BuildRequest& request_;
  execution::CancelToken& cancel_;
  execution::Clock clock_;
  std::mutex mutex_;
  execution::JobProgress job_;
  v1::Progress now_;
  double told_ = -1;
};

}  // namespace

void build(const BuildRequest& request) {
  translated([&] {
    const auto files = storage::make_posix_file_system();
    std::vector<std::string> settings;
    for (const auto& [key, value] : request.settings)
      settings.push_back(key + '=' + value);
    config::CommandLine words(std::move(settings));
    words.output = request.output;
    const config::Config config = config::load_named(
        *files, {request.meshes.begin(), request.meshes.end()}, std::move(words));
    execution::CancelToken cancel;
    Told progress(request, cancel);
    pipeline::build_hierarchy(config, {.force = request.replace}, {*files, progress, cancel});
  });
}

}  // namespace meshhier::v1
