#include "pipeline/journal/build_journal.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "pipeline/journal/input_json.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/manifest.h"
#include "storage/io/hash.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using Value = nlohmann::json;

Value to_json(Vec3d v) {
  return {v.x, v.y, v.z};
}
Vec3d point(const Value& json) {
  return {json.at(0), json.at(1), json.at(2)};
}

Value to_json(const IndexedStep& indexed) {
  const StepDeviation& step = indexed.second;
  return {indexed.first, step.certain, step.mean_square, step.finer_neighbours.numbers()};
}

Value to_json(std::span<const IndexedStep> steps) {
  Value all = Value::array();
  for (const IndexedStep& step : steps)
    all.push_back(to_json(step));
  return all;
}

IndexedStep indexed_step(const Value& json) {
  return {json.at(0),
          {json.at(1), json.at(2), TileSet(json.at(3).get<std::vector<std::uint32_t>>())}};
}

Value to_json(const images::StoredImage& image) {
  const images::ImageInfo& info = image.info;
  Value strips = Value::array();
  for (const images::StoredStrip& strip : image.strips)
    strips.push_back({strip.offset, strip.checksum});
  return {{"info", {info.format, info.width, info.height, info.channels, info.decoder_bytes}},
          {"strips", std::move(strips)}};
}

images::StoredImage stored_image(const Value& json) {
  const Value& info = json.at("info");
  images::StoredImage image{{info.at(0), info.at(1), info.at(2), info.at(3), info.at(4)}, {}};
  for (const Value& strip : json.at("strips"))
    image.strips.push_back({strip.at(0), strip.at(1)});
  return image;
}

NodeId node_of(const Value& json) {
  return {static_cast<Level>(json.at(0).get<std::uint8_t>()), json.at(1)};
}

/// All values but objects, lists as a whole, by their dotted paths.
using Leaves = std::map<std::string, std::string>;

void add_leaves(const Value& value, const std::string& path, Leaves& leaves) {
  if (!value.is_object()) {
    leaves[path] = storage::json_text(value);
    return;
  }
  for (const auto& [key, inner] : value.items())
    add_leaves(inner, path.empty() ? key : path + '.' + key, leaves);
}

/// Returns what take() does; false also if the entry has values of another kind.
template <class Take>
bool is_understood(const Take& take) {
  try {
    return take();
  } catch (const Value::exception&) {
    return false;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt)
      throw;
    return false;
  }
}

}  // namespace

std::string differences(const Value& was, const Value& is) {
  Leaves before, now;
  add_leaves(was, "", before);
  add_leaves(is, "", now);
  Leaves all = before;
  all.insert(now.begin(), now.end());
  std::string text;
  const auto value = [](const Leaves& of, const std::string& key) {
    const auto found = of.find(key);
    return found == of.end() ? "not set" : found->second;
  };
  for (const auto& [key, either] : all) {
    if (value(before, key) == value(now, key))
      continue;
    text += fmt::format("{}{} was {} and is {}", text.empty() ? "" : ", ", key, value(before, key),
                        value(now, key));
  }
  return text;
}

bool add_entry(const Value& entry, EarlierBuild& build) {
  return is_understood([&] {
    if (entry.contains("build")) {
      build.decides_result = entry.at("build");
      build.input_times = entry.at("times");
    } else if (entry.contains("ingest")) {
      const Value& source = entry.at("ingest");
      build.source = storage::parse_source(nlohmann::ordered_json(source.at("summary")), "journal");
      build.materials = material_list(source.at("materials"));
      build.input = input_record(source.at("input"));
      build.is_whole = build.decides_result.is_object();
    }
    return true;
  });
}

std::optional<EarlierBuild> find_earlier_build(storage::FileSystem& files,
                                               const std::filesystem::path& work) {
  if (!files.exists(storage::journal_path(work)))
    return std::nullopt;
  EarlierBuild earlier;
  storage::ScratchUse uncounted;
  const storage::Journal journal(files, storage::journal_path(work), uncounted,
                                 [&](const Value& entry) {
                                   add_entry(entry, earlier);
                                   return true;
                                 });
  return earlier.is_whole ? std::optional(std::move(earlier)) : std::nullopt;
}

BuildJournal::BuildJournal(storage::FileSystem& files, const std::filesystem::path& work,
                           const BuildIdentity& identity, storage::ScratchUse& use,
                           Workpieces pieces, const execution::CancelToken& cancel)
    : files_(files),
      built_(storage::built_path(work)),
      identity_(identity),
      forest_(pieces.forest),
      chunks_(pieces.chunks),
      textures_(pieces.textures),
      pictures_(pieces.pictures),
      cancel_(cancel) {
  make_room();
  // Before any entry is taken: in a complete build those of scratch files are passed over.
  look_ahead(storage::journal_path(work), use);
  std::optional<Value> build;  // the one that the journal belongs to
  bool is_same = true;
  bool has_other_work = false;
  const auto read = [&](const Entry& entry) {
    if (!build) {
      build = entry.at("build");
      is_same = *build == identity.decides_result;
      input_was_touched_ = entry.at("times") != identity.input_times;
      return true;
    }
    has_other_work = has_other_work || entry.contains("ingest");
    return !is_same || take(entry);
  };
  sink_ = std::make_unique<storage::Journal>(
      files, storage::journal_path(work), use,
      [&](const Entry& entry) { return is_understood([&] { return read(entry); }); });
  if (!is_same && has_other_work) {
    throw Error(ErrorCode::other_work,
                fmt::format("{} holds the work of a build that was stopped, but {}; --restart "
                            "throws it away and begins anew",
                            work.string(), differences(*build, identity.decides_result)));
  }
  if (is_complete_)
    is_sound_ = is_same && published_.size() == forest_.tree().tile_count();
  else
    is_sound_ = is_same && source_ && can_make_all_leaves() && can_make_all_textures();
}

BuildJournal::BuildJournal(storage::FileSystem& files, const std::filesystem::path& built,
                           BuildIdentity identity, Workpieces pieces,
                           std::unique_ptr<storage::EntrySink> sink,
                           const execution::CancelToken& cancel)
    : files_(files),
      built_(built),
      identity_(std::move(identity)),
      forest_(pieces.forest),
      chunks_(pieces.chunks),
      textures_(pieces.textures),
      pictures_(pieces.pictures),
      cancel_(cancel),
      is_sealed_(true),
      sink_(std::move(sink)) {
  make_room();
}

void BuildJournal::make_room() {
  const Tree& tree = forest_.tree();
  has_leaves_.resize(chunks_.count());
  steps_.resize(static_cast<std::size_t>(raw(tree.depth())) + 1);
  for (int l = 0; l <= raw(tree.depth()); ++l)
    has_tile_.emplace_back(tree.node_count(static_cast<Level>(l)));
  has_texture_ = has_tile_;
}

bool BuildJournal::take_sealed(const Entry& entry) {
  return is_understood([&] { return entry.contains("build") || take(entry); });
}

bool BuildJournal::take_sealed_copies(const Entry& entry) {
  return is_understood([&] {
    const Entry& chunk = entry.at("partition");
    return chunk.at(0) < chunks_.count() && chunks_.restore_copies(chunk.at(0), chunk.at(1));
  });
}

/// Finds out whether the build was complete: then the scratch files are gone, and entries that name
/// them say nothing.
void BuildJournal::look_ahead(const std::filesystem::path& path, storage::ScratchUse& use) {
  if (!files_.exists(path))
    return;
  const storage::Journal all(files_, path, use, [&](const Entry& entry) {
    is_complete_ = entry.contains("complete");
    return true;
  });
}

bool BuildJournal::take(const Entry& entry) {
  /// A kind of entry, known by its only key, or its first.
  struct Kind {
    std::string_view key;
    bool (BuildJournal::*take)(const Entry& value);
    bool outlives_scratch = false;
  };
  static constexpr std::array kKinds{
      Kind{"partition", &BuildJournal::take_chunk},
      Kind{"ingest", &BuildJournal::take_source, true},
      Kind{"image", &BuildJournal::take_image},
      Kind{"leaves", &BuildJournal::take_leaves},
      Kind{"simplify", &BuildJournal::take_tile},
      Kind{"root", &BuildJournal::take_root},
      Kind{"texture", &BuildJournal::take_texture},
      Kind{"publish", &BuildJournal::take_published, true},
      Kind{"took", &BuildJournal::pass_over},
  };
  cancel_.check();
  const auto first = entry.items().begin();
  const auto* const kind = std::ranges::find(kKinds, std::string_view(first.key()), &Kind::key);
  if (is_complete_ && (kind == kKinds.end() || !kind->outlives_scratch))
    return true;
  return kind != kKinds.end() && (this->*kind->take)(first.value());
}

bool BuildJournal::take_chunk(const Entry& chunk) {
  return chunk.at(0) < chunks_.count() && chunks_.restore(chunk.at(0), chunk.at(1));
}

bool BuildJournal::take_source(const Entry& source) {
  source_ = DistributedSource{
      storage::parse_source(nlohmann::ordered_json(source.at("summary")), "journal"),
      point(source.at("origin")), material_list(source.at("materials")),
      input_record(source.at("input"))};
  return true;
}

bool BuildJournal::take_image(const Entry& image) {
  images_.push_back(stored_image(image.at("stored")));
  const std::string why = image.at("broken");
  if (!why.empty())
    broken_images_.emplace_back(static_cast<std::uint32_t>(images_.size() - 1), why);
  return pictures_ != nullptr;
}

bool BuildJournal::take_leaves(const Entry& leaves) {
  const std::uint32_t chunk = leaves.at("chunk");
  const std::uint64_t unreferenced = leaves.at("unreferenced");
  if (chunk >= chunks_.count() || has_leaves_[chunk] != 0 ||
      !forest_.restore_chunk(chunk, leaves.at("stored")))
    return false;
  chunks_.drop(chunk);
  has_leaves_[chunk] = 1;
  unreferenced_ += unreferenced;
  ++found_;
  return true;
}

char* BuildJournal::flag_of(const Entry& node, std::vector<std::vector<char>>& flags) const {
  const std::size_t level = node.at(0);
  const std::size_t index = node.at(1);
  return level < flags.size() && index < flags[level].size() ? &flags[level][index] : nullptr;
}

bool BuildJournal::take_tile(const Entry& tile) {
  const NodeId node = node_of(tile.at("node"));
  char* const has = flag_of(tile.at("node"), has_tile_);
  if (has == nullptr || *has != 0 || forest_.tree().is_partition(node))
    return false;
  std::vector<IndexedStep> steps;
  for (const Entry& step : tile.at("steps"))
    steps.push_back(indexed_step(step));
  if (!forest_.restore_tile(node, tile.at("stored")))
    return false;
  add_steps(steps, finer(node.level));
  *has = 1;
  ++found_;
  return true;
}

bool BuildJournal::take_root(const Entry& root) {
  std::vector<IndexedStep> steps;
  for (const Entry& step : root.at("steps"))
    steps.push_back(indexed_step(step));
  if (has_root_ || !forest_.restore_root(root.at("stored")))
    return false;
  add_steps(steps, Level{0});
  has_root_ = true;
  return true;
}

void BuildJournal::add_steps(std::span<const IndexedStep> steps, Level level) {
  std::vector<IndexedStep>& to = steps_[raw(level)];
  to.insert(to.end(), steps.begin(), steps.end());
}

bool BuildJournal::take_texture(const Entry& texture) {
  char* const has = flag_of(texture.at("node"), has_texture_);
  if (textures_ == nullptr || has == nullptr || *has != 0 ||
      !textures_->restore(node_of(texture.at("node")), texture.at("stored")))
    return false;
  *has = 1;
  ++found_;
  return true;
}

bool BuildJournal::is_as_published(const TileRecord& record) const {
  const std::filesystem::path path = storage::tile_path(built_, record.node);
  if (files_.kind(path) != storage::FileKind::regular)
    return false;
  const std::unique_ptr<storage::File> file = files_.open(path);
  if (file->size() != record.file_bytes)
    return false;
  std::vector<std::byte> content(record.file_bytes);
  file->read_exact(0, content);
  return storage::checksum(content) == record.checksum;
}

bool BuildJournal::take_published(const Entry& published) {
  const Value::binary_t& bytes = published.at("record").get_binary();
  const TileRecord record = storage::decode_record(std::as_bytes(std::span(bytes)));
  const double rounding = published.at("rounding");
  if (!is_sealed_ && !is_as_published(record))
    return false;
  published_.emplace(std::pair(record.node.level, record.node.index), Published{record, rounding});
  ++found_;
  return true;
}

/// Whether the disk holds all that was put there of the chunks that are still needed.
bool BuildJournal::can_make_all_leaves() const {
  for (std::uint32_t chunk = 0; chunk < chunks_.count(); ++chunk) {
    cancel_.check();
    if (!has_leaves(chunk) && !chunks_.is_as_stored(chunk))
      return false;
  }
  return true;
}

/// Whether the disk holds the decoded pictures, as long as a partition has none of its own.
bool BuildJournal::can_make_all_textures() {
  const auto left = [](char has) { return has == 0; };
  return pictures_ == nullptr || std::ranges::none_of(has_texture_.back(), left) ||
         restore_pictures();
}

bool BuildJournal::restore_pictures() {
  return pictures_->restore(images_);
}

std::uint64_t BuildJournal::steps() const {
  std::uint64_t tiles = 0;
  for (int l = 0; l < raw(forest_.tree().depth()); ++l)
    tiles += has_tile_[static_cast<std::size_t>(l)].size();
  const std::uint64_t published = forest_.tree().tile_count();
  const std::uint64_t pictures =
      pictures_ != nullptr ? published : published - forest_.tree().partition_count();
  return chunks_.count() + tiles + published + (textures_ != nullptr ? pictures : 0);
}

std::vector<IndexedStep> BuildJournal::take_steps(Level level) {
  return std::exchange(steps_[raw(level)], {});
}

std::vector<Published> BuildJournal::published() const {
  std::vector<Published> all;
  all.reserve(published_.size());
  for (const auto& [node, tile] : published_)
    all.push_back(tile);
  return all;
}

void BuildJournal::note_source(const DistributedSource& source) {
  sink_->append({{"build", identity_.decides_result}, {"times", identity_.input_times}});
  note_chunks();
  sink_->append({{"ingest",
                  {{"summary", Value(storage::source_json(source.summary))},
                   {"origin", to_json(source.origin)},
                   {"materials", to_json(source.materials)},
                   {"input", to_json(source.input)}}}});
  source_ = source;
}

void BuildJournal::note_chunks() {
  constexpr std::size_t kInFlight = 64;  // an entry has some KiB
  execution::ordered_for(
      chunks_.count(), kInFlight, cancel_,
      [&](std::size_t i) {
        const auto chunk = static_cast<std::uint32_t>(i);
        return chunks_.has(chunk) ? chunks_.store(chunk) : Value();
      },
      [&](std::size_t chunk, const Value& stored) {
        if (!stored.is_null())
          sink_->append({{"partition", {chunk, stored}}});
      });
}

void BuildJournal::note_image(const images::StoredImage& stored, const std::string& why) {
  sink_->append({{"image", {{"stored", to_json(stored)}, {"broken", why}}}});
  if (!why.empty())
    broken_images_.emplace_back(static_cast<std::uint32_t>(images_.size()), why);
  images_.push_back(stored);
}

void BuildJournal::note_texture(NodeId node) {
  sink_->append({{"texture",
                  {{"node", {raw(node.level), node.index}}, {"stored", textures_->stored(node)}}}});
}

void BuildJournal::note_leaves(std::uint32_t chunk, std::uint64_t unreferenced_vertices) {
  sink_->append({{"leaves",
                  {{"chunk", chunk},
                   {"unreferenced", unreferenced_vertices},
                   {"stored", forest_.stored_chunk(chunk)}}}});
  has_leaves_[chunk] = 1;
  unreferenced_ += unreferenced_vertices;
}

void BuildJournal::note_tile(NodeId node, std::span<const IndexedStep> steps) {
  sink_->append({{"simplify",
                  {{"node", {raw(node.level), node.index}},
                   {"steps", to_json(steps)},
                   {"stored", forest_.stored_tile(node)}}}});
  add_steps(steps, finer(node.level));
}

void BuildJournal::note_root(std::span<const IndexedStep> steps) {
  sink_->append({{"root", {{"steps", to_json(steps)}, {"stored", forest_.stored_root()}}}});
  add_steps(steps, Level{0});
  has_root_ = true;
}

void BuildJournal::note_published(const Published& tile) {
  const std::vector<std::byte> bytes = storage::encode_record(tile.record);
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  sink_->append(
      {{"publish",
        {{"record", Value::binary({first, first + bytes.size()})}, {"rounding", tile.rounding}}}});
  published_.emplace(std::pair(tile.record.node.level, tile.record.node.index), tile);
}

void BuildJournal::note_complete() {
  sink_->append({{"complete", true}});
  is_complete_ = true;
}

}  // namespace meshhier::pipeline
