// meshgen: makes meshes for tests and measurements.
#include "bench/city.h"
#include "bench/generator.h"
#include "bench/program.h"
#include "bench/split.h"
#include "bench/stress.h"
#include "bench/textured_files.h"

#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

using namespace meshhier;

struct Arguments {
  bench::SurfaceOptions surface;
  bench::AtlasOptions atlas;
  bench::TexturedFileOptions textured;
  bench::AmplifyOptions amplify;
  bench::CityOptions city;
  std::string stress_case;
  std::uint64_t stress_size = 100'000;
  std::string split_case;
  double split_degrees = 40;
  std::uint64_t seed = 1;
  std::string input;
  std::string output;
  bool force = false;
};

void add_shape(CLI::App* command, bench::SurfaceOptions& options) {
  const std::map<std::string, std::uint64_t> units{
      {"k", 1'000}, {"m", 1'000'000}, {"g", 1'000'000'000}};
  command->add_option("--triangles", options.triangles, "How many, at least; k, M or G may follow")
      ->transform(CLI::AsNumberWithUnit(units, CLI::AsNumberWithUnit::CASE_INSENSITIVE))
      ->required();
  const auto set_shape = [&options](const std::string& name) {
    options.shape = bench::shape_named(name).value_or(options.shape);
  };
  command->add_option_function<std::string>("--shape", set_shape, "The form below the relief")
      ->check(CLI::IsMember({"sphere", "torus", "genus5", "shells"}))
      ->default_str("sphere");
  command
      ->add_option("--height", options.height,
                   "Of the relief, at most, in parts of half the shape's thickness, 0 to 0.9")
      ->capture_default_str();
  command
      ->add_option("--roughness", options.roughness,
                   "Height of each finer octave relative to the one before, 0 to 0.9")
      ->capture_default_str();
  command->add_option("--noise", options.noise, "Measurement noise in grid steps, 0 to 1")
      ->capture_default_str();
  command->add_flag("--double", options.double_coordinates, "With double coordinates");
  command
      ->add_option_function<std::vector<double>>(
          "--offset",
          [&options](const std::vector<double>& xyz) {
            options.offset = {xyz[0], xyz[1], xyz[2]};
          },
          "Added to every position: X Y Z")
      ->expected(3);
}

void add_surface(CLI::App& app, Arguments& arguments) {
  bench::SurfaceOptions& options = arguments.surface;
  CLI::App* command = app.add_subcommand("surface", "A closed surface with fractal relief");
  add_shape(command, options);
  command->add_flag("--normals", options.normals, "With a normal a vertex");
  command->add_flag("--colours", options.colours, "With red, green and blue a vertex");
  command->add_flag("--alpha", options.alpha, "With a fourth colour channel");
}

void add_textured(CLI::App& app, Arguments& arguments) {
  bench::AtlasOptions& atlas = arguments.atlas;
  bench::TexturedFileOptions& options = arguments.textured;
  CLI::App* command = app.add_subcommand(
      "textured", "Such a surface with texture charts, scattered over pictures beside the mesh");
  add_shape(command, arguments.surface);
  command->add_option("--images", atlas.images, "Pictures, 1 to 10000")->capture_default_str();
  command->add_option("--side", atlas.side, "Of a picture, texels, 64 to 65500")
      ->capture_default_str();
  command->add_option("--charts", atlas.charts, "Of a picture, about, 1 to 65536")
      ->capture_default_str();
  command
      ->add_option("--gutter", atlas.gutter,
                   "Texels around a chart that have the colour of its border, 0 to 64")
      ->capture_default_str();
  command
      ->add_option_function<std::string>(
          "--format",
          [&options](const std::string& name) {
            options.mesh = name == "ply" ? bench::MeshFileFormat::ply : bench::MeshFileFormat::obj;
          },
          "obj, with a material library, or ply, as MeshLab writes it")
      ->check(CLI::IsMember({"obj", "ply"}))
      ->default_str("obj");
  command
      ->add_option_function<std::string>(
          "--image-format",
          [&options](const std::string& name) {
            options.image = name == "png" ? ImageFormat::png : ImageFormat::jpeg;
          },
          "Of the pictures")
      ->check(CLI::IsMember({"jpeg", "png"}))
      ->default_str("jpeg");
  command->add_option("--quality", options.quality, "Of JPEG, 1 to 100")->capture_default_str();
}

void add_amplify(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand("amplify", "Repeated 1:4 subdivision with displacement");
  command->add_option("input", arguments.input, "A PLY file")->required();
  command->add_option("--times", arguments.amplify.times, "Subdivision steps, 0 to 10")->required();
  command
      ->add_option("--displacement", arguments.amplify.displacement,
                   "Of a midpoint along the normal, at most, in parts of its edge, 0 to 1")
      ->capture_default_str();
}

void add_shuffle(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand("shuffle", "Vertices and faces in random order");
  command->add_option("input", arguments.input, "A PLY file")->required();
}

/// "name what" lines, for a footer.
template <class Cases>
std::string listing(const Cases& cases) {
  std::string text = "The cases:";
  for (const auto& listed : cases)
    text += fmt::format("\n  {:<12} {}", listed.name, listed.what);
  return text;
}

template <class Cases>
std::vector<std::string> names_of(const Cases& cases) {
  std::vector<std::string> names;
  for (const auto& listed : cases)
    names.emplace_back(listed.name);
  return names;
}

void add_split(CLI::App& app, Arguments& arguments) {
  CLI::App* command =
      app.add_subcommand("split", "The same surface with vertices split by their attributes");
  command->add_option("input", arguments.input, "A PLY file")->required();
  command->add_option("--by", arguments.split_case, "What splits them")
      ->check(CLI::IsMember(names_of(bench::split_cases())))
      ->required();
  command->add_option("--degrees", arguments.split_degrees, "What bends more is a hard edge")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  command->footer(listing(bench::split_cases()));
}

void add_stress(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand("stress", "Legal and unreasonable meshes");
  command->add_option("--case", arguments.stress_case, "Which one")
      ->check(CLI::IsMember(names_of(bench::stress_cases())))
      ->required();
  command->add_option("--size", arguments.stress_size, "About so many triangles, or else vertices")
      ->capture_default_str();
  command->footer(listing(bench::stress_cases()));
}

void add_city(CLI::App& app, Arguments& arguments) {
  CLI::App* command =
      app.add_subcommand("city", "Boxes, an object each, as OBJ, and a table of them as CSV");
  command->add_option("--buildings", arguments.city.buildings, "1 to 2^24")->capture_default_str();
}

bench::LoadedMesh load(storage::FileSystem& files, const std::string& path) {
  return bench::load_mesh(*mesh_io::open_mesh(files, path));
}

std::unique_ptr<bench::GeneratedMesh> generate(const CLI::App& app, Arguments& arguments,
                                               storage::FileSystem& files) {
  if (app.got_subcommand("surface")) {
    arguments.surface.seed = arguments.seed;
    return bench::make_surface(arguments.surface);
  }
  if (app.got_subcommand("amplify")) {
    arguments.amplify.seed = arguments.seed;
    return bench::amplify(load(files, arguments.input), arguments.amplify);
  }
  if (app.got_subcommand("split")) {
    return bench::as_generated(
        bench::split(load(files, arguments.input), arguments.split_case, arguments.split_degrees));
  }
  if (app.got_subcommand("stress")) {
    return bench::as_generated(
        bench::make_stress(arguments.stress_case, arguments.stress_size, arguments.seed));
  }
  return bench::shuffle(load(files, arguments.input), arguments.seed);
}

void run_textured(storage::FileSystem& files, Arguments& arguments) {
  arguments.surface.seed = arguments.atlas.seed = arguments.seed;
  const bench::TexturedScan surface({arguments.surface, arguments.atlas});
  const bench::TexturedFileSizes sizes = bench::write_textured(
      files, {arguments.output, arguments.force, {}}, surface, arguments.textured);
  const bench::ChartAtlas& atlas = surface.atlas();
  fmt::print("{}: {} vertices, {} triangles, {} bytes\n", arguments.output,
             surface.grid().vertex_count(), surface.grid().triangle_count(), sizes.mesh_bytes);
  fmt::print("{} pictures of {} x {} texels, {} charts of {} x {}, {} bytes\n",
             atlas.options().images, atlas.options().side, atlas.options().side,
             atlas.chart_count(), atlas.chart_side(), atlas.chart_side(), sizes.image_bytes);
}

void run_city(storage::FileSystem& files, Arguments& arguments) {
  arguments.city.seed = arguments.seed;
  const bench::CitySizes sizes =
      bench::write_city(files, {arguments.output, arguments.force, {}}, arguments.city);
  fmt::print("{}: {} buildings, {} bytes; a table of {} bytes\n", arguments.output,
             arguments.city.buildings, sizes.mesh_bytes, sizes.table_bytes);
}

void run(const CLI::App& app, Arguments& arguments) {
  const auto files = storage::make_posix_file_system();
  if (app.got_subcommand("city")) {
    run_city(*files, arguments);
    return;
  }
  if (app.got_subcommand("textured")) {
    run_textured(*files, arguments);
    return;
  }
  const auto mesh = generate(app, arguments, *files);
  storage::OutputRequest request{arguments.output, arguments.force, {}};
  if (!arguments.input.empty())
    request.inputs.emplace_back(arguments.input);
  const bool is_taken = storage::is_standard_output(*files, arguments.output);
  const std::uint64_t bytes = bench::write_ply(*files, request, *mesh);
  fmt::print(is_taken ? stderr : stdout, "{}: {} vertices, {} triangles, {} bytes\n",
             arguments.output, mesh->content().vertex_count, mesh->content().triangle_count, bytes);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Makes meshes for tests and measurements; equal arguments give equal bytes");
  Arguments arguments;
  add_surface(app, arguments);
  add_textured(app, arguments);
  add_amplify(app, arguments);
  add_shuffle(app, arguments);
  add_split(app, arguments);
  add_stress(app, arguments);
  add_city(app, arguments);
  app.require_subcommand(1);
  for (CLI::App* command : app.get_subcommands({})) {
    command->add_option("--seed", arguments.seed, "Another seed, another mesh")
        ->capture_default_str();
    command
        ->add_option("-o,--output", arguments.output,
                     command->get_name() == "textured"
                         ? "The mesh to write; materials and pictures go beside it"
                     : command->get_name() == "city" ? "The OBJ to write; the table goes beside it"
                                                     : "The PLY to write; \"-\" is standard output")
        ->required();
    command->add_flag("--force", arguments.force, "Replace existing files");
  }
  return bench::run_program("meshgen", app, argc, argv, [&] { run(app, arguments); });
}
