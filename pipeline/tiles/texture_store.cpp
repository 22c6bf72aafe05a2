#include "pipeline/tiles/texture_store.h"

#include "pipeline/tiles/blob_json.h"
#include "storage/format/work_bytes.h"

#include <algorithm>
#include <array>
#include <span>
#include <tuple>
#include <utility>

namespace meshhier::pipeline {
namespace {

template <class T>
std::span<const T> all_of(const std::vector<T>& values) {
  return values;
}

/// The head of a stored texture; at kImageBytes it has the bytes of the picture and of the normal
/// map.
using TextureHead = std::array<std::uint64_t, 11>;
constexpr std::size_t kImageBytes = 4;

std::vector<std::byte> encode(const TileTexture& texture) {
  const TileImage& image = texture.image;
  const TileImage& map = texture.normal_map;
  const TextureHead head{static_cast<std::uint64_t>(image.format),
                         static_cast<std::uint64_t>(image.alpha),
                         image.width,
                         image.height,
                         image.bytes.size(),
                         map.bytes.size(),
                         texture.corners.size(),
                         static_cast<std::uint64_t>(map.format),
                         map.width,
                         map.height,
                         texture.tangents.size()};
  storage::Packer packer(sizeof head + image.bytes.size() + map.bytes.size() +
                         texture.corners.size() * sizeof(texture::CornerTexcoords) +
                         texture.tangents.size() * sizeof(texture::CornerTangents));
  packer.put(std::span<const std::uint64_t>(head));
  packer.put(all_of(texture.corners));
  packer.put(all_of(texture.tangents));
  packer.put(all_of(image.bytes));
  packer.put(all_of(map.bytes));
  return packer.take();
}

TileTexture decode_texture(std::span<const std::byte> bytes) {
  storage::Unpacker unpacker(bytes);
  const auto head = unpacker.get<std::uint64_t>(std::tuple_size_v<TextureHead>);
  TileTexture texture;
  texture.image.format = static_cast<ImageFormat>(head[0]);
  texture.image.alpha = static_cast<AlphaMode>(head[1]);
  texture.image.width = static_cast<std::uint32_t>(head[2]);
  texture.image.height = static_cast<std::uint32_t>(head[3]);
  texture.normal_map.format = static_cast<ImageFormat>(head[7]);
  texture.normal_map.width = static_cast<std::uint32_t>(head[8]);
  texture.normal_map.height = static_cast<std::uint32_t>(head[9]);
  texture.corners = unpacker.get<texture::CornerTexcoords>(head[6]);
  texture.tangents = unpacker.get<texture::CornerTangents>(head[10]);
  texture.image.bytes = unpacker.get<std::byte>(head[kImageBytes]);
  texture.normal_map.bytes = unpacker.get<std::byte>(head[kImageBytes + 1]);
  unpacker.finish();
  return texture;
}

using SourceHead = std::array<std::uint64_t, 10>;

std::vector<std::byte> encode(const BakeSource& source) {
  const texture::NormalTexels& directions = source.directions;
  const SourceHead head{source.positions.size(),   source.triangles.size(),
                        source.image.width,        source.image.height,
                        source.image.channels,     static_cast<std::uint64_t>(source.alpha),
                        directions.width(),        directions.height(),
                        directions.known().size(), source.parents.size()};
  storage::Packer packer(sizeof head + source.bytes());
  packer.put(std::span<const std::uint64_t>(head));
  packer.put(all_of(source.positions));
  packer.put(all_of(source.triangles));
  packer.put(all_of(source.corners));
  packer.put(all_of(source.image.texels));
  packer.put(directions.words());
  packer.put(directions.known());
  packer.put(all_of(source.parents));
  return packer.take();
}

BakeSource decode_source(std::span<const std::byte> bytes) {
  storage::Unpacker unpacker(bytes);
  const auto head = unpacker.get<std::uint64_t>(std::tuple_size_v<SourceHead>);
  BakeSource source;
  source.positions = unpacker.get<Vec3f>(head[0]);
  source.triangles = unpacker.get<TileTriangle>(head[1]);
  source.corners = unpacker.get<texture::CornerTexcoords>(head[1]);
  source.image.width = static_cast<std::uint32_t>(head[2]);
  source.image.height = static_cast<std::uint32_t>(head[3]);
  source.image.channels = static_cast<std::uint32_t>(head[4]);
  source.image.texels = unpacker.get<std::uint8_t>(head[2] * head[3] * head[4]);
  source.alpha = static_cast<AlphaMode>(head[5]);
  const auto width = static_cast<std::uint32_t>(head[6]);
  const auto height = static_cast<std::uint32_t>(head[7]);
  auto words = unpacker.get<std::uint64_t>(texture::NormalTexels::word_count(width, height));
  source.directions = {width, height, std::move(words),
                       unpacker.get<texture::NormalTexel>(head[8])};
  source.parents = unpacker.get<std::uint16_t>(head[9]);
  unpacker.finish();
  return source;
}

}  // namespace

std::uint64_t BakeSource::bytes() const {
  const auto taken = [](const auto& array) { return array.capacity() * sizeof(array[0]); };
  return taken(positions) + taken(parents) + taken(triangles) + taken(corners) +
         taken(image.texels) + directions.bytes() + taken(normals);
}

TextureStore::TextureStore(const Tree& tree, storage::ScratchFile& scratch) : scratch_(scratch) {
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    const std::uint32_t count = tree.node_count(static_cast<Level>(level));
    levels_.push_back({{scratch, count},
                       {scratch, count},
                       std::vector<TexelSizes>(count),
                       std::vector<std::shared_ptr<const BakeSource>>(count)});
  }
}

void TextureStore::put(NodeId node, const TileTexture& texture, BakeSource source,
                       const TexelSizes& texels) {
  LevelStore& level = levels_[raw(node.level)];
  level.textures.put(node.index, encode(texture));
  level.sources.put_on_disk(node.index, encode(source));
  level.texels[node.index] = texels;
  if (scratch_.pool().try_take(source.bytes()))
    level.held[node.index] = std::make_shared<const BakeSource>(std::move(source));
}

TileTexture TextureStore::texture(NodeId node) const {
  if (levels_[raw(node.level)].textures.size(node.index) == 0)
    return {};
  return decode_texture(levels_[raw(node.level)].textures.view(node.index).bytes());
}

std::shared_ptr<const BakeSource> TextureStore::source(NodeId node) const {
  if (const auto& held = levels_[raw(node.level)].held[node.index])
    return held;
  return source(node, [&] { return read_source(node); });
}

BakeSource TextureStore::read_source(NodeId node) const {
  if (const auto& held = levels_[raw(node.level)].held[node.index])
    return *held;
  return decode_source(levels_[raw(node.level)].sources.view(node.index).bytes());
}

std::shared_ptr<const BakeSource> TextureStore::source(
    NodeId node, const std::function<BakeSource()>& make) const {
  const Key key{node.level, node.index};
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = found_.find(key); found != found_.end()) {
      cached_.splice(cached_.begin(), cached_, found->second);
      return found->second->source;
    }
  }
  const auto source = std::make_shared<const BakeSource>(make());
  const std::lock_guard lock(mutex_);
  if (found_.contains(key))
    return source;
  cached_.push_front({key, source});
  found_[key] = cached_.begin();
  cached_bytes_ += source->bytes();
  while (cached_bytes_ > cache_bytes_) {
    cached_bytes_ -= cached_.back().source->bytes();
    found_.erase(cached_.back().key);
    cached_.pop_back();
  }
  return source;
}

template <class Visit>
void TextureStore::for_each_size(const Visit& visit) const {
  for (const LevelStore& level : levels_) {
    for (std::size_t i = 0; i < level.textures.count(); ++i) {
      if (level.textures.size(i) == 0)
        continue;  // an early node, or a partition without a picture
      TextureHead head{};
      level.textures.read(i, 0, std::as_writable_bytes(std::span(head)));
      if (!visit(head[kImageBytes], head[kImageBytes + 1]))
        return;
    }
  }
}

bool TextureStore::has_normal_maps() const {
  bool has = false;
  for_each_size([&](std::uint64_t, std::uint64_t map) {
    has = map > 0;
    return !has;
  });
  return has;
}

std::uint64_t TextureStore::image_bytes() const {
  std::uint64_t sum = 0;
  for_each_size([&](std::uint64_t picture, std::uint64_t map) {
    sum += picture + map;
    return true;
  });
  return sum;
}

std::uint64_t TextureStore::heaviest_bytes() const {
  std::uint64_t heaviest = 0;
  for (const LevelStore& level : levels_) {
    for (std::size_t i = 0; i < level.textures.count(); ++i)
      heaviest = std::max(heaviest, level.textures.size(i));
  }
  return heaviest;
}

nlohmann::json TextureStore::stored(NodeId node) const {
  const LevelStore& level = levels_[raw(node.level)];
  const TexelSizes& texels = level.texels[node.index];
  return {{"texture", to_json(level.textures.stored(node.index))},
          {"source", to_json(level.sources.stored(node.index))},
          {"texels", {texels.own, texels.finest, texels.lost, texels.degrees}}};
}

bool TextureStore::restore(NodeId node, const nlohmann::json& stored) {
  LevelStore& level = levels_[raw(node.level)];
  const nlohmann::json& texels = stored.at("texels");
  level.texels[node.index] = {texels.at(0), texels.at(1), texels.at(2), texels.at(3)};
  return pipeline::restore(level.textures, node.index, stored.at("texture")) &&
         pipeline::restore(level.sources, node.index, stored.at("source"));
}

void TextureStore::drop_copies() {
  const std::lock_guard lock(mutex_);
  for (LevelStore& level : levels_) {
    level.textures.drop_copies();
    for (std::shared_ptr<const BakeSource>& held : level.held) {
      if (held)
        scratch_.pool().give_back(held->bytes());
      held.reset();
    }
  }
  cached_.clear();
  found_.clear();
  cached_bytes_ = 0;
}

}  // namespace meshhier::pipeline
