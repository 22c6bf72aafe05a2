#include "app/compared_hierarchy.h"

#include "config/named_files.h"
#include "pipeline/build.h"

#include <random>
#include <system_error>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

/// Nothing but the name depends on chance.
std::filesystem::path temporary_folder() {
  std::random_device chance;
  return std::filesystem::temp_directory_path() /
         fmt::format("meshhier-compared-{:08x}{:08x}", chance(), chance());
}

std::filesystem::path built_path(const std::filesystem::path& folder) {
  return folder / "mesh.hier";
}

}  // namespace

ComparedHierarchy::ComparedHierarchy(Environment& environment, const std::string& name,
                                     const WebOptions& web, std::uint64_t memory_budget,
                                     execution::Progress& progress)
    : environment_(environment), given_(environment, name, web) {
  if (given_.is_remote() || inspection::is_hierarchy_there(given_.files(), given_.path()))
    return;
  folder_ = temporary_folder();
  std::filesystem::create_directory(*folder_);
  try {
    build(name, memory_budget, progress);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove_all(*folder_, ignored);
    throw;
  }
}

void ComparedHierarchy::build(const std::string& mesh, std::uint64_t memory_budget,
                              execution::Progress& progress) {
  config::CommandLine words({fmt::format("memory_budget={}", memory_budget)});
  words.output = built_path(*folder_);
  const config::Config config = config::load_named(environment_.files, {mesh}, std::move(words));
  pipeline::BuildOptions options;
  options.leaves_work = false;  // nobody could go on with it
  pipeline::build_hierarchy(config, options, {environment_.files, progress, environment_.cancel});
}

ComparedHierarchy::~ComparedHierarchy() {
  std::error_code ignored;
  if (folder_)
    std::filesystem::remove_all(*folder_, ignored);
}

inspection::ComparedPlace ComparedHierarchy::place() const {
  if (folder_)
    return {environment_.files, built_path(*folder_), given_.path().string()};
  return {given_.files(), given_.path()};
}

}  // namespace meshhier::app
