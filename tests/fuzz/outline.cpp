// The input of the target `outline`: a GLB, or, if it does not begin with "glTF", what makes one,
// with a JSON as it must be, little endian:
//
//   u8  polylines   one less than there are, modulo 64
//   u16 vertices    two a polyline and these
//   the BIN chunk, cut or filled up with zeros to its size
#include "hierarchy/outline.h"

#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "storage/format/outline_glb.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

/// Positions of the input, so that the JSON has their box.
Outline make_outline(Take& take) {
  const std::uint32_t polylines = 1U + take.upto<std::uint8_t>(63);
  const std::uint32_t vertices = 2 * polylines + take.number<std::uint16_t>() % 4096U;
  Outline outline;
  for (std::uint32_t i = 1; i < polylines; ++i)
    outline.starts.push_back(2 * i);
  outline.starts.push_back(vertices);
  Take positions = take;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    Vec3f p;
    for (float* coordinate : {&p.x, &p.y, &p.z}) {
      *coordinate = positions.number<float>();
      if (!std::isfinite(*coordinate))
        *coordinate = 0;
    }
    outline.vertices.push_back(p);
  }
  return outline;
}

std::vector<std::byte> make_glb(Take take) {
  const Outline outline = make_outline(take);
  std::vector<std::byte> bytes = storage::encode_outline(outline, {0, 0.5, 0});
  const std::size_t segments = outline.vertices.size() - outline.polyline_count();
  const std::size_t bin = 12 * outline.vertices.size() + 4 * segments;
  std::copy_n(take.rest().begin(), std::min(bin, take.rest().size()),
              bytes.end() - static_cast<std::ptrdiff_t>(bin));
  return bytes;
}

void check_outline(const Outline& outline) {
  require(outline.starts.size() >= 1 && outline.starts.front() == 0, "starts begin at 0");
  require(outline.starts.back() == outline.vertices.size(), "starts end behind the last");
  for (std::size_t i = 0; i < outline.polyline_count(); ++i)
    require(outline.starts[i + 1] >= outline.starts[i] + 2, "no line without an end");
  const auto bytes = storage::encode_outline(outline, {});
  require(
      bytes.size() == storage::outline_bytes(outline.vertices.size(),
                                             outline.vertices.size() - outline.polyline_count()),
      "the size is known before");
  const Outline again = storage::decode_outline(bytes, "again.glb");
  require(again.vertices == outline.vertices && again.starts == outline.starts,
          "what is written is read again");
}

}  // namespace

void outline(Bytes input) {
  const bool is_glb = text_of(input).starts_with("glTF");
  const std::vector<std::byte> made = is_glb ? std::vector<std::byte>() : make_glb(Take(input));
  Outline read;
  const std::string refused = refusal({ErrorCode::corrupt}, "outline.glb: ", [&] {
    read = storage::decode_outline(is_glb ? input : Bytes(made), "outline.glb");
  });
  if (refused.empty())
    check_outline(read);
}

}  // namespace meshhier::tests::fuzz
