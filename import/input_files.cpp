#include "import/input_files.h"

#include "hierarchy/error.h"
#include "mesh_io/gltf_buffer_files.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/ply_header.h"
#include "mesh_io/ply_source.h"
#include "storage/io/file_checksum.h"
#include "storage/io/hash.h"

#include <array>
#include <bit>
#include <span>

namespace meshhier::importing {

namespace {

bool names_textures(const storage::File& file, const mesh_io::MeshFormat& format) {
  if (format.kind != mesh_io::MeshKind::ply)
    return false;
  std::string start(mesh_io::kMaxHeaderBytes, '\0');
  const auto stream = mesh_io::open_stream({file, file.size()}, {});
  start.resize(stream->read(std::as_writable_bytes(std::span(start))));
  return mesh_io::ply_names_textures(start, file.path());
}

}  // namespace

InputFiles::InputFiles(storage::FileSystem& files, const mesh_io::InputPaths& paths, bool weld,
                       Textures textures)
    : files_(files), weld_(weld), textures_(textures) {
  for (const std::filesystem::path& path : paths) {
    if (files.is_directory(path)) {
      throw Error(ErrorCode::io, path.string() +
                                     " is a folder; name the mesh in it (PLY, OBJ, glTF, STL "
                                     "or OFF)");
    }
    const auto file = files.open(path);
    const mesh_io::MeshFormat format = mesh_io::detect_format(*file);
    InputFileFacts facts{path, format, files.identity(path)};
    facts.names_textures = textures == Textures::use && names_textures(*file, format);
    all_.push_back(std::move(facts));
    find_companions(all_.back(), *file);
  }
}

void InputFiles::find_companions(InputFileFacts& file, const storage::File& content) const {
  if (file.format.kind != mesh_io::MeshKind::gltf && file.format.kind != mesh_io::MeshKind::glb)
    return;
  for (const std::filesystem::path& path : mesh_io::gltf_buffer_files(content)) {
    if (files_.kind(path) == storage::FileKind::regular)
      file.companions.push_back({path, files_.identity(path)});
  }
}

std::string InputFiles::name() const {
  std::string name;
  for (const InputFileFacts& file : all_) {
    name += name.empty() ? "" : ", ";
    name += file.path.filename().string();
  }
  return name;
}

std::string InputFiles::imported_name() const {
  if (is_unpacked_only())
    return all_[0].unpacked_name();
  mesh_io::InputPaths paths;
  for (const InputFileFacts& file : all_)
    paths.push_back(file.path);
  return paths.string() + " (imported)";
}

std::uint64_t InputFiles::bytes() const {
  std::uint64_t bytes = 0;
  for_each_file([&](const auto&, const storage::FileIdentity& file) { bytes += file.bytes; });
  return bytes;
}

std::int64_t InputFiles::times() const {
  std::vector<std::int64_t> times;
  for_each_file([&](const auto&, const storage::FileIdentity& file) {
    times.insert(times.end(), {file.modified_ns, file.changed_ns});
  });
  return std::bit_cast<std::int64_t>(storage::checksum(std::as_bytes(std::span(times))));
}

void InputFiles::check_unchanged() const {
  for_each_file([&](const std::filesystem::path& path, const storage::FileIdentity& identity) {
    if (files_.identity(path) != identity) {
      throw Error(ErrorCode::input,
                  path.string() + " was changed while it was read; build it again");
    }
  });
}

std::uint64_t InputFiles::checksum(const execution::CancelToken& cancel) const {
  std::vector<std::uint64_t> checksums;
  for_each_file([&](const std::filesystem::path& path, const auto&) {
    const auto file = files_.open(path);
    checksums.push_back(
        storage::FileChecksum(file->size()).complete(*file, [&] { cancel.check(); }));
  });
  return joined_checksum(checksums);
}

std::uint64_t joined_checksum(const std::vector<std::uint64_t>& checksums) {
  if (checksums.size() == 1)
    return checksums[0];
  storage::Checksum sum;
  for (std::uint64_t checksum : checksums) {
    std::array<std::byte, 8> bytes{};
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(checksum);
      checksum >>= 8;
    }
    sum.add(bytes);
  }
  return sum.value();
}

}  // namespace meshhier::importing
