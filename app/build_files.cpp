#include "app/build_files.h"

#include "app/options.h"
#include "base/error.h"
#include "pipeline/plan/build_stats.h"
#include "pipeline/update.h"
#include "storage/io/json_text.h"

#include <span>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

/// Returns the request for a file, which must not take the place of one that the build reads or
/// makes.
storage::OutputRequest output_request(const std::string& path, const BuildArguments& arguments,
                                      const config::Config& config) {
  storage::OutputRequest request{path, arguments.force, config::read_by(config)};
  request.inputs.push_back(config.output);
  request.inputs.insert(request.inputs.end(), arguments.named.begin(), arguments.named.end());
  return request;
}

/// Whether the file is the account of an earlier build.
bool is_account(const std::string& path, storage::FileSystem& files) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  if (files.kind(path) != storage::FileKind::regular || files.identity(path).bytes > kMostBytes)
    return false;
  const std::vector<std::byte> bytes = storage::read_file(files, path, kMostBytes);
  const auto account = storage::parse_ordered_json_text(
      {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, nullptr, {.throws = false});
  return account.is_object() && account.contains("generator") && account.contains("stages");
}

/// Returns the request for the account. --update replaces that of the build before.
storage::OutputRequest stats_request(const BuildArguments& arguments, const config::Config& config,
                                     storage::FileSystem& files) {
  storage::OutputRequest request = output_request(arguments.stats, arguments, config);
  request.replace = request.replace || (arguments.update && is_account(arguments.stats, files));
  return request;
}

/// Throws if both files are one: the first would go when the second gets its name.
void require_two_files(const BuildArguments& arguments, storage::FileSystem& files) {
  if (arguments.stats.empty() || arguments.input_note.empty())
    return;
  const bool are_standard_output = storage::is_standard_output(files, arguments.stats) &&
                                   storage::is_standard_output(files, arguments.input_note);
  const bool is_one_file =
      files.canonical(arguments.stats) == files.canonical(arguments.input_note) &&
      files.kind(arguments.stats) != storage::FileKind::stream;
  if (are_standard_output || is_one_file) {
    throw Error(
        ErrorCode::usage,
        fmt::format("--stats and --input-note both name {}; name two files", arguments.input_note));
  }
}

/// Returns the request for the note. Only an older note, which says whose it is, or a file that
/// --force may replace, is replaced; that is checked before the build, and after it.
storage::OutputRequest note_request(const BuildArguments& arguments, const config::Config& config,
                                    storage::FileSystem& files) {
  storage::OutputRequest request = output_request(arguments.input_note, arguments, config);
  request.is_own_name = request.path == pipeline::input_note_path(config, files);
  const std::filesystem::path place = pipeline::followed_note(config, request.path, files);
  const storage::FileKind kind = files.kind(place);
  const bool is_other = kind != storage::FileKind::none || files.is_link(place);
  if (kind != storage::FileKind::regular && !(request.is_own_name && is_other))
    return request;
  storage::require_apart(files, place, request.inputs);
  request.replace = request.replace || storage::find_input_note(files, place).has_value();
  if (!request.replace) {
    throw Error(ErrorCode::exists, arguments.input_note + " is already there, and is no note of " +
                                       "a build; --force replaces it");
  }
  return request;
}

}  // namespace

BuildFiles::BuildFiles(const BuildArguments& arguments, const config::Config& config,
                       const Environment& environment)
    : arguments_(arguments), config_(config), environment_(environment) {
  require_two_files(arguments, environment.files);
}

void BuildFiles::begin() {
  if (!arguments_.stats.empty()) {
    stats_.emplace(environment_.files, stats_request(arguments_, config_, environment_.files),
                   [this] { environment_.cancel.check(); });
  }
  if (!arguments_.input_note.empty())
    note_request(arguments_, config_, environment_.files);
}

std::vector<std::filesystem::path> BuildFiles::paths() const {
  std::vector<std::filesystem::path> paths;
  for (const std::string& path : {arguments_.stats, arguments_.input_note}) {
    if (!path.empty() && path != storage::kStandardOutput)
      paths.emplace_back(path);
  }
  return paths;
}

void BuildFiles::write(const pipeline::BuildReport& report) {
  if (stats_) {
    const std::string text = pretty_json(to_json(report.stats));
    stats_->publish(std::as_bytes(std::span(text)));
  }
  if (!arguments_.input_note.empty()) {
    const std::string text = to_json_text(report.input);
    storage::OutputFile(environment_.files, note_request(arguments_, config_, environment_.files))
        .publish(std::as_bytes(std::span(text)));
  }
}

std::ostream& BuildFiles::text_stream() const {
  return stats_ ? account_stream(environment_, arguments_.stats) : environment_.out;
}

}  // namespace meshhier::app
