#include "compare/place_transform.h"

#include "base/error.h"
#include "base/flat_axes.h"
#include "base/number_text.h"
#include "base/plain_text.h"
#include "base/text_mark.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace meshhier::comparing {
namespace {

/// Whether what is moved by it has no volume left, but for rounding.
bool is_flat(const PlaceTransform& m) {
  return are_flat({m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]});
}

}  // namespace

PlaceTransform parse_transform(std::string_view text, const std::string& name) {
  text = without_mark(text);
  std::vector<double> numbers;
  const auto fail = [&](const std::string& found) {
    throw Error(ErrorCode::usage, fmt::format("{}: expected 16 numbers, a 4 x 4 matrix with rows "
                                              "first whose last row is 0 0 0 1; found {}",
                                              name, found));
  };
  constexpr std::string_view kBetween = " \t\r\n,;[]";
  for (std::size_t at = text.find_first_not_of(kBetween); at != std::string_view::npos;
       at = text.find_first_not_of(kBetween, at)) {
    const std::string_view word =
        text.substr(at, std::min(text.find_first_of(kBetween, at), text.size()) - at);
    at += word.size();
    const auto number = parse_number<double>(word);
    if (!number || !std::isfinite(*number))
      fail("\"" + plain_text(std::string(word.substr(0, 40)), 40) + "\"");
    numbers.push_back(*number);
    if (numbers.size() > 16)
      fail("more");
  }
  if (numbers.size() != 16)
    fail(fmt::format("{}", numbers.size()));
  PlaceTransform transform{};
  std::ranges::copy(numbers, transform.begin());
  if (transform[12] != 0 || transform[13] != 0 || transform[14] != 0 || transform[15] != 1)
    fail("another last row");
  if (is_flat(transform))
    fail("one that makes all flat: its first three rows lie in a plane");
  return transform;
}

Vec3d moved(const std::optional<PlaceTransform>& transform, Vec3d p) {
  if (!transform)
    return p;
  const PlaceTransform& m = *transform;
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

BoundsD moved_box(const std::optional<PlaceTransform>& transform, const BoundsD& box) {
  BoundsD all;
  for (int corner = 0; !box.empty() && corner < 8; ++corner) {
    all.add(moved(transform, {(corner & 1) != 0 ? box.max.x : box.min.x,
                              (corner & 2) != 0 ? box.max.y : box.min.y,
                              (corner & 4) != 0 ? box.max.z : box.min.z}));
  }
  return all;
}

}  // namespace meshhier::comparing
