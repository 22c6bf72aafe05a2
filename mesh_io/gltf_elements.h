// The elements of an accessor, one after another.
#pragma once

#include "mesh_io/gltf_bytes.h"
#include "mesh_io/gltf_file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// The place of elements. All of them are within `range`; without one they are zeros.
struct GltfElementSource {
  std::string name;  ///< "accessors[3]", for messages
  std::optional<GltfRange> range{};
  std::uint64_t stride = 0;
  std::uint64_t count = 0;
  GltfComponent component = GltfComponent::f32;
  std::uint32_t components = 1;
  bool normalized = false;
  std::optional<GltfSparse> sparse{};
};

/// Returns the place of an accessor's elements, its ranges checked. Throws Error(input) naming it
/// if it reaches beyond its view, if its elements overlap each other, or if it has very many zeros
/// that no byte stands for; and as GltfFile::view().
GltfElementSource gltf_elements_of(GltfFile& file, std::uint32_t accessor);

/// Reads elements forwards through a window of 64 KiB. For one thread.
class GltfElements {
 public:
  /// Integers of a normalized accessor become fractions, or stay as they are stored.
  enum class Integers : std::uint8_t { fractions, stored };
  static constexpr std::size_t kMostComponents = 16;

  /// `file` must outlive it. Throws as gltf_elements_of() for the sparse values.
  GltfElements(GltfFile& file, GltfElementSource source, Integers integers = Integers::fractions);

  const GltfElementSource& source() const { return source_; }
  std::uint64_t size() const { return source_.count; }

  /// Returns element `index` < size(), valid until the next call. `index` never falls from one call
  /// to the next. Throws Error(input) naming the accessor if sparse indices are not ascending or
  /// beyond its elements, Error(io).
  std::span<const double> at(std::uint64_t index);

 private:
  struct Replaced;
  using Decode = void (*)(const std::byte*, std::span<double>);

  void load(std::uint64_t index);
  void replace(std::uint64_t index);

  GltfFile* file_;
  GltfElementSource source_;
  Decode decode_;
  std::shared_ptr<Replaced> replaced_;
  std::vector<std::byte> window_;
  std::uint64_t first_ = 0, loaded_ = 0;  ///< elements in the window
  std::array<double, kMostComponents> element_{};
};

}  // namespace meshhier::mesh_io
