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

/// The place of a glTF's bytes when its pictures are needed: its file, a file whose gzip holds
/// them, or nowhere any more.
enum class GltfContent : std::uint8_t { stored, packed, fleeting };

/// The means that a reader works with.
struct GltfRoom {
  storage::FileSystem& files;
  storage::ScratchFile& scratch;   ///< for decoded bytes
  std::uint64_t memory_bytes = 0;  ///< for the JSON, and for what a codec decodes at once
  GltfContent content = GltfContent::stored;
  std::filesystem::path stored_in{};  ///< the file that `content` speaks of
  std::function<void()> check;        ///< called often; may throw
  std::uint64_t begin = 0;            ///< offset of the glTF in that file, or in its content
  /// Waits until files that are read at once have so many bytes left of `memory_bytes`, which are
  /// taken as long as what it returns is there; null: no others are read.
  std::function<std::shared_ptr<const void>(std::uint64_t)> take_memory{};
  /// Returns where in the file itself a range of packed content lies unpacked, if it does.
  std::function<std::optional<std::uint64_t>(std::uint64_t offset, std::uint64_t bytes)>
      find_plain{};
};

/// A picture of the document and the place where its bytes lie.
struct GltfPicture {
  std::string name;
  std::optional<std::filesystem::path> file{};  ///< none: it cannot be had, or `data` holds it
  std::uint64_t offset = 0, bytes = 0;          ///< in the file; 0 bytes: all of it
  std::vector<std::byte> data{};
  bool is_packed = false;  ///< the file is in gzip: offset and bytes count in its content
  /// Places where a file that is missing was looked for.
  std::vector<std::filesystem::path> sought{};

  bool is_there() const { return file || !data.empty(); }
};

/// An open glTF. Reading goes through it: buffers are opened when they are first needed, compressed
/// views are decoded once. For one thread.
class GltfFile {
 public:
  /// Reads the document of `file`: a GLB if it begins as one, else JSON. `folder`: where the files
  /// that it names lie. Throws as read_gltf_document().
  GltfFile(std::shared_ptr<const storage::File> file, std::filesystem::path folder, GltfRoom room);

  const GltfDocument& document() const { return document_; }
  const GltfRoom& room() const { return room_; }
  const std::filesystem::path& path() const { return file_->path(); }

  /// Returns the bytes of a view, decoded if it is compressed. They stay as long as this object.
  /// Throws Error(input) naming buffer or view if the range is not there or no such stream,
  /// Error(budget) if decoding takes more memory than there is, Error(io).
  GltfRange view(std::uint32_t index);

  /// Returns the text that a URI means: of a file, or within itself. `what`: for messages. Throws
  /// as view().
  std::string text_of(const std::string& uri, const std::string& what) const;

  /// Returns where a picture lies. Its file is found as NamedFiles finds it; a file that is
  /// missing, or no regular one, is none. A picture in a view of fleeting bytes is read into
  /// `data`. Throws Error(input) if it lies in a compressed view.
  GltfPicture picture(std::uint32_t image);

  [[noreturn]] void fail(const std::string& message) const;
  /// Throws Error(budget) if `bytes` are more than room().memory_bytes.
  void require_memory(std::uint64_t bytes, const std::string& what) const;
  /// Does the same, and takes them until what it returns is gone. A thread may take some only when
  /// it has none.
  std::shared_ptr<const void> take_memory(std::uint64_t bytes, const std::string& what) const;

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
  Buffer open_uri(const std::string& uri, const std::string& name) const;
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
  std::optional<GltfFileBytes> chunk_;  ///< the binary chunk of a GLB
  std::uint64_t chunk_offset_ = 0;
  GltfDocument document_;
  std::vector<Buffer> buffers_;
  std::vector<std::unique_ptr<GltfBytes>> decoded_;  ///< per view; null: not decoded
};

}  // namespace meshhier::mesh_io
