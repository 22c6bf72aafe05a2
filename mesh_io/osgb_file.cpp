#include "mesh_io/osgb_file.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/osgb/protocol.h"
#include "storage/io/little_endian.h"
#include "storage/io/own_program.h"
#include "storage/io/worker_pool.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr const char* kProgram = "meshhier_osgb";
constexpr const char* kPlaceVariable = "MESHHIER_OSGB";
constexpr std::array kPlaces{".", "../libexec/meshhier", "../lib/meshhier"};

/// The longest name of a file that is looked at: more no system takes.
constexpr std::size_t kLongestOsgbName = 4096;
constexpr std::size_t kLongestReason = 300;
constexpr std::uint64_t kMostOsgbBytes = std::uint64_t{1} << 31;
constexpr std::size_t kReadBytes = std::size_t{1} << 20;

storage::CompanionFolder program_folder() {
  return {kPlaceVariable, kPlaces, kProgram};
}

storage::WorkerPool& readers() {
  static storage::WorkerPool pool(
      "the program that reads OSGB", osgb::kProtocol, []() -> std::vector<std::string> {
        if (const std::string missing = missing_for_osgb(); !missing.empty())
          throw Error(ErrorCode::io, missing);
        return {(program_folder().path() / kProgram).string()};
      });
  return pool;
}

/// Takes numbers and texts off an answer, which the program may have made of anything.
class Answer {
 public:
  Answer(std::span<const std::byte> bytes, const std::filesystem::path& path)
      : left_(bytes), path_(path) {}

  std::uint32_t word() { return storage::load_little<std::uint32_t>(take(4).data()); }
  double number() { return storage::load_little<double>(take(8).data()); }
  std::span<const std::byte> take(std::size_t count) {
    if (count > left_.size())
      fail_file(path_, "the program that reads OSGB answers what is no answer: the file is broken");
    const auto taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }
  std::span<const std::byte> rest() const { return left_; }
  /// Returns a count of things of that size, which must be there.
  std::size_t count(std::uint32_t said, std::size_t bytes_each) const {
    if (said > left_.size() / bytes_each)
      fail_file(path_, "the program that reads OSGB answers what is no answer: the file is broken");
    return said;
  }

 private:
  std::span<const std::byte> left_;
  const std::filesystem::path& path_;
};

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

OsgbFiner read_finer(Answer& answer) {
  const std::size_t name = answer.word();
  std::array<double, 16> columns{};
  for (double& number : columns)
    number = answer.number();
  return {name, gltf_matrix(columns)};
}

}  // namespace

std::string missing_for_osgb() {
  const storage::CompanionFolder folder = program_folder();
  if (folder.has(kProgram))
    return "";
  return fmt::format(
      "OSGB is read by the program {}, which is not in {}: install the package meshhier-osgb, or "
      "libopenscenegraph-dev and build meshhier anew; {} names the folder of another one",
      kProgram, folder.path().string(), kPlaceVariable);
}

bool begins_as_osgb(std::string_view start) {
  using namespace std::string_view_literals;
  return start.starts_with("\xA1\x0E\x91\x6C\x45\x45\xFB\x1A"sv);
}

OsgbFile::OsgbFile(const storage::File& file, std::uint64_t most_bytes)
    : path_(file.path()),
      most_bytes_(std::min(most_bytes, kMostOsgbBytes)),
      is_packed_(is_gzip(file)) {
  const auto stream = open_stream({file, file.size()}, {});
  std::size_t count = 0;
  do {
    bytes_.resize(count + kReadBytes);
    const std::size_t more = stream->read(std::span(bytes_).subspan(count));
    count += more;
    if (count > most_bytes_) {
      throw Error(ErrorCode::budget,
                  file_message(path_, fmt::format("has more than {} bytes, which the import has; "
                                                  "give a larger memory_budget",
                                                  most_bytes_)));
    }
  } while (count == bytes_.size());
  bytes_.resize(count);
}

std::vector<std::byte> OsgbFile::ask(std::uint32_t kind, std::span<const std::byte> choice) const {
  std::vector<std::byte> question(choice.begin(), choice.end());
  question.insert(question.end(), bytes_.begin(), bytes_.end());
  const std::array<std::uint32_t, 3> numbers{kind, static_cast<std::uint32_t>(choice.size()),
                                             static_cast<std::uint32_t>(question.size())};
  auto answer = readers().ask(numbers, question, most_bytes_);
  if (!answer)
    fail_file(path_, "is broken: the program that reads OSGB ends while it has it");
  if (!answer->is_good)
    fail_file(path_, plain_text(text_of(answer->bytes), kLongestReason));
  return std::move(answer->bytes);
}

std::vector<std::string> OsgbFile::names() const {
  const std::vector<std::byte> bytes = ask(osgb::kNames, {});
  Answer answer(bytes, path_);
  std::vector<std::string> names(answer.count(answer.word(), 4));
  for (std::string& name : names) {
    const std::size_t length = answer.word();
    name = text_of(answer.take(length));
    if (length > kLongestOsgbName)
      fail_file(path_, fmt::format("names a file by {} bytes", length));
  }
  return names;
}

OsgbTile OsgbFile::tile(std::span<const std::byte> present) const {
  std::vector<std::byte> bytes = ask(osgb::kTile, present);
  Answer answer(bytes, path_);
  constexpr std::size_t kFinerBytes = 4 + 16 * 8;
  const std::uint32_t finer = answer.word();
  OsgbTile tile;
  tile.missing = answer.word();
  tile.others = answer.word();
  tile.unknown = answer.word();
  tile.triangles = answer.word();
  tile.finer.resize(answer.count(finer, kFinerBytes));
  for (OsgbFiner& one : tile.finer) {
    one = read_finer(answer);
    if (one.name >= present.size() || present[one.name] == std::byte{0})
      fail_file(path_, "the program that reads OSGB answers what is no answer: the file is broken");
  }
  bytes.erase(bytes.begin(), bytes.end() - static_cast<std::ptrdiff_t>(answer.rest().size()));
  tile.glb = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  return tile;
}

std::vector<std::byte> OsgbFile::picture(std::span<const std::byte> present,
                                         std::uint64_t offset) const {
  if (offset > UINT32_MAX)
    fail_file(path_, "does not have its picture any more");
  std::vector<std::byte> choice;
  storage::append_little(choice, static_cast<std::uint32_t>(offset));
  choice.insert(choice.end(), present.begin(), present.end());
  return ask(osgb::kPicture, choice);
}

std::uint64_t osgb_reading_bytes(std::uint64_t file_bytes) {
  // The library alone takes 12 MiB. Files of 0.3 to 0.7 MB take six to eight times as much there:
  // as a stream, a scene, a GLB and an answer. Here they lie as a file, a question, an answer.
  constexpr std::uint64_t kProgram = std::uint64_t{12} << 20, kCopies = 12;
  return kProgram + kCopies * file_bytes;
}

void end_osgb_readers() {
  readers().end_idle();
}

}  // namespace meshhier::mesh_io
