#include "storage/format/input_note.h"

#include "base/error.h"
#include "storage/format/sealed_json.h"
#include "storage/io/output_file.h"

#include <cstddef>
#include <span>
#include <string_view>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

/// A hundred thousand pictures make 15 MB.
constexpr SealedFormat kNoteFormat{
    .name = "meshhier-input", .version = 2, .most_bytes = std::size_t{1} << 26};

/// A path may have any bytes, JSON has characters: each byte becomes the one of its number.
std::string bytes_text(const std::filesystem::path& path) {
  std::string text;
  for (const char c : path.string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80)
      text += static_cast<char>(0xC0 | (byte >> 6));
    text += static_cast<char>(byte >= 0x80 ? 0x80 | (byte & 0x3F) : byte);
  }
  return text;
}

std::filesystem::path bytes_path(std::string_view text) {
  std::string path;
  for (std::size_t i = 0; i < text.size(); ++i) {
    auto byte = static_cast<unsigned char>(text[i]);
    if (byte >= 0x80 && i + 1 < text.size())
      byte = static_cast<unsigned char>((byte << 6) | (text[++i] & 0x3F));
    path += static_cast<char>(byte);
  }
  return path;
}

InputNote read_note(const Json& document) {
  InputNote note{.content = document.at("content"), .files = {}, .awaited = {}};
  for (const Json& file : document.at("files")) {
    note.files.push_back({bytes_path(file.at(0).get_ref<const std::string&>()),
                          {file.at(1), file.at(2), file.at(3)},
                          file.at(4)});
  }
  for (const Json& place : document.at("awaited"))
    note.awaited.push_back(bytes_path(place.get_ref<const std::string&>()));
  note.warnings = document.value("warnings", std::vector<std::string>());
  note.build = document.value("build", Json());
  return note;
}

}  // namespace

std::string to_json_text(const InputNote& note) {
  Json files = Json::array(), awaited = Json::array();
  for (const NotedFile& file : note.files) {
    const FileIdentity& identity = file.identity;
    files.push_back({bytes_text(file.path), identity.bytes, identity.modified_ns,
                     identity.changed_ns, file.checksum});
  }
  for (const std::filesystem::path& place : note.awaited)
    awaited.push_back(bytes_text(place));
  Json document{
      {"content", note.content}, {"files", std::move(files)}, {"awaited", std::move(awaited)}};
  if (!note.warnings.empty())
    document["warnings"] = note.warnings;
  if (!note.build.is_null())
    document["build"] = note.build;
  return sealed_text(kNoteFormat, std::move(document));
}

InputNote read_input_note(const File& file, const std::string& name) {
  const Json document =
      parse_sealed(read_sealed_text(file, kNoteFormat.most_bytes), kNoteFormat, name);
  try {
    InputNote note = read_note(document);
    if (note.files.empty())
      throw Error(ErrorCode::corrupt, name + ": names no file");
    return note;
  } catch (const Json::exception&) {
    throw Error(ErrorCode::corrupt, name + ": is no list of files");
  }
}

std::optional<InputNote> find_input_note(FileSystem& files, const std::filesystem::path& path) {
  if (files.is_link(path) || files.kind(path) != FileKind::regular)
    return std::nullopt;
  try {
    return read_input_note(*files.open(path), path.string());
  } catch (const Error&) {
    return std::nullopt;
  }
}

void write_input_note(FileSystem& files, const std::filesystem::path& path, const InputNote& note) {
  const std::string text = to_json_text(note);
  OutputFile(files, {.path = path, .replace = true, .is_own_name = true})
      .publish(std::as_bytes(std::span(text)));
}

}  // namespace meshhier::storage
