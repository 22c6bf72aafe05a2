#include "app/written_file.h"

#include "app/options.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <ostream>

namespace meshhier::app {

int write_file(const FileJob& job, execution::ProgressMode mode, Environment& environment,
               const MakeFile& make) {
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  for (const std::string& output : job.outputs)
    require_no_terminal(environment, output);
  const bool is_streamed = std::ranges::any_of(job.outputs, [&](const std::string& output) {
    return storage::is_standard_output(environment.files, output);
  });
  std::ostream& account = is_streamed ? environment.messages : environment.out;
  const HierarchyPlace place(environment, job.hierarchy, job.web);
  const std::string line = make(place, *progress);
  progress->finish(*std::ranges::find_if(
      job.outputs, [](const std::string& output) { return !output.empty(); }));
  account << line << '\n' << place.account();
  return 0;
}

}  // namespace meshhier::app
