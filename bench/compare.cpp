// meshhier_compare: how kd-tree, octree and k-means divide real meshes, and what simplification
// makes of their cells.
#include "bench/comparison.h"
#include "bench/program.h"
#include "hierarchy/error.h"
#include "mesh_io/mesh_source.h"

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

using namespace meshhier;

struct Arguments {
  std::vector<std::string> inputs;
  bench::ComparisonOptions options;
};

void add_options(CLI::App& app, Arguments& arguments) {
  bench::ComparisonOptions& options = arguments.options;
  app.add_option("inputs", arguments.inputs, "PLY files")->required();
  app.add_option("--parts", options.parts, "How many partitions")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--cell-vertices", options.cell_vertices,
                 "Vertices that become one in the simplified meshes, on average, 1 or more")
      ->check(CLI::Range(1.0, static_cast<double>(UINT32_MAX)))
      ->capture_default_str();
  app.add_option("--iterations", options.kmeans_iterations, "Of k-means, at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--samples", options.samples, "Of a distance, in each direction")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

/// Prints each comparison as soon as it is there.
void run(const Arguments& arguments) {
  const auto files = storage::make_posix_file_system();
  for (const std::string& input : arguments.inputs) {
    try {
      const auto source = mesh_io::open_mesh(*files, input);
      const bench::PlainMesh mesh = bench::plain_mesh(bench::load_mesh(*source));
      fmt::print("{}\n", bench::markdown(std::filesystem::path(input).stem().string(),
                                         bench::compare(mesh, arguments.options, *files)));
    } catch (const Error& error) {
      throw error.within(input);
    }
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Compares kd-tree, octree and k-means: sizes, compactness and time of the partitions, and "
      "the "
      "distance to meshes in which every cell is one vertex");
  Arguments arguments;
  add_options(app, arguments);
  return bench::run_program("meshhier_compare", app, argc, argv, [&] { run(arguments); });
}
