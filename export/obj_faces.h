// The faces of an OBJ, object by object: all of one stand behind its name, whichever tiles have
// them.
//
//     part 0   f (house 2)  f (house 1)          o house 1    f of part 0   f of part 1
//     part 1   f (house 1)                  ->   o house 2    f of part 0
#pragma once

#include "export/cut_part.h"
#include "hierarchy/value_channels.h"
#include "partition/external_sort.h"
#include "storage/io/file.h"
#include "storage/io/spool.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <tuple>

namespace meshhier::exporting {

struct ObjFace {
  std::uint32_t object = 0;
  std::uint32_t part = 0;
  std::uint32_t number = 0;              ///< in the part
  std::array<std::uint32_t, 3> places;   ///< of the cut
  std::array<std::uint32_t, 3> corners;  ///< vertices of the part
};
static_assert(sizeof(ObjFace) == 36);

/// For one thread. O(n log n) in the memory given, out of core.
class ObjFaces {
 public:
  ObjFaces(storage::FileSystem& files, const std::filesystem::path& scratch, PlacedValue object,
           std::uint64_t memory_bytes)
      : object_(object),
        pool_(memory_bytes / 4),
        scratch_(files, scratch, pool_),
        faces_(scratch_, memory_bytes / 4 * 3) {}

  void add(std::uint32_t part, const CutPart& mesh);
  /// Calls visit(face) for all, once: by object, then by part, then in their order.
  void for_each(const std::function<void(const ObjFace& face)>& visit);

 private:
  struct Order {
    std::tuple<std::uint32_t, std::uint32_t, std::uint32_t> operator()(const ObjFace& face) const {
      return {face.object, face.part, face.number};
    }
  };

  PlacedValue object_;
  storage::MemoryPool pool_;
  storage::ScratchFile scratch_;
  partition::ExternalSort<ObjFace, Order> faces_;
};

}  // namespace meshhier::exporting
