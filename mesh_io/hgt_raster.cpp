// Heights of SRTM: a file a degree, named by its south-western corner ("N53E027.hgt"), of 1201 or
// 3601 rows of as many big-endian integers of 16 bits, from north to south. -32768 is no height.
// It may be packed by gzip.
#include "mesh_io/blocked_raster.h"
#include "mesh_io/hgt_name.h"
#include "mesh_io/inflated_file.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint16_t kAbsent = 0x8000;

class HgtRaster final : public BlockedRaster {
 public:
  explicit HgtRaster(std::unique_ptr<storage::File> file) : file_(std::move(file)) {
    if (is_packed_hgt_name(file_->path().filename().string())) {
      const std::uint64_t bytes = told_bytes(*file_);
      file_ = inflated(std::move(file_), bytes);
    }
    const auto corner = hgt_corner(file_->path().filename().string());
    const auto side = hgt_side(file_->size());
    if (!corner || !side)
      fail_file(file_->path(),
                "is no file of SRTM: these have a name such as N53E027.hgt and 1201 "
                "or 3601 rows");
    const double step = 1.0 / (*side - 1);
    RasterHead head{.path = file_->path(), .columns = *side, .rows = *side};
    head.map = {{corner->x, corner->y + 1}, {step, 0}, {0, -step}};
    head.keys.kind = geodesy::MapKind::degrees;
    head.keys.crs = "EPSG:4326+5773";  // above the geoid EGM96
    head.keys.is_point = true;
    head.may_have_voids = true;
    set(std::move(head), {*side, rows_of_block(*side, 2 * *side), 2});
  }

 private:
  void decode(const BlockPlace& place, std::span<std::byte> into) const override {
    const std::uint64_t offset = std::uint64_t{place.row} * into.size();
    file_->read_exact(offset, into.first(std::min(into.size(), file_->size() - offset)));
  }

  void convert(const std::byte* from, std::span<double> heights) const override {
    for (double& height : heights) {
      const auto sample = static_cast<std::uint16_t>(std::to_integer<unsigned>(from[0]) << 8U |
                                                     std::to_integer<unsigned>(from[1]));
      height = sample == kAbsent ? std::numeric_limits<double>::quiet_NaN()
                                 : std::bit_cast<std::int16_t>(sample);
      from += 2;
    }
  }

  std::unique_ptr<storage::File> file_;
};

}  // namespace

std::unique_ptr<HeightRaster> open_hgt(storage::FileSystem& files,
                                       const std::filesystem::path& path) {
  return std::make_unique<HgtRaster>(files.open(path));
}

}  // namespace meshhier::mesh_io
