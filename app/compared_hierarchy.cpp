#include "app/compared_hierarchy.h"

#include "base/error.h"
#include "config/named_files.h"
#include "pipeline/build.h"

#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace meshhier::app {
ComparedHierarchy::BuiltFolder::BuiltFolder() : path_(temporary_path("meshhier-compared-")) {
  std::error_code error;
  if (!std::filesystem::create_directory(path_, error)) {
    throw Error(ErrorCode::io, fmt::format("cannot make a directory for temporary files in {}: {}; "
                                           "set TMPDIR to another place",
                                           path_.parent_path().string(), error.message()));
  }
}

ComparedHierarchy::BuiltFolder::~BuiltFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

ComparedHierarchy::ComparedHierarchy(Environment& environment, const std::string& name,
                                     const WebOptions& web, std::uint64_t memory_budget,
                                     execution::Progress& progress)
    : environment_(environment), given_(environment, name, web), read_{given_.path()} {
  if (given_.is_remote() || comparing::is_hierarchy_there(given_.files(), given_.path()))
    return;
  folder_.emplace();
  build(name, memory_budget, progress);
}

void ComparedHierarchy::build(const std::string& mesh, std::uint64_t memory_budget,
                              execution::Progress& progress) {
  config::CommandLine words({fmt::format("memory_budget={}", memory_budget)});
  words.output = folder_->hierarchy();
  const config::Config config = config::load_named(environment_.files, {mesh}, std::move(words));
  const std::vector<std::filesystem::path> named = config::read_by(config);
  read_.insert(read_.end(), named.begin(), named.end());
  pipeline::BuildOptions options;
  options.leaves_work = false;  // nobody could go on with it
  const pipeline::BuildReport report = pipeline::build_hierarchy(
      config, options, {environment_.files, progress, environment_.cancel});
  for (const storage::NotedFile& file : report.input.files)
    read_.push_back(config.input.front().parent_path() / file.path);
}

comparing::ComparedPlace ComparedHierarchy::place() const {
  if (folder_)
    return {environment_.files, folder_->hierarchy(), given_.path().string()};
  return {given_.files(), given_.path()};
}

}  // namespace meshhier::app
