// meshhier_compare: how kd-tree, octree and k-means divide real meshes, and what simplification
// makes of their cells; how the shading of a hierarchy's levels differs from the original's.
#include "bench/comparison.h"
#include "bench/program.h"
#include "bench/shading_comparison.h"
#include "hierarchy/error.h"
#include "mesh_io/mesh_source.h"
#include "render/camera.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/output_file.h"

#include <cstdio>
#include <filesystem>
#include <functional>
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

struct ShadingArguments {
  std::filesystem::path hierarchy;
  std::string level = "all";
  bench::ShadingOptions options;
  bool json = false;
  std::filesystem::path pictures;  ///< a directory; empty: none are kept
};

void add_options(CLI::App& app, Arguments& arguments) {
  bench::ComparisonOptions& options = arguments.options;
  app.add_option("inputs", arguments.inputs, "PLY files");
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

CLI::App* add_shading(CLI::App& app, ShadingArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "shading",
      "Compares pictures of a hierarchy's levels with those of its partitions: the mean "
      "angle between normals, and the difference of luminance");
  command->add_option("hierarchy", arguments.hierarchy, "A hierarchy")->required();
  command->add_option("--level", arguments.level, "One level, or \"all\"")
      ->check(CLI::IsMember({"all"}) | CLI::Range(0, 255))
      ->capture_default_str();
  command->add_option("--size", arguments.options.size, "Of a picture, pixels")
      ->check(CLI::Range(1U, render::kMostPixels))
      ->capture_default_str();
  command->add_option("--views", arguments.options.views, "How many, from all around")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--json", arguments.json, "One JSON object, for programs");
  command->add_option("-o,--output", arguments.pictures, "A directory for the pictures, PNG files");
  return command;
}

/// Prints each comparison as soon as it is there.
void run(const Arguments& arguments) {
  if (arguments.inputs.empty())
    throw CLI::RequiredError("inputs");
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

using PictureSink = std::function<void(const bench::NamedPicture&)>;

/// Writes pictures into the directory asked for; none if there is none.
PictureSink sink_for(storage::FileSystem& files, const ShadingArguments& arguments) {
  if (arguments.pictures.empty())
    return {};
  const std::vector<std::filesystem::path> inputs{arguments.hierarchy};
  storage::require_apart(files, arguments.pictures, inputs);
  files.make_directories(arguments.pictures);
  return [&files, &arguments](const bench::NamedPicture& picture) {
    storage::OutputFile output(files, {arguments.pictures / picture.name, true});
    output.publish(picture.png);
  };
}

void run_shading(const ShadingArguments& arguments) {
  const auto files = storage::make_posix_file_system();
  const storage::HierarchyFiles place(*files, arguments.hierarchy);
  const storage::HierarchyReader reader(place.files(), arguments.hierarchy);
  bench::ShadingOptions options = arguments.options;
  if (arguments.level != "all")
    options.level = static_cast<Level>(std::stoi(arguments.level));
  const bench::ShadingComparison comparison =
      bench::compare_shading(reader, options, sink_for(*files, arguments));
  const std::string name = arguments.hierarchy.filename().string();
  fmt::print("{}", arguments.json ? bench::json_text(name, comparison)
                                  : bench::markdown(name, comparison));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Compares kd-tree, octree and k-means: sizes, compactness and time of the partitions, and "
      "the distance to meshes in which every cell is one vertex");
  Arguments arguments;
  add_options(app, arguments);
  ShadingArguments shading;
  const CLI::App* shading_command = add_shading(app, shading);
  return bench::run_program("meshhier_compare", app, argc, argv, [&] {
    if (shading_command->parsed())
      run_shading(shading);
    else
      run(arguments);
  });
}
