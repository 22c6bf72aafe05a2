// A raster of heights: a byte that tells which kind its name is of, then the file.
//
// Heights that are read are coordinates, or there are none; a row in two parts is the row.
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "mesh_io/coordinate_range.h"
#include "mesh_io/mosaic.h"
#include "support/memory_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

constexpr std::uint64_t kMostCells = 1 << 16;

void read_row(const mesh_io::Mosaic& mosaic, std::uint32_t row) {
  std::vector<double> whole(mosaic.columns()), parts(mosaic.columns());
  mosaic.read(row, 0, whole);
  for (const double height : whole)
    require(std::isnan(height) || mesh_io::is_coordinate(height), "a height is a coordinate");
  const std::size_t half = parts.size() / 2;
  mosaic.read(row, 0, std::span(parts).first(half));
  mosaic.read(row, static_cast<std::uint32_t>(half), std::span(parts).subspan(half));
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  require(std::ranges::equal(whole, parts, same), "a row is its parts");
}

}  // namespace

void raster(Bytes input) {
  Take take(input);
  constexpr const char* kNames[] = {"/models/a.tif", "/models/a.asc", "/models/N00E000.hgt"};
  const std::string name = kNames[take.upto<std::uint8_t>(2)];
  MemoryFiles files;
  files.put(name, text_of(take.rest()));
  files.put("/models/a.prj", R"(GEOGCS["x",UNIT["Degree",0.0174532925199433]])");
  refusal({ErrorCode::input}, "/models/", [&] {
    const mesh_io::Mosaic mosaic(files, {name});
    const std::uint64_t rows = std::max<std::uint64_t>(1, kMostCells / mosaic.columns());
    for (std::uint32_t row = 0; row < std::min<std::uint64_t>(rows, mosaic.rows()); ++row)
      read_row(mosaic, row);
  });
}

}  // namespace meshhier::tests::fuzz
