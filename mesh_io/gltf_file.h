// A glTF file, its document and the bytes of its buffers and views.
#pragma once

#include "mesh_io/gltf_bytes.h"
#include "mesh_io/gltf_document.h"
#include "mesh_io/named_files.h"
#include "storage/io/file.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Where the bytes of a glTF are when its pictures are needed: in its file, in a file in gzip of
/// which they are the content, or in none.
enum class GltfContent : std::uint8_t { stored, packed, fleeting };

/// What a reader works with.
struct GltfRoom {
  storage::FileSystem& files;
  storage::ScratchFile& scratch;   ///< for what is decoded
  std::uint64_t memory_bytes = 0;  ///< for the JSON, and for what a codec decodes at once
  GltfContent content = GltfContent::stored;
  std::filesystem::path stored_in{};  ///< that file
  std::function<void()> check;        ///< called often; may throw
  std::uint64_t begin = 0;            ///< of the glTF in it, or in its content
};

/// Where a picture lies.
struct GltfPicture {
  std::string name;
  std::optional<std::filesystem::path> file{};  ///< none: it cannot be had, or `data` has it
  std::uint64_t offset = 0, bytes = 0;          ///< in the file; 0 bytes: all of it
  std::vector<std::byte> data{};
  bool is_packed = false;  ///< the file is in gzip: offset and bytes are of its content
  std::vector<std::filesystem::path> sought{};  ///< where a file that is not there would be
};

class GltfFile {
 public:
  /// Reads the document of `file`: a GLB if it begins as one, else JSON. `folder`: where the files
  /// that it names lie. Throws as read_gltf_document().
  GltfFile(std::shared_ptr<const storage::File> file, std::filesystem::path folder, GltfRoom room);

  const GltfDocument& document() const { return document_; }
  const GltfRoom& room() const { return room_; }
  const std::filesystem::path& path() const { return file_->path(); }

  /// The bytes of a view; decoded once if it is compressed. They stay as long as this object.
  /// Throws Error(input) naming buffer or view if the range is not there or no such stream,
  /// Error(budget) if decoding takes more memory than there is, Error(io).
  GltfRange view(std::uint32_t index);

  /// A file is found as NamedFiles finds it. One in a view of fleeting bytes is read. Throws
  /// Error(input) if the picture lies in a compressed view. A file that is not there, or no regular
  /// one, is none.
  GltfPicture picture(std::uint32_t image);

  [[noreturn]] void fail(const std::string& message) const;
  /// Throws Error(budget) if `bytes` are more than room().memory_bytes.
  void require_memory(std::uint64_t bytes, const std::string& what) const;

 private:
  struct Buffer {
    std::unique_ptr<GltfBytes> bytes;
    std::filesystem::path file;  ///< empty if no file has the bytes as they are
    std::uint64_t offset = 0;    ///< in that file
  };

  std::string read_container();
  std::string read_text(std::uint64_t offset, std::uint64_t bytes) const;
  const Buffer& buffer(std::uint32_t index);
  Buffer open_buffer(std::uint32_t index) const;
  Buffer open_file(const std::filesystem::path& path, const std::string& name) const;
  std::unique_ptr<GltfBytes> decode_data(std::string_view base64, const std::string& name) const;
  GltfRange range(std::uint32_t buffer, std::uint64_t offset, std::uint64_t bytes,
                  const std::string& name);
  std::unique_ptr<GltfBytes> decode_view(const GltfMeshopt& packed, const std::string& name);
  bool is_regular(const std::filesystem::path& path) const;
  void find_picture(std::string_view uri, GltfPicture& picture);

  std::shared_ptr<const storage::File> file_;
  std::filesystem::path folder_;
  GltfRoom room_;
  NamedFiles named_{room_.files};
  std::optional<GltfFileBytes> chunk_;  ///< of a GLB
  std::uint64_t chunk_offset_ = 0;
  GltfDocument document_;
  std::vector<Buffer> buffers_;
  std::vector<std::unique_ptr<GltfBytes>> decoded_;  ///< of each view
};

}  // namespace meshhier::mesh_io
