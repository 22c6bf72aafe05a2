#include "base/error.h"
#include "base/plain_text.h"
#include "base/srgb.h"
#include "export/byte_stream.h"
#include "export/export_parts.h"
#include "export/obj_faces.h"
#include "images/image_codec.h"
#include "storage/format/showable.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;

/// Returns "02_000017".
std::string file_name_of(NodeId node) {
  return fmt::format("{:02}_{:06}", raw(node.level), node.index);
}

/// The formats that readers of OBJ know; pictures of others are written as the last one.
constexpr std::array kObjFormats{ImageFormat::jpeg, ImageFormat::png};

std::string_view ending_of(ImageFormat format) {
  return row_of(format).file.endings[0];
}

/// Returns whether a name is that of a tile's picture: "02_000017.jpg".
bool is_picture_name(std::string_view name) {
  const std::size_t low = name.find('_'), dot = name.find('.');
  if (low == std::string_view::npos || dot == std::string_view::npos || low > dot)
    return false;
  const auto are_digits = [](std::string_view text, std::size_t least) {
    return text.size() >= least && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  const std::string_view ending = name.substr(dot);
  return are_digits(name.substr(0, low), 2) && are_digits(name.substr(low + 1, dot - low - 1), 6) &&
         std::ranges::find(kObjFormats, ending, ending_of) != kObjFormats.end();
}

/// The material file and the pictures, which are there when they are published, or not at all.
class ObjPictures {
 public:
  explicit ObjPictures(const PartsJob& job)
      : files_(job.files),
        replace_(job.request.replace),
        unlit_(job.reader.tile_format().textures->unlit),
        stem_(job.request.path.stem().string()),
        folder_(beside(job.request.path, "_textures")),
        unfinished_(storage::unfinished_path(folder_)),
        materials_(job.files, {beside(job.request.path, ".mtl"), replace_, job.request.inputs},
                   [&job] { job.cancel.check(); }),
        lock_(storage::lock_output(files_, folder_, folder_, [&job] { job.cancel.check(); })),
        text_(*materials_.file()) {
    require_free();
    storage::require_apart(files_, folder_, job.request.inputs);
    files_.remove_all(unfinished_);
    files_.make_directories(unfinished_);
  }
  ObjPictures(const ObjPictures&) = delete;
  ObjPictures& operator=(const ObjPictures&) = delete;
  ~ObjPictures() {
    try {
      files_.remove_all(unfinished_);
    } catch (const Error&) {
      // Files that were not published stay; no message tells it, as there is an error already.
    }
  }

  std::string library() const { return stem_ + ".mtl"; }

  void add(NodeId node, const TileImage& image) {
    const std::string name = file_name_of(node);
    const bool is_read = std::ranges::find(kObjFormats, image.format) != kObjFormats.end();
    const std::string picture =
        fmt::format("{}{}", name, ending_of(is_read ? image.format : kObjFormats.back()));
    storage::write_file(files_, unfinished_ / picture, is_read ? image.bytes : as_png(image));
    text_.put(fmt::format("newmtl {}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum {}\nmap_Kd {}/{}\n", name,
                          unlit_ ? 0 : 1, folder_.filename().string(), picture));
    if (image.alpha != AlphaMode::opaque)
      text_.put(fmt::format("map_d {}/{}\n", folder_.filename().string(), picture));
  }

  void publish() {
    text_.flush();
    require_free();
    if (replace_)
      files_.remove_all(folder_);
    if (!files_.rename_new(unfinished_, folder_))
      throw Error(ErrorCode::exists, folder_.string() + " has appeared meanwhile");
    materials_.publish();
  }

 private:
  /// Requires that nothing lies where the pictures go, or that they may replace it: a folder of
  /// such pictures.
  void require_free() {
    if (!files_.exists(folder_) && !files_.is_link(folder_))
      return;
    if (!replace_) {
      throw Error(ErrorCode::exists,
                  folder_.string() + " is already there (to replace it, use --force)");
    }
    const auto refuse = [&](const std::string& why) {
      throw Error(ErrorCode::exists,
                  fmt::format("{} {}, and is never replaced: move it away, or name another output",
                              folder_.string(), why));
    };
    if (files_.is_link(folder_) || !files_.is_directory(folder_))
      refuse("is no folder");
    for (const fs::path& child : files_.children(folder_)) {
      if (!is_picture_name(child.filename().string()))
        refuse("holds " + child.filename().string() + ", which no export made");
    }
  }

  static fs::path beside(const fs::path& obj, const std::string& ending) {
    return obj.parent_path() / (obj.stem().string() + ending);
  }

  static std::vector<std::byte> as_png(const TileImage& image) {
    const std::uint64_t texels = std::uint64_t{image.width} * image.height;
    return images::encode_image(images::decode_image(image.bytes, "a picture", texels),
                                kObjFormats.back(), kBestQuality);
  }

  storage::FileSystem& files_;
  bool replace_;
  bool unlit_;
  std::string stem_;
  fs::path folder_, unfinished_;
  storage::OutputFile materials_;
  std::unique_ptr<storage::FileLock> lock_;  ///< of the folder
  ByteStream text_;
};

/// The texture coordinates and normals of a part's vertices: how many are written before them.
struct PartCorners {
  std::uint64_t texcoords = 0, normals = 0;
  bool has_texcoords = false, has_normals = false;
};

class ObjWriter {
 public:
  ObjWriter(const storage::HierarchyReader& reader, storage::File& file)
      : layout_(reader.tile_format().attributes),
        origin_(reader.manifest().origin),
        shows_colours_(!reader.tile_format().textures && layout_.has_colours()),
        out_(file) {}

  void line(const std::string& text) { out_.put(text + '\n'); }

  /// Writes a line for each place.
  void write_places(const VertexArray& vertices) {
    const std::vector<float> shown = storage::showable_attributes(layout_, vertices);
    for (std::size_t v = 0; v < vertices.size(); ++v)
      line("v" + position_text(vertices.positions[v]) +
           (shows_colours_ ? colour_text(channels(shown, v)) : ""));
  }

  /// Writes texture coordinates and normals, which faces of the part refer to from now on.
  PartCorners write_corners(const CutPart& part) {
    const std::vector<float> shown = storage::showable_attributes(layout_, part.vertices);
    const PartCorners corners{texcoords_, normals_, !part.texcoords.empty() || layout_.texcoords,
                              !part.normals.empty() || layout_.normals};
    for (std::size_t v = 0; corners.has_texcoords && v < part.vertices.size(); ++v) {
      const Vec2f texcoord = texcoord_of(part, shown, v);
      line(fmt::format("vt {} {}", texcoord.u, texcoord.v));
    }
    for (std::size_t v = 0; corners.has_normals && v < part.vertices.size(); ++v) {
      const Vec3f normal = normal_of(part, shown, v);
      line(fmt::format("vn {} {} {}", normal.x, normal.y, normal.z));
    }
    texcoords_ += corners.has_texcoords ? part.vertices.size() : 0;
    normals_ += corners.has_normals ? part.vertices.size() : 0;
    return corners;
  }

  /// `places` of the corners, and their numbers in the part.
  void write_face(const PartCorners& part, std::span<const std::uint32_t, 3> places,
                  std::span<const std::uint32_t, 3> corners) {
    std::string face = "f";
    for (std::size_t i = 0; i < 3; ++i) {
      face += fmt::format(" {}", places[i] + std::uint64_t{1});
      if (part.has_texcoords)
        face += fmt::format("/{}", part.texcoords + corners[i] + 1);
      if (part.has_normals)
        face += fmt::format("{}/{}", part.has_texcoords ? "" : "/", part.normals + corners[i] + 1);
    }
    line(face);
  }

  void write_part(NodeId node, const CutPart& part) {
    const PartCorners corners = write_corners(part);
    line("g tile_" + file_name_of(node));
    if (!part.image.empty())
      line("usemtl " + file_name_of(node));
    for (const Triangle<std::uint32_t>& t : part.triangles) {
      const std::array places{part.places[t[0]], part.places[t[1]], part.places[t[2]]};
      write_face(corners, places, std::array{t[0], t[1], t[2]});
    }
  }

  void finish() { out_.flush(); }

 private:
  /// Returns a position with so many digits that the same numbers are read back.
  std::string position_text(Vec3f p) const {
    if (origin_ == Vec3d{})
      return fmt::format(" {} {} {}", p.x, p.y, p.z);
    const Vec3d exact = to_double(p) + origin_;
    return fmt::format(" {} {} {}", exact.x, exact.y, exact.z);
  }

  std::span<const float> channels(const std::vector<float>& shown, std::size_t vertex) const {
    const auto count = static_cast<std::size_t>(layout_.channels());
    return std::span(shown).subspan(vertex * count, count);
  }

  std::string colour_text(std::span<const float> channels) const {
    const float full = full_number(layout_.colour);
    const auto rgb = channels.subspan(layout_.part(AttributeKind::colours).first, 3);
    const auto value = [&](float number) {
      const float part = number / full;
      return layout_.space == ColourSpace::linear ? static_cast<float>(value_of(part)) : part;
    };
    return fmt::format(" {} {} {}", value(rgb[0]), value(rgb[1]), value(rgb[2]));
  }

  /// OBJ counts v from below. A mesh without pictures has its own texture coordinates.
  Vec2f texcoord_of(const CutPart& part, const std::vector<float>& shown,
                    std::size_t vertex) const {
    if (!part.texcoords.empty())
      return {part.texcoords[vertex].u, 1 - part.texcoords[vertex].v};
    const auto own = channels(shown, vertex);
    const auto offset = layout_.part(AttributeKind::texcoords).first;
    return {own[offset], own[offset + 1]};
  }

  Vec3f normal_of(const CutPart& part, const std::vector<float>& shown, std::size_t vertex) const {
    if (!part.normals.empty())
      return part.normals[vertex];
    const auto own = channels(shown, vertex);
    return {own[0], own[1], own[2]};
  }

  AttributeLayout layout_;
  Vec3d origin_;
  bool shows_colours_;
  ByteStream out_;
  std::uint64_t texcoords_ = 0, normals_ = 0;  ///< written by earlier parts
};

/// Returns a name that fits a line: others than that lose their line ends, and a backslash at the
/// end, which would join the next line.
std::string line_name(const std::string& name) {
  std::string text = plain_text(name, name.size());
  if (text.ends_with('\\'))
    text.back() = '?';
  return text;
}

/// Writes what is left of the parts when their places are there: faces, by object.
class ByObjects {
 public:
  ByObjects(const PartsJob& job, const ExportedParts& parts, PlacedValue object, ObjWriter& writer)
      : job_(job),
        parts_(parts),
        writer_(writer),
        faces_(job.files, job.output.scratch(), object, job.memory_budget / 4) {
    if (!job.numbers_objects)
      table_ = job.reader.open_objects();
  }

  void add(std::size_t i, const CutPart& part) {
    corners_.push_back(writer_.write_corners(part));
    has_picture_.push_back(!part.image.empty());
    faces_.add(static_cast<std::uint32_t>(i), part);
  }

  void write() {
    std::optional<std::uint32_t> object, part;
    faces_.for_each([&](const ObjFace& face) {
      if (face.object != object) {
        begin(face.object);
        part.reset();
      }
      if (face.part != part && has_picture_[face.part])
        writer_.line("usemtl " + file_name_of(parts_.node(face.part)));
      object = face.object;
      part = face.part;
      writer_.write_face(corners_[face.part], face.places, face.corners);
    });
  }

  /// Returns how many objects are read under another name than they have.
  std::uint64_t changed_names() const { return changed_names_; }

 private:
  /// Triangles of no object come first, and have no name.
  void begin(std::uint32_t object) {
    job_.cancel.check();
    if (!table_)
      return writer_.line(fmt::format("o {}", object));
    const std::string name = object < table_->size() ? table_->row(object).name : "";
    if (name.empty())
      return;
    const std::string text = line_name(name);
    changed_names_ += text != name || name.front() == ' ' || name.back() == ' ' ? 1 : 0;
    writer_.line("o " + text);
  }

  const PartsJob& job_;
  const ExportedParts& parts_;
  ObjWriter& writer_;
  ObjFaces faces_;
  std::unique_ptr<storage::ObjectTable> table_;  ///< null: objects are named by their numbers
  std::vector<PartCorners> corners_;
  std::vector<bool> has_picture_;
  std::uint64_t changed_names_ = 0;
};

}  // namespace

std::string write_obj(const PartsJob& job, const ExportedParts& parts) {
  job.progress.stage("export", 2 * parts.count, "tiles");
  std::optional<ObjPictures> pictures;
  if (job.reader.tile_format().textures)
    pictures.emplace(job);
  ObjWriter writer(job.reader, *job.output.file());
  writer.line("# meshhier export");
  if (pictures)
    writer.line("mtllib " + pictures->library());
  std::uint64_t vertices = 0, triangles = 0, images = 0;
  for (std::size_t i = 0; i < parts.count; ++i) {
    job.cancel.check();
    const VertexArray places = parts.places(i);
    writer.write_places(places);
    vertices += places.size();
    job.progress.advance(1);
  }
  std::optional<ByObjects> by_objects;
  if (const auto object = placed_object(job.reader.tile_format().attributes))
    by_objects.emplace(job, parts, *object, writer);
  for (std::size_t i = 0; i < parts.count; ++i) {
    job.cancel.check();
    const CutPart part = parts.load(i);
    if (by_objects)
      by_objects->add(i, part);
    else
      writer.write_part(parts.node(i), part);
    if (!part.image.empty()) {
      pictures->add(parts.node(i), part.image);
      ++images;
    }
    triangles += part.triangles.size();
    job.progress.advance(1);
  }
  if (by_objects)
    by_objects->write();
  writer.finish();
  if (pictures)
    pictures->publish();
  job.output.publish();
  const std::uint64_t changed = by_objects ? by_objects->changed_names() : 0;
  return fmt::format(
      "{}, {}{}{}", counted(vertices, "vertices"), counted(triangles, "triangles"),
      pictures ? ", " + counted(images, "pictures") : "",
      changed > 0 ? fmt::format("; {} that no line can hold as they are", counted(changed, "names"))
                  : "");
}

}  // namespace meshhier::exporting
