#include "import/input_files.h"

#include "hierarchy/error.h"
#include "storage/io/file_checksum.h"
#include "storage/io/hash.h"

#include <array>
#include <bit>
#include <span>

namespace meshhier::importing {

InputFiles::InputFiles(storage::FileSystem& files, const mesh_io::InputPaths& paths, bool weld)
    : files_(files), weld_(weld) {
  for (const std::filesystem::path& path : paths) {
    if (files.is_directory(path)) {
      throw Error(ErrorCode::io,
                  path.string() + " is a folder; name the mesh in it (PLY, OBJ, STL or OFF)");
    }
    all_.push_back({path, mesh_io::detect_format(*files.open(path)), files.identity(path)});
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
  for (const InputFileFacts& file : all_)
    bytes += file.identity.bytes;
  return bytes;
}

std::int64_t InputFiles::times() const {
  std::vector<std::int64_t> times;
  for (const InputFileFacts& file : all_)
    times.insert(times.end(), {file.identity.modified_ns, file.identity.changed_ns});
  return std::bit_cast<std::int64_t>(storage::checksum(std::as_bytes(std::span(times))));
}

void InputFiles::check_unchanged() const {
  for (const InputFileFacts& file : all_) {
    if (files_.identity(file.path) != file.identity) {
      throw Error(ErrorCode::input,
                  file.path.string() + " was changed while it was read; build it again");
    }
  }
}

std::uint64_t InputFiles::checksum(const execution::CancelToken& cancel) const {
  std::vector<std::uint64_t> checksums;
  for (const InputFileFacts& input : all_) {
    const auto file = files_.open(input.path);
    checksums.push_back(
        storage::FileChecksum(file->size()).complete(*file, [&] { cancel.check(); }));
  }
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
