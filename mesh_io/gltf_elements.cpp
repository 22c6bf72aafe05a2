#include "mesh_io/gltf_elements.h"

#include "storage/io/little_endian.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint64_t kWindowBytes = std::uint64_t{1} << 16;

/// Elements without bytes are zeros: one of so many must be replaced, else a line of JSON would
/// make billions.
constexpr std::uint64_t kMostZeros = 64;

template <class Stored>
Stored load_number(const std::byte* from) {
  if constexpr (std::is_same_v<Stored, float>)
    return storage::load_little<float>(from);
  else
    return static_cast<Stored>(storage::load_little<std::make_unsigned_t<Stored>>(from));
}

template <class Stored>
void decode_stored(const std::byte* from, std::span<double> to) {
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] = load_number<Stored>(from + i * sizeof(Stored));
}

/// Decodes fractions as the specification says (3.6.2.2), in floats.
template <class Stored>
void decode_fractions(const std::byte* from, std::span<double> to) {
  constexpr auto kMost = static_cast<float>(std::numeric_limits<Stored>::max());
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] =
        std::max(static_cast<float>(load_number<Stored>(from + i * sizeof(Stored))) / kMost, -1.0F);
}

auto decoder(GltfComponent component, bool as_fractions) {
  switch (component) {
    case GltfComponent::i8:
      return as_fractions ? decode_fractions<std::int8_t> : decode_stored<std::int8_t>;
    case GltfComponent::u8:
      return as_fractions ? decode_fractions<std::uint8_t> : decode_stored<std::uint8_t>;
    case GltfComponent::i16:
      return as_fractions ? decode_fractions<std::int16_t> : decode_stored<std::int16_t>;
    case GltfComponent::u16:
      return as_fractions ? decode_fractions<std::uint16_t> : decode_stored<std::uint16_t>;
    case GltfComponent::u32:
      return as_fractions ? decode_fractions<std::uint32_t> : decode_stored<std::uint32_t>;
    case GltfComponent::f32:
      break;
  }
  return decode_stored<float>;
}

/// Bytes from the beginning of the first element to the end of the last one.
std::uint64_t extent(const GltfElementSource& source) {
  const std::uint64_t element = source.components * bytes_of(source.component);
  return source.count == 0 ? 0 : (source.count - 1) * source.stride + element;
}

/// `source` with its elements in a view from `offset` on.
GltfElementSource placed(GltfFile& file, GltfElementSource source, std::uint32_t view,
                         std::uint64_t offset) {
  const GltfRange range = file.view(view);
  if (offset > range.size || extent(source) > range.size - offset) {
    file.fail(fmt::format("{} has {} bytes from byte {} of bufferViews[{}], which has {}",
                          source.name, extent(source), offset, view, range.size));
  }
  source.range = {range.bytes, range.offset + offset, extent(source)};
  return source;
}

}  // namespace

GltfElementSource gltf_elements_of(GltfFile& file, std::uint32_t number) {
  const GltfAccessor& accessor = file.document().accessors[number];
  GltfElementSource source{.name = fmt::format("accessors[{}]", number),
                           .stride = accessor.element_bytes(),
                           .count = accessor.count,
                           .component = accessor.component,
                           .components = accessor.components,
                           .normalized = accessor.normalized,
                           .sparse = accessor.sparse};
  if (!accessor.view) {
    const std::uint64_t given = accessor.sparse ? accessor.sparse->count : 0;
    if (accessor.count > kMostZeros * given) {
      file.fail(fmt::format("{} has no bufferView for its {} elements, and only {} sparse ones",
                            source.name, accessor.count, given));
    }
    return source;
  }
  const GltfView& view = file.document().views[*accessor.view];
  if (view.stride > 0 && view.stride < accessor.element_bytes()) {
    file.fail(fmt::format("{} has elements of {} bytes, but bufferViews[{}] has one each {}",
                          source.name, accessor.element_bytes(), *accessor.view, view.stride));
  }
  source.stride = view.stride > 0 ? view.stride : accessor.element_bytes();
  return placed(file, std::move(source), *accessor.view, accessor.offset);
}

/// The elements that stand for others.
struct GltfElements::Replaced {
  GltfElements indices, values;
  std::uint64_t next = 0;  ///< the next of them
  double last = -1;        ///< element that was replaced

  Replaced(GltfFile& file, const GltfElementSource& source, const GltfSparse& sparse,
           Integers integers)
      : indices(file, index_source(file, source, sparse)),
        values(file, value_source(file, source, sparse), integers) {}

  static GltfElementSource index_source(GltfFile& file, const GltfElementSource& source,
                                        const GltfSparse& sparse) {
    GltfElementSource of{.name = source.name + ".sparse.indices",
                         .stride = bytes_of(sparse.index_component),
                         .count = sparse.count,
                         .component = sparse.index_component};
    return placed(file, std::move(of), sparse.index_view, sparse.index_offset);
  }
  static GltfElementSource value_source(GltfFile& file, const GltfElementSource& source,
                                        const GltfSparse& sparse) {
    GltfElementSource of{.name = source.name + ".sparse.values",
                         .stride = source.components * bytes_of(source.component),
                         .count = sparse.count,
                         .component = source.component,
                         .components = source.components,
                         .normalized = source.normalized};
    return placed(file, std::move(of), sparse.value_view, sparse.value_offset);
  }
};

GltfElements::GltfElements(GltfFile& file, GltfElementSource source, Integers integers)
    : file_(&file),
      source_(std::move(source)),
      decode_(decoder(source_.component, source_.normalized && integers == Integers::fractions)) {
  if (source_.sparse)
    replaced_ = std::make_shared<Replaced>(file, source_, *source_.sparse, integers);
}

void GltfElements::load(std::uint64_t index) {
  file_->room().check();
  const std::uint64_t element = source_.components * bytes_of(source_.component);
  first_ = index;
  loaded_ =
      std::min(source_.count - index, std::max<std::uint64_t>(kWindowBytes / source_.stride, 1));
  window_.resize((loaded_ - 1) * source_.stride + element);
  source_.range->read(index * source_.stride, window_);
}

void GltfElements::replace(std::uint64_t index) {
  Replaced& replaced = *replaced_;
  while (replaced.next < replaced.indices.size()) {
    const double position = replaced.indices.at(replaced.next)[0];
    if (!(position > replaced.last && position < static_cast<double>(source_.count))) {
      file_->fail(
          fmt::format("{}.sparse.indices: item {} is {}, expected one above those before, "
                      "below {}",
                      source_.name, replaced.next, position, source_.count));
    }
    if (position > static_cast<double>(index))
      return;
    if (position == static_cast<double>(index))
      std::ranges::copy(replaced.values.at(replaced.next), element_.begin());
    replaced.last = position;
    ++replaced.next;
  }
}

std::span<const double> GltfElements::at(std::uint64_t index) {
  const std::span<double> element = std::span(element_).first(source_.components);
  if (source_.range) {
    if (index - first_ >= loaded_)
      load(index);
    decode_(window_.data() + (index - first_) * source_.stride, element);
  } else {
    std::ranges::fill(element, 0);
  }
  if (replaced_)
    replace(index);
  return element;
}

}  // namespace meshhier::mesh_io
