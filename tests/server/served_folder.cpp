#include "tests/server/served_folder.h"

#include "pipeline/build.h"
#include "progressive/stream.h"
#include "storage/format/archive.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"

#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>

namespace meshhier::tests {
namespace {

namespace fs = std::filesystem;

void build(const fs::path& mesh, const fs::path& output, storage::Compression compression,
           std::size_t triangles) {
  write_ply(sphere(triangles), mesh);
  const auto files = storage::make_posix_file_system();
  config::Config config = tests::smooth_config();
  config.input = mesh;
  config.output = output;
  config.threads = 1;
  config.partition.vertices = 100;
  config.simplify.method = config::SimplifyMethod::half_edge;
  config.storage.compression = compression;
  if (output.extension() == ".3tz")
    config.storage.container = storage::Container::archive;
  execution::NoProgress progress;
  const execution::CancelToken cancel;
  pipeline::build_hierarchy(config, {.force = true}, {*files, progress, cancel});
}

void fill(const fs::path& root) {
  const fs::path models = root / "models";
  fs::create_directories(models / "sub dir");
  fs::create_directories(root / "meshes");
  build_small(root / "meshes/plain.ply", models / "plain.hier");
  build_small(root / "meshes/zipped.ply", models / "sub dir/zipped.hier",
              storage::Compression::zlib);
  build_small(root / "meshes/packed.ply", models / "packed.3tz",
              storage::Compression::meshopt_zlib);
  const auto files = storage::make_posix_file_system();
  execution::NoProgress progress;
  progressive::ProgressiveOptions options;
  options.output = models / "stream.prog";
  progressive::write_progressive(*files, models / "plain.hier", options, progress,
                                 execution::CancelToken());
  fs::create_directories(models / "broken.hier");
  write_text(models / "broken.hier/hierarchy.json", "{}\n");
  write_text(models / "broken.hier/tiles.bin", "not for you");
  write_text(models / "notes.txt", "not for you");
  write_text(root / "secret.txt", "not for you");
  fs::create_directories(root / "viewer/assets");
  write_text(root / "viewer/index.html", "<!doctype html><title>Models</title>");
  write_text(root / "viewer/assets/page-1a2b.js", "export {};");
}

const fs::path& original() {
  static const TemporaryDirectory directory;
  static const bool is_filled = (fill(directory.path()), true);
  (void)is_filled;
  return directory.path();
}

}  // namespace

void build_small(const fs::path& mesh, const fs::path& output, storage::Compression compression,
                 std::size_t triangles) {
  build(mesh, output, compression, triangles);
}

ServedFolder::ServedFolder() {
  fs::copy(original(), path(), fs::copy_options::recursive);
}

std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  if (!stream.flush())
    throw std::runtime_error("cannot write " + path.string());
}

std::string text_in_archive(const fs::path& archive, const std::string& name) {
  const auto files = storage::make_posix_file_system();
  const storage::Archive opened(files->open(archive));
  const auto place = opened.find(name);
  if (!place)
    throw std::runtime_error(archive.string() + " has no " + name);
  std::string text(place->bytes, '\0');
  opened.file().read_exact(place->offset, std::as_writable_bytes(std::span(text)));
  return text;
}

}  // namespace meshhier::tests
