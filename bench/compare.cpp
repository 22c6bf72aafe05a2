// meshhier_compare: how the shading and the textures of a hierarchy's levels differ from the
// original's.
#include "bench/program.h"
#include "bench/shading_comparison.h"
#include "bench/texture_comparison.h"
#include "bench/textured_mesh.h"
#include "render/camera.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/output_file.h"
#include "storage/io/process.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

using namespace meshhier;

struct ShadingArguments {
  std::filesystem::path hierarchy;
  std::string level = "all";
  bench::ShadingOptions options;
  bool json = false;
  std::filesystem::path pictures;  ///< a directory; empty: none are kept
};

struct TextureArguments {
  std::filesystem::path hierarchy;
  std::vector<std::filesystem::path> input;
  std::string level = "all";
  bench::TextureOptions options;
  bool json = false;
  std::filesystem::path pictures;  ///< a directory; empty: none are kept
};

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

void add_textures(CLI::App& app, TextureArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "textures",
      "Compares pictures of a textured hierarchy's levels with those of its input, seen from where "
      "a level's error is one pixel: the peak signal-to-noise ratio");
  command->add_option("hierarchy", arguments.hierarchy, "A hierarchy")->required();
  command->add_option("input", arguments.input, "What it was built of")->required();
  command->add_option("--level", arguments.level, "One level, or \"all\"")
      ->check(CLI::IsMember({"all"}) | CLI::Range(0, 255))
      ->capture_default_str();
  command
      ->add_option("--size", arguments.options.size,
                   "Of a picture, pixels at most; of a larger one the middle is compared")
      ->check(CLI::Range(1U, 2048U))
      ->capture_default_str();
  command->add_option("--views", arguments.options.views, "How many, from all around")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--json", arguments.json, "One JSON object, for programs");
  command->add_option("--pictures", arguments.pictures,
                      "A directory for PNG files: input and level side by side");
}

using PictureSink = std::function<void(const bench::NamedPicture&)>;

/// Writes pictures into a directory; none if its path is empty.
PictureSink sink_for(storage::FileSystem& files, const std::filesystem::path& pictures,
                     const std::vector<std::filesystem::path>& inputs) {
  if (pictures.empty())
    return {};
  storage::require_apart(files, pictures, inputs);
  files.make_directories(pictures);
  return [&files, pictures](const bench::NamedPicture& picture) {
    storage::OutputFile output(files, {pictures / picture.name, true});
    output.publish(picture.png);
  };
}

std::optional<Level> level_of(const std::string& text) {
  if (text == "all")
    return std::nullopt;
  return static_cast<Level>(std::stoi(text));
}

void run_shading(const ShadingArguments& arguments) {
  const auto files = storage::make_posix_file_system();
  const storage::HierarchyFiles place(*files, arguments.hierarchy);
  const storage::HierarchyReader reader(place.files(), arguments.hierarchy);
  bench::ShadingOptions options = arguments.options;
  options.level = level_of(arguments.level);
  const bench::ShadingComparison comparison = bench::compare_shading(
      reader, options, sink_for(*files, arguments.pictures, {arguments.hierarchy}));
  const std::string name = arguments.hierarchy.filename().string();
  fmt::print("{}", arguments.json ? bench::json_text(name, comparison)
                                  : bench::markdown(name, comparison));
}

/// A directory for temporary files, while it is there.
class Scratch {
 public:
  Scratch() : path_(storage::make_temporary_directory()) {}
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

bench::TexturedMesh load_input(storage::FileSystem& files, const TextureArguments& arguments,
                               Vec3d origin) {
  const Scratch scratch;
  mesh_io::InputPaths paths;
  paths.assign(arguments.input.begin(), arguments.input.end());
  return bench::load_textured_mesh(files, paths, scratch.path(), origin);
}

void run_textures(const TextureArguments& arguments) {
  const auto files = storage::make_posix_file_system();
  const storage::HierarchyFiles place(*files, arguments.hierarchy);
  const storage::HierarchyReader reader(place.files(), arguments.hierarchy);
  bench::TextureOptions options = arguments.options;
  options.level = level_of(arguments.level);
  std::vector<std::filesystem::path> inputs = arguments.input;
  inputs.push_back(arguments.hierarchy);
  const PictureSink sink = sink_for(*files, arguments.pictures, inputs);
  const bench::TexturedMesh input = load_input(*files, arguments, reader.manifest().origin);
  const bench::TextureComparison comparison = bench::compare_textures(reader, input, options, sink);
  const std::string name = arguments.hierarchy.filename().string();
  fmt::print("{}", arguments.json ? bench::json_text(name, comparison)
                                  : bench::markdown(name, comparison));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares pictures of a hierarchy's levels with pictures of the original");
  app.require_subcommand(1);
  ShadingArguments shading;
  const CLI::App* shading_command = add_shading(app, shading);
  TextureArguments textures;
  add_textures(app, textures);
  return bench::run_program("meshhier_compare", app, argc, argv, [&] {
    if (shading_command->parsed())
      run_shading(shading);
    else
      run_textures(textures);
  });
}
