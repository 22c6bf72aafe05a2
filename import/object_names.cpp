#include "import/object_names.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/utf8.h"
#include "import/row_bytes.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <limits>
#include <span>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::kMostObjectNameBytes;
static_assert(kMostObjectNameBytes < kMostObjectTextBytes);
/// Names that are remembered, and the bytes of the longest one.
constexpr std::size_t kKnownNames = 4096;
constexpr std::size_t kLongestKnown = 200;
constexpr std::size_t kLongestShown = 60;

/// What stands before a value: its property, and the alternative of ObjectValue that it is.
struct ValueHead {
  std::uint8_t property, kind;
};

}  // namespace

std::string sound_name(std::string_view name) {
  std::string sound = utf8_of_windows(name);
  for (std::size_t zero = 0; (zero = sound.find('\0', zero)) != std::string::npos;)
    sound.replace(zero, 1, "\xEF\xBF\xBD");
  return sound;
}

std::optional<std::uint8_t> PropertyNames::number(std::string_view name) {
  const auto known = std::ranges::find(names_, name);
  if (known != names_.end())
    return static_cast<std::uint8_t>(known - names_.begin());
  if (names_.size() == kMostObjectProperties || name.empty() ||
      name.size() > kMostPropertyNameBytes) {
    drop(name);
    return std::nullopt;
  }
  names_.emplace_back(name);
  return static_cast<std::uint8_t>(names_.size() - 1);
}

void PropertyNames::drop(std::string_view name) {
  constexpr std::size_t kMostDropped = 4096;
  const std::string shown = plain_text(std::string(name), kLongestShown);
  if (dropped_.size() < kMostDropped)
    dropped_.insert(shown);
  else
    more_dropped_ += dropped_.contains(shown) ? 0 : 1;
}

void PropertyNames::drop_all(const PropertyNames& others) {
  std::ranges::for_each(others.dropped_, [this](const std::string& name) { drop(name); });
  more_dropped_ += others.more_dropped_;
}

std::string PropertyNames::dropped_names() const {
  constexpr std::size_t kMostListed = 5;
  std::string text;
  std::size_t listed = 0;
  for (const std::string& name : dropped_) {
    if (listed++ == kMostListed)
      break;
    text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", name);
  }
  return dropped() <= kMostListed ? text
                                  : fmt::format("{} and {} more", text, dropped() - kMostListed);
}

std::string encode_values(const ObjectValues& values) {
  std::string bytes;
  for (const auto& [property, value] : values) {
    put_raw(bytes, ValueHead{property, static_cast<std::uint8_t>(value.index())});
    if (const auto* text = std::get_if<std::string>(&value))
      put_text(bytes, *text);
    else if (const auto* number = std::get_if<double>(&value))
      put_raw(bytes, *number);
    else if (const auto* flag = std::get_if<bool>(&value))
      put_raw(bytes, *flag);
  }
  return bytes;
}

ObjectValues decode_values(std::string_view bytes) {
  ObjectValues values;
  while (!bytes.empty()) {
    const auto head = take_raw<ValueHead>(bytes);
    ObjectValue value;
    if (head.kind == ObjectValue(std::string()).index())
      value = take_text(bytes);
    else if (head.kind == ObjectValue(0.0).index())
      value = take_raw<double>(bytes);
    else if (head.kind == ObjectValue(false).index())
      value = take_raw<bool>(bytes);
    values.emplace_back(head.property, std::move(value));
  }
  return values;
}

std::uint32_t ObjectNames::number(std::string_view name, std::string_view id) {
  const FoundObject object{.name = std::string(name), .id = std::string(id)};
  if (name.size() > kLongestKnown)
    return add(object);
  known_.resize(kKnownNames);
  Known& known = known_[storage::checksum(std::as_bytes(std::span(name))) % kKnownNames];
  if (known.number == UINT32_MAX || known.name != name)
    known = {object.name, add(object)};
  return known.number;
}

std::uint32_t ObjectNames::add(const FoundObject& object) {
  if (rows_.rows() >= UINT32_MAX)
    throw Error(ErrorCode::input, "the input has 2^32 names of objects or more");
  const std::string name = sound_name(object.name);
  if (name.size() > kMostObjectNameBytes) {
    throw Error(ErrorCode::input,
                fmt::format("the name \"{}\" of an object has {} bytes; up to {} are read",
                            plain_text(name, kLongestShown), name.size(), kMostObjectNameBytes));
  }
  compare(name);
  have_ids_ = have_ids_ || !object.id.empty();
  std::string bytes;
  put_text(bytes, sound_name(object.id));
  bytes += encode_values(object.values);
  rows_.append({name, bytes});
  return count() - 1;
}

void ObjectNames::compare(std::string_view name) {
  if (first_.empty())
    first_ = name;
  are_different_ = are_different_ || (!name.empty() && name != first_);
}

std::uint32_t ObjectNames::append(const ObjectNames& others) {
  const std::uint32_t first = count();
  have_ids_ = have_ids_ || others.have_ids_;
  RowCursor rows(others.rows_);
  while (rows.next()) {
    compare(rows.row().key);
    rows_.append(rows.row());
  }
  return first;
}

FoundObject ObjectNames::object_of(const Row& row) {
  std::string_view bytes = row.bytes;
  FoundObject object{.name = std::string(row.key), .id = take_text(bytes)};
  object.values = decode_values(bytes);
  return object;
}

void ObjectRuns::add(std::uint32_t object, std::uint64_t triangles) {
  triangles_ += triangles;
  constexpr std::uint64_t kMostRun = std::numeric_limits<std::uint32_t>::max();
  while (triangles > 0) {
    if (last_.object != object || last_.triangles == kMostRun) {
      if (last_.triangles > 0)
        runs_.append(last_);
      last_ = {object, 0};
    }
    const std::uint64_t more = std::min(triangles, kMostRun - last_.triangles);
    last_.triangles += static_cast<std::uint32_t>(more);
    triangles -= more;
  }
}

void ObjectRuns::append(const ObjectRuns& others, std::uint32_t first) {
  for (RunCursor runs(others); runs.next();)
    add(first + runs.run().object, runs.run().triangles);
}

bool RunCursor::next() {
  constexpr std::uint64_t kBlock = 4096;
  if (next_ == runs_.count())
    return false;
  if (next_ == runs_.runs_.size()) {
    run_ = runs_.last_;
  } else {
    if (next_ == first_ + block_.size()) {
      first_ = next_;
      block_.resize(std::min(kBlock, runs_.runs_.size() - first_));
      runs_.runs_.read(first_, block_);
    }
    run_ = block_[next_ - first_];
  }
  ++next_;
  end_ += run_.triangles;
  return true;
}

void MeshObjects::append(const MeshObjects& others) {
  std::vector<std::optional<std::uint8_t>> numbers;
  for (const std::string& name : others.properties.all())
    numbers.push_back(properties.number(name));
  properties.drop_all(others.properties);
  const std::uint32_t first = names.count();
  if (numbers.empty()) {
    names.append(others.names);
  } else {
    others.names.for_each([&](std::uint32_t, FoundObject object) {
      std::erase_if(object.values, [&](const auto& value) { return !numbers[value.first]; });
      for (auto& [property, value] : object.values)
        property = *numbers[property];
      names.add(object);
    });
  }
  runs.append(others.runs, first);
}

}  // namespace meshhier::importing
