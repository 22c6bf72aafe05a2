// meshhier_scale: how time, memory and disk grow with the mesh, as markdown tables.
#include "bench/child_process.h"
#include "bench/program.h"
#include "bench/scale_run.h"
#include "execution/size_text.h"
#include "hierarchy/error.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

using namespace meshhier;

struct Arguments {
  bench::ScaleOptions options;
  std::vector<std::string> budgets{"512MiB", "128MiB", "256MiB", "1GiB", "4GiB"};
};

void add_counts(CLI::App& app, bench::ScaleOptions& options) {
  const std::map<std::string, std::uint64_t> units{
      {"k", 1'000}, {"m", 1'000'000}, {"g", 1'000'000'000}};
  const auto add = [&](const char* name, std::uint64_t& count, const char* help) {
    app.add_option(name, count, help)
        ->transform(CLI::AsNumberWithUnit(units, CLI::AsNumberWithUnit::CASE_INSENSITIVE))
        ->capture_default_str()
        ->type_name("TRIANGLES");
  };
  add("--largest", options.largest, "The largest mesh; k, M or G may follow");
  add("--smallest", options.smallest, "The smallest mesh");
  add("--largest-shuffled", options.largest_shuffled, "The largest mesh that is also shuffled");
  add("--compare-at", options.usual_largest,
      "Threads and methods are compared at the largest size up to this");
}

void add_options(CLI::App& app, Arguments& arguments) {
  bench::ScaleOptions& options = arguments.options;
  add_counts(app, options);
  app.add_option("--base", options.base, "A PLY file to amplify; without it a torus is made");
  app.add_option("--work", options.work, "A directory for all that is written, removed at the end")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Numbers of threads; the last is the usual one")
      ->delimiter(',')
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--budgets", arguments.budgets, "Memory budgets; the first is the usual one")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--methods", options.methods, "Of contraction; the first is the usual one")
      ->delimiter(',')
      ->check(CLI::IsMember({"edge_collapse", "half_edge", "cluster"}))
      ->capture_default_str();
  app.add_option("--repeat", options.repeat, "Builds of each kind; the fastest counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--meshhier", options.meshhier, "The program that is measured");
  app.add_option("--meshgen", options.meshgen, "The program that makes meshes");
}

void set_budgets(Arguments& arguments) {
  for (const std::string& text : arguments.budgets) {
    const std::optional<std::uint64_t> bytes = execution::parse_size(text);
    if (!bytes || *bytes == 0) {
      throw Error(ErrorCode::usage, fmt::format("--budgets: expected {}, found \"{}\"",
                                                execution::kSizeSyntax, text));
    }
    arguments.options.budgets.push_back(*bytes);
  }
}

void run(Arguments& arguments) {
  set_budgets(arguments);
  bench::leave_interrupts_to_children();
  const auto files = storage::make_posix_file_system();
  const auto tell = [](std::string_view line) { fmt::print(stderr, "scale: {}\n", line); };
  fmt::print("{}", scale_tables(run_scale(*files, arguments.options, tell)));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Builds meshes of growing size in many ways, and prints what it took as tables");
  Arguments arguments;
  const std::filesystem::path programs = std::filesystem::path(argv[0]).parent_path();
  arguments.options.meshhier = programs / "meshhier";
  arguments.options.meshgen = programs / "meshgen";
  arguments.options.work = std::filesystem::temp_directory_path();
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  arguments.options.threads =
      cores > 1 ? std::vector<unsigned>{1, cores} : std::vector<unsigned>{1};
  add_options(app, arguments);
  return bench::run_program("meshhier_scale", app, argc, argv, [&] { run(arguments); });
}
