// Numbers from the sections of a tile.
#pragma once

#include "base/error.h"
#include "hierarchy/tree.h"
#include "storage/format/glb.h"
#include "storage/format/tile_plan.h"
#include "storage/io/little_endian.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace meshhier::storage {

/// The sections of a tile: bytes that nobody vouches for, as many as the plan says.
struct TileSections {
  const TilePlan& plan;
  std::span<const std::byte> bin;
  bool is_packed = false;  ///< triangles are as the codec gave them, turned and in another order
};

/// Reads single numbers of sections, for readers of whole tiles and of their triangles. Nothing is
/// checked: elements must be below the count of their section. Not to be kept: it refers to all
/// that it was made of.
class SectionReader {
 public:
  /// `name`: for messages. All must outlive it.
  SectionReader(const TileSections& sections, const Tree& tree, const std::string& name)
      : plan_(sections.plan),
        bin_(sections.bin),
        is_packed_(sections.is_packed),
        tree_(tree),
        name_(name) {}

 protected:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

  template <Scalar T>
  T get(const Section& section, std::size_t element, std::size_t component = 0) const {
    return load_little<T>(bin_.data() + section.offset + element * section.stride +
                          component * sizeof(T));
  }
  /// Returns a u16 or u32.
  std::uint32_t number(const Section& section, std::size_t element) const {
    return section.component == kU16 ? get<std::uint16_t>(section, element)
                                     : get<std::uint32_t>(section, element);
  }

  const TilePlan& plan_;
  std::span<const std::byte> bin_;
  bool is_packed_;
  const Tree& tree_;
  const std::string& name_;
};

}  // namespace meshhier::storage
