#include "verify/verify_objects.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "hierarchy/object_parts.h"
#include "import/word_rows.h"
#include "storage/format/layout.h"
#include "storage/format/object_facts.h"
#include "storage/format/object_words.h"
#include "storage/format/tile_object_table.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// Runs a check; that a file is not as it must be is a problem. Returns whether there was none.
template <class Check>
bool note_problems(const VerifyJob& job, const Check& check) {
  try {
    check();
    return true;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt && error.code() != ErrorCode::io)
      throw;
    job.problems.add(error.what());
    return false;
  }
}

/// Areas are sums of the same numbers in another order.
bool are_near(double a, double b) {
  constexpr double kSumError = 1e-9;
  return std::abs(a - b) <= kSumError * std::max(std::abs(a), std::abs(b));
}

bool are_near(Vec3d a, Vec3d b, double slack) {
  return std::abs(a.x - b.x) <= slack && std::abs(a.y - b.y) <= slack &&
         std::abs(a.z - b.z) <= slack;
}

/// `slack`: how far positions of tiles are from those that were measured.
bool is_of(const ObjectRow& row, const partition::ObjectExtent& extent, double slack) {
  if (row.triangles != extent.triangles || row.box.has_value() != extent.box.has_value())
    return false;
  if (row.box && !(are_near(row.box->min, extent.box->min, slack) &&
                   are_near(row.box->max, extent.box->max, slack)))
    return false;
  return slack > 0 || are_near(row.area, extent.area);
}

std::uint64_t checksum_of(const TileObjects& objects) {
  storage::Checksum sum;
  sum.add(std::as_bytes(std::span(objects.objects)));
  sum.add(std::as_bytes(std::span(&objects.columns, 1)));
  sum.add(std::as_bytes(std::span(objects.text_bytes)));
  sum.add(objects.table);
  return sum.value();
}

}  // namespace

ObjectCheck::ObjectCheck(const VerifyJob& job, std::uint64_t memory_bytes)
    : job_(job),
      memory_bytes_(memory_bytes),
      census_(job.tree().depth(), job.scratch, memory_bytes),
      rows_(job.scratch, memory_bytes / 2) {
  note_problems(job, [&] {
    const auto path = storage::objects_path(job.reader.directory());
    table_ = std::make_unique<storage::ObjectTable>(job.files.open(path),
                                                    &job.reader.manifest().objects->table);
  });
}

void ObjectCheck::tell(NodeId node, const std::string& what) const {
  job_.problems.add(
      fmt::format("{}: {}", storage::tile_path(job_.reader.directory(), node).string(), what));
}

void ObjectCheck::add(const PublishedTile& tile) {
  const AttributeLayout& layout = job_.reader.tile_format().attributes;
  if (const auto torn = torn_triangle(tile.mesh, layout)) {
    tell(tile.node,
         fmt::format("the corners {}, {} and {} of a triangle belong to different objects",
                     raw((*torn)[0]), raw((*torn)[1]), raw((*torn)[2])));
    return;
  }
  census_.add(
      object_parts(job_.tree(), tile.node, tile.mesh, layout, job_.reader.manifest().origin));
  const std::vector<std::uint32_t> objects = storage::objects_of(tile.mesh, layout);
  if (!table_ || objects.back() >= table_->size()) {
    if (table_)
      tell(tile.node, fmt::format("object {} of {}", objects.back(), table_->size()));
    return;
  }
  if (tile.objects.empty())
    return;
  rows_.ask(static_cast<std::uint32_t>(told_.size()), objects);
  told_.push_back({tile.node, checksum_of(tile.objects)});
}

void ObjectCheck::finish_tiles() {
  if (!table_)
    return;
  const bool is_readable = note_problems(job_, [&] {
    rows_.fetch([&, cells = storage::cell_reader(*table_)](std::uint32_t object) {
      job_.cancel.check();
      return cells(object);
    });
  });
  if (!is_readable)
    return table_.reset();
  for (std::uint32_t i = 0; i < told_.size(); ++i) {
    job_.cancel.check();
    storage::TileTableMaker expected(table_->properties());
    rows_.take(i, [&](std::uint32_t object, auto cells) { expected.add(object, cells); });
    if (checksum_of(expected.take()) != told_[i].checksum)
      tell(told_[i].node, "its table of objects is not what objects.bin says");
  }
}

void ObjectCheck::finish() {
  if (!table_)
    return;
  census_.end();
  note_problems(job_, [&] { check_rows(); });
  bool are_sound = true;
  for (const storage::ObjectFile& told : storage::object_files(job_.reader.manifest().objects))
    are_sound = note_problems(job_, [&] { check_sum(told); });
  if (are_sound)  // the last one, of the words
    note_problems(job_, [&] { check_words(); });
  const auto& told = job_.reader.manifest().objects->shown;
  if (told != census_.shown())
    job_.problems.add(fmt::format("{}: \"objects.shown\" is not what the tiles show",
                                  storage::manifest_path(job_.reader.directory()).string()));
  job_.checks.push_back(fmt::format(
      "objects: names and properties of {}, their boxes and areas compared with their "
      "triangles{}",
      table_->size(), job_.reader.tile_format().objects ? ", the tables of tiles with both" : ""));
}

void ObjectCheck::check_rows() {
  const std::string name = storage::objects_path(job_.reader.directory()).string();
  const auto& rounded = job_.reader.manifest().quantization;
  const double slack = rounded ? rounded->worst_rounding * (1 + 1e-9) : 0;
  table_->for_each([&](std::uint32_t object, const ObjectRow& row) {
    job_.cancel.check();
    if (!is_of(row, census_.take(object), slack))
      job_.problems.add(fmt::format(
          "{}: box, area or triangles of object {} are not those of its triangles", name, object));
  });
}

void ObjectCheck::check_sum(const storage::ObjectFile& told) const {
  const auto path = job_.reader.directory() / told.name;
  const auto file = job_.files.open(path);
  storage::Checksum sum;
  std::vector<std::byte> block(std::size_t{1} << 18);
  for (std::uint64_t at = 0; at < file->size(); at += block.size()) {
    job_.cancel.check();
    const auto part =
        std::span(block).first(std::min<std::uint64_t>(block.size(), file->size() - at));
    file->read_exact(at, part);
    sum.add(part);
  }
  if (sum.value() != told.checksum)
    throw Error(ErrorCode::corrupt, path.string() + ": its checksum is not the manifest's");
}

/// The words are taken from the names anew, by the file's own table of letters.
void ObjectCheck::check_words() const {
  const auto& told = job_.reader.manifest().objects->words;
  if (!told)
    return;
  const auto path = storage::object_words_path(job_.reader.directory());
  const storage::ObjectWords words(job_.files.open(path), table_->size(), &*told);
  words.for_each([](std::string_view, const auto&) {});  // sound, each for itself
  std::uint32_t row = 1, wrong = 0;
  std::string first;
  importing::for_each_word_row(*table_, words.letters(), {job_.scratch, memory_bytes_, job_.cancel},
                               [&](const ObjectRow& expected) {
                                 const bool is_there = row < words.table().size() &&
                                                       words.table().row(row) == expected;
                                 if (!is_there && wrong++ == 0)
                                   first = plain_text(expected.name, 60);
                                 ++row;
                               });
  if (wrong > 0 || row != words.table().size())
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: is not of the names of objects.bin: it has {} rows, expected {}{}",
                            path.string(), words.table().size(), row,
                            first.empty() ? "" : ", the first that differs is \"" + first + '"'));
  job_.checks.push_back(
      fmt::format("object words: {} compared with the names", counted(row - 1, "rows")));
}

void compare_objects(const VerifyJob& job, const std::filesystem::path& imported,
                     const std::function<void(const std::string&)>& tell) {
  const storage::ObjectTable input(job.files.open(imported));
  const storage::ObjectTable made(job.files.open(storage::objects_path(job.reader.directory())),
                                  &job.reader.manifest().objects->table);
  if (input.size() != made.size() || input.properties() != made.properties())
    return tell(fmt::format("has {} objects with {} properties, the hierarchy {} with {}",
                            input.size(), input.properties().size(), made.size(),
                            made.properties().size()));
  std::uint64_t different = 0;
  std::string first;
  input.for_each([&](std::uint32_t object, const ObjectRow& row) {
    job.cancel.check();
    const ObjectRow other = made.row(object);
    if ((row.name != other.name || row.values != other.values) && different++ == 0)
      first = plain_text(row.name, 60);
  });
  if (different > 0)
    tell(fmt::format("other names or properties than those of {}, the first is \"{}\"",
                     counted(different, "objects"), first));
  job.checks.push_back(
      fmt::format("input: names and properties of {}", counted(input.size(), "objects")));
}

}  // namespace meshhier::verifying
