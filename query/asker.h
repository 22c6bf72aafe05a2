// What a row asks of a surface, and its answer.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "compare/cut_surface.h"
#include "execution/cancel.h"
#include "query/answers.h"
#include "query/row_source.h"

#include <cstdint>
#include <memory>
#include <span>

namespace meshhier::querying {

/// Answers rows of one kind. One call at a time; works in parallel.
class Asker {
 public:
  virtual ~Asker() = default;
  /// Whether a row asks anything: its numbers are finite, its place is no farther than 1e150, and a
  /// direction leads somewhere.
  virtual bool can_ask(std::span<const double> row) const = 0;
  /// Returns a place where the looking up begins, relative to the origin; `box`: of the surface.
  virtual Vec3d start_of(std::span<const double> row, const BoundsD& box) const = 0;
  /// Fills in all but Answer::row. `rows`: of numbers, one after the other, that can_ask(); those
  /// that follow each other should be near each other, for speed only. An answer depends on its row
  /// and the surface alone, to the bit. Throws Error(io | corrupt | interrupted).
  virtual void ask(std::span<const double> rows, std::span<Answer> answers,
                   const execution::CancelToken& cancel) = 0;
  /// Returns how many different tiles were read.
  virtual std::uint64_t tiles_read() const = 0;
};

/// Facts that an asker is made for.
struct AskerOptions {
  RowKind kind{};
  bool has_sides = false;  ///< of points
  Vec3d origin{};          ///< of the surface's coordinates
  std::uint64_t cache_bytes = 0;
};

/// `surface` must outlive the asker, and have a triangle.
std::unique_ptr<Asker> make_asker(const comparing::CutSurface& surface,
                                  const AskerOptions& options);

}  // namespace meshhier::querying
