// Points and rays as rows of numbers, from a text, a .npy or a PLY.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

namespace meshhier::querying {

/// What a row has: the place of a point, or the origin and the direction of a ray.
enum class RowKind { points, rays };

constexpr std::size_t columns_of(RowKind kind) {
  return kind == RowKind::points ? 3 : 6;
}

/// Visits consecutive rows: columns_of(kind) numbers each.
using RowVisitor = std::function<void(std::span<const double> numbers)>;

/// Reads all rows of a file, in their order, and returns how many there are. Memory: a few blocks.
/// `path`: a text, a .npy, both perhaps in gzip, or a PLY, of whose vertices rays have the normals
/// as directions; "-" is standard input, which has no PLY and no gzip. The content tells which it
/// is:
///
///     text    a row a line, numbers between blanks, commas, semicolons or tabs, as the first line
///             has them; between semicolons with decimal commas, too; behind # is a comment. The
///             first line may name columns: then those named x y z, and of rays dx dy dz, are
///             meant, each once, whatever else is there. Else there are no others.
///     .npy    float64, float32 or integers, of either byte order, C order, n x 3 or n x 6
///
/// "nan" and "inf" are numbers. `check` is called now and then and may throw. Throws Error(input)
/// naming file and line, or row; Error(io).
std::uint64_t read_rows(storage::FileSystem& files, const std::filesystem::path& path, RowKind kind,
                        const RowVisitor& visit, const std::function<void()>& check);

}  // namespace meshhier::querying
