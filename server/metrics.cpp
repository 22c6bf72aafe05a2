#include "server/metrics.h"

#include "server/exposition.h"
#include "storage/io/open_files.h"
#include "storage/io/process.h"
#include "storage/io/process_state.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

using Kind = Exposition::Kind;

/// A family of one sample.
struct Row {
  Kind kind;
  std::string_view name, help;
  double value;
};

template <class Number>
double figure(Number value) {
  return static_cast<double>(value);
}

void add_rows(Exposition& text, std::span<const Row> rows) {
  for (const Row& row : rows)
    text.add_one(row.kind, row.name, row.help, row.value);
}

void add_requests(Exposition& text, const RequestCounts& requests) {
  text.begin(Kind::counter, "meshhier_requests_total", "Requests that were answered.");
  for (std::size_t method = 0; method < RequestCounts::kMethods.size(); ++method) {
    for (std::size_t one = 0; one < RequestCounts::kClasses.size(); ++one) {
      text.add(figure(requests.of(method, one)),
               fmt::format(R"(method="{}",status="{}xx")", RequestCounts::kMethods[method],
                           RequestCounts::kClasses[one]));
    }
  }
}

void add_traffic(Exposition& text, const Traffic& traffic) {
  add_rows(text, std::array<Row, 5>{{
                     {Kind::counter, "meshhier_sent_bytes_total",
                      "Bytes that clients have taken, heads included.", figure(traffic.sent_bytes)},
                     {Kind::gauge, "meshhier_connections_open", "Connections that are open.",
                      figure(traffic.open)},
                     {Kind::gauge, "meshhier_connections_served", "Connections that have a thread.",
                      figure(traffic.served)},
                     {Kind::counter, "meshhier_connections_accepted_total",
                      "Connections that were accepted.", figure(traffic.accepted)},
                     {Kind::counter, "meshhier_connections_refused_total",
                      "Connections that were closed without a reply: there were too many.",
                      figure(traffic.refused)},
                 }});
}

void add_builds(Exposition& text, const BuildCounts& builds) {
  text.begin(Kind::counter, "meshhier_builds_total", "Builds of the watched folder that ended.");
  text.add(figure(builds.done), R"(result="done")");
  text.add(figure(builds.failed), R"(result="failed")");
  text.add_one(Kind::counter, "meshhier_build_seconds_total", "Time that these builds took.",
               builds.seconds);
  text.begin(Kind::gauge, "meshhier_inbox_meshes",
             "Meshes of the watched folder that have no hierarchy.");
  text.add(figure(builds.at_work), R"(state="building")");
  text.add(figure(builds.waiting), R"(state="waiting")");
  text.add(figure(builds.not_built), R"(state="failed")");
}

void add_uploads(Exposition& text, const UploadCounts& uploads) {
  text.begin(Kind::counter, "meshhier_uploads_total", "Uploads of meshes that ended.");
  text.add(figure(uploads.taken), R"(result="taken")");
  text.add(figure(uploads.refused), R"(result="refused")");
  add_rows(
      text,
      std::array<Row, 2>{{
          {Kind::counter, "meshhier_upload_bytes_total", "Bytes of uploads taken.",
           figure(uploads.bytes)},
          {Kind::gauge, "meshhier_uploads_at_work", "Uploads under way.", figure(uploads.at_once)},
      }});
}

void add_places(Exposition& text, const Figures& figures) {
  if (figures.models) {
    text.add_one(Kind::gauge, "meshhier_models", "Hierarchies and streams that are shown.",
                 figure(*figures.models));
  }
  text.begin(Kind::gauge, "meshhier_disk_free_bytes", "Bytes that are free for this server.");
  for (const auto& [place, bytes] : figures.free_bytes)
    text.add(figure(bytes), fmt::format(R"(place="{}")", place));
}

/// Adds what all programs tell under the same names.
void add_process(Exposition& text, std::chrono::system_clock::time_point started) {
  const storage::ProcessUsage usage = storage::process_usage();
  const storage::ProcessState state = storage::process_state();
  add_rows(text,
           std::array<Row, 7>{{
               {Kind::counter, "process_cpu_seconds_total",
                "Time of processors that this process has used, without its builds.",
                usage.user_seconds + usage.system_seconds},
               {Kind::gauge, "process_resident_memory_bytes", "Memory that is resident.",
                figure(state.resident_bytes)},
               {Kind::gauge, "process_virtual_memory_bytes", "Address space.",
                figure(state.virtual_bytes)},
               {Kind::gauge, "process_open_fds", "Files that are open.", figure(state.open_files)},
               {Kind::gauge, "process_max_fds", "Files that may be open.",
                figure(storage::most_open_files())},
               {Kind::gauge, "process_threads", "Threads.", figure(state.threads)},
               {Kind::gauge, "process_start_time_seconds", "Start of the server, since 1970.",
                std::chrono::duration<double>(started.time_since_epoch()).count()},
           }});
}

}  // namespace

void RequestCounts::count(std::string_view method, int status) {
  const auto known = std::find(kMethods.begin(), kMethods.end() - 1, method);
  const auto one = std::find(kClasses.begin(), kClasses.end() - 1, status / 100);
  ++counts_[static_cast<std::size_t>(known - kMethods.begin())]
           [static_cast<std::size_t>(one - kClasses.begin())];
}

std::string metrics_text(const RequestCounts& requests, const Figures& figures) {
  Exposition text;
  add_requests(text, requests);
  add_traffic(text, figures.traffic);
  if (figures.builds)
    add_builds(text, *figures.builds);
  if (figures.uploads)
    add_uploads(text, *figures.uploads);
  add_places(text, figures);
  add_process(text, figures.started);
  return text.text();
}

}  // namespace meshhier::server
