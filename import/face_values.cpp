#include "import/face_values.h"

#include "base/error.h"
#include "import/append_value.h"
#include "partition/external_sort.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>

namespace meshhier::importing {
namespace {

/// A triangle of a group, whose number is that of its first triangle.
struct Member {
  std::uint64_t value;  ///< its bits
  std::uint32_t group, triangle;
};
struct MemberKey {
  std::tuple<std::uint32_t, std::uint64_t, std::uint32_t> operator()(const Member& m) const {
    return {m.group, m.value, m.triangle};
  }
};
struct Numbered {
  std::uint32_t triangle, group;
};
struct TriangleKey {
  std::uint32_t operator()(const Numbered& numbered) const { return numbered.triangle; }
};

}  // namespace

FaceValues::FaceValues(const std::vector<ScalarAttribute>& attributes, const ImportRoom& room)
    : attributes_(attributes),
      room_(room),
      values_(room.scratch, kImportSpoolBytes),
      numbers_(room.scratch, kImportSpoolBytes),
      numbers_cursor_(numbers_, room.cancel),
      lookup_(values_) {
  for (const ScalarAttribute& attribute : attributes)
    none_.push_back(of_type(attribute.type, std::numeric_limits<double>::quiet_NaN()));
}

void FaceValues::add(std::span<const double> values) {
  if (!any())
    return;
  if (++triangles_ > UINT32_MAX) {
    throw Error(ErrorCode::input,
                "the input has 2^32 triangles or more with values of faces; split it, or build it "
                "with \"attributes\": \"none\"");
  }
  values_.append(values.empty() ? std::span<const double>(none_) : values);
}

/// One attribute after the other: triangles that are equal in those before stay together as long as
/// they are.
void FaceValues::compare() {
  for (std::size_t i = 0; i < attributes_.size(); ++i)
    split_groups(i);
}

void FaceValues::split_groups(std::size_t attribute) {
  partition::ExternalSort<Member, MemberKey> members(room_.scratch, room_.sort_bytes);
  {
    execution::SpoolCursor values(values_, room_.cancel);
    execution::SpoolCursor groups(numbers_, room_.cancel);
    for (std::uint64_t i = 0; i < triangles_; ++i) {
      members.add({std::bit_cast<std::uint64_t>(values.at(i * attributes_.size() + attribute)),
                   attribute == 0 ? 0 : groups.at(i), static_cast<std::uint32_t>(i)});
    }
  }
  members.sort();
  numbers_.clear();
  partition::ExternalSort<Numbered, TriangleKey> ordered(room_.scratch, room_.sort_bytes);
  Member first{};
  bool is_first = true;
  members.for_each_block([&](std::span<const Member> block) {
    room_.cancel.check();
    for (const Member& member : block) {
      if (is_first || member.group != first.group || member.value != first.value)
        first = member;
      is_first = false;
      ordered.add({member.triangle, first.triangle});
    }
  });
  ordered.sort();
  ordered.for_each_block([&](std::span<const Numbered> block) {
    room_.cancel.check();
    for (const Numbered& numbered : block)
      numbers_.append(numbered.group);
  });
}

std::span<const float> FaceValues::channels(std::uint32_t number) {
  channels_.clear();
  for (std::size_t i = 0; i < attributes_.size(); ++i) {
    const std::uint64_t first = (std::uint64_t{number} - 1) * attributes_.size();
    append_value(attributes_[i].type, number == 0 ? none_[i] : lookup_.at(first + i), channels_);
  }
  return channels_;
}

}  // namespace meshhier::importing
