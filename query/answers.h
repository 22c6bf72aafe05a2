// The answers to points and rays, and how they are written.
#pragma once

#include "base/vec.h"
#include "query/row_source.h"
#include "storage/io/file.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::querying {

/// The answer to one row. Without padding: it is sorted by bytes.
struct Answer {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::uint64_t row = 0;
  /// From a point to the surface, below 0 inside if sides are asked for; from the origin of a ray
  /// to the hit, infinite if there is none. NaN: the row is no point, or no ray.
  double distance = kNone;
  Vec3d place{kNone, kNone, kNone};   ///< on the surface, in the input's coordinates
  Vec3d normal{kNone, kNone, kNone};  ///< of the triangle, of unit length
  std::int64_t index = -1, triangle = -1, object = -1;
  std::int32_t level = -1;
  std::int32_t side = 0;  ///< 1 outside, -1 inside, 0: not known
};

enum class AnswerFormat { csv, npy };

/// The columns that are written.
struct AnswerShape {
  RowKind kind{};
  bool has_objects = false;
  bool has_sides = false;
};

/// Returns the name of an object, for a CSV.
using ObjectNames = std::function<std::string(std::int64_t object)>;

/// Writes answers one after the other, buffered. For one thread; throws Error(io).
class AnswerWriter {
 public:
  /// `count`: how many there will be. `names`: of objects; only of a CSV, and if there are any.
  AnswerWriter(storage::File& file, AnswerFormat format, const AnswerShape& shape,
               std::uint64_t count, ObjectNames names = {});

  void add(std::span<const Answer> answers);
  /// Writes what is left.
  void finish() { flush(); }

 private:
  void add_csv(const Answer& answer);
  void add_npy(const Answer& answer);
  void flush();

  storage::File& file_;
  AnswerFormat format_;
  AnswerShape shape_;
  ObjectNames names_;
  std::uint64_t written_ = 0;
  std::string buffer_;
};

}  // namespace meshhier::querying
