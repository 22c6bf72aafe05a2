// MTL files (Wavefront's material libraries of OBJ files), as far as a textured mesh shows their
// materials.
#pragma once

#include "mesh_io/input_stream.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace meshhier::mesh_io {

/// A picture on a surface: a coordinate c shows the picture at c * scale + offset.
struct MtlMap {
  std::string file;  ///< as the line has it, not empty
  std::array<double, 2> scale{1, 1}, offset{0, 0};
  bool clamp = false;  ///< -clamp on: the picture does not repeat
};

struct MtlMaterial {
  std::string name;  ///< the rest of the line of newmtl; may be empty
  /// Kd as the file has it; MtlColours tells what it means.
  std::optional<std::array<float, 3>> colour;
  float opacity = 1;              ///< d, else 1 - Tr, up to 1; 1 if that is 0
  std::optional<MtlMap> picture;  ///< map_Kd, else map_Ke, else map_Ka
  std::optional<MtlMap> alpha;    ///< map_d
};

/// Reads the colours of a library: they are numbers from 0 to 1, or bytes if all are whole numbers
/// from 0 to 255 and some go beyond 2, as a few programs write them.
class MtlColours {
 public:
  void add(const MtlMaterial& material);
  /// Requires that all materials were added.
  bool are_bytes() const { return all_whole_ && most_ > 2; }
  /// Returns a material's colour, from 0 to 1; white if it has none. Numbers beyond become 0 or 1.
  std::array<float, 3> shown(const MtlMaterial& material) const;

 private:
  bool all_whole_ = true;
  float most_ = 0;
};

/// Visits the materials of a library in their order. Reads
///
///   newmtl NAME                 NAME may have spaces
///   Kd r [g b]
///   d [-halo] a | Tr a
///   map_Kd [options] FILE       FILE may have spaces, and stand in quotes; without it map_Ke or
///                               map_Ka: some programs write nothing else
///   map_d [options] FILE
///
/// in UTF-8, or in UTF-16 with a byte order mark, with words in any case, and passes all other
/// statements over, as well as those before the first newmtl. If a statement comes twice, the last
/// one counts; of maps the first one does. Options: -o and -s are used, and -clamp; -blendu,
/// -blendv, -bm, -boost, -cc, -imfchan, -mm, -t, -texres and -type are passed over. Throws
/// Error(input) naming the line, Error(io).
void read_mtl(InputStream& stream, const std::filesystem::path& path,
              const std::function<void(const MtlMaterial&)>& visit);

}  // namespace meshhier::mesh_io
