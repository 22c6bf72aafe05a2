#include "server/input_notes.h"

#include "hierarchy/error.h"
#include "storage/format/layout.h"
#include "storage/format/sealed_json.h"
#include "storage/io/hash.h"
#include "storage/io/output_file.h"

#include <array>
#include <bit>
#include <span>
#include <utility>

namespace meshhier::server {
namespace {

constexpr storage::SealedFormat kFormat{"meshhier-input", 1};

std::uint64_t mark_of(const storage::FileVersion& version) {
  const std::array numbers{version.inode, version.bytes,
                           std::bit_cast<std::uint64_t>(version.modified_ns),
                           std::bit_cast<std::uint64_t>(version.changed_ns)};
  return storage::checksum(std::as_bytes(std::span(numbers)));
}

}  // namespace

InputNotes::InputNotes(storage::FileSystem& files, std::shared_ptr<const storage::Folder> folder)
    : files_(files), folder_(std::move(folder)) {}

std::optional<std::uint64_t> InputNotes::find(const std::string& hierarchy,
                                              const storage::FileVersion& version) const {
  const std::string name = storage::input_note_path(hierarchy).string();
  try {
    const auto file = folder_->open(name);
    if (!file)
      return std::nullopt;
    const auto document = storage::parse_sealed(storage::read_sealed_text(*file), kFormat, name);
    const storage::JsonObject note(document, "", name);
    if (note.hash("file") != mark_of(version))
      return std::nullopt;
    return note.hash("content");
  } catch (const Error&) {
    return std::nullopt;  // the file is read instead
  }
}

void InputNotes::write(const std::string& hierarchy, const storage::FileVersion& version,
                       std::uint64_t checksum) const {
  const std::string text =
      storage::sealed_text(kFormat, {{"file", storage::hex_digits(mark_of(version))},
                                     {"content", storage::hex_digits(checksum)}});
  const std::filesystem::path path = folder_->path() / storage::input_note_path(hierarchy);
  storage::OutputFile(files_, {.path = path, .replace = true})
      .publish(std::as_bytes(std::span(text)));
}

}  // namespace meshhier::server
