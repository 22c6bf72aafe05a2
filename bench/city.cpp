#include "bench/city.h"

#include "bench/buffered_file.h"
#include "bench/noise.h"
#include "bench/require_range.h"

#include <array>
#include <filesystem>
#include <string>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

constexpr std::uint64_t kStreet = 50;     // buildings of a street
constexpr std::uint64_t kDistrict = 100;  // streets of a district
constexpr double kLot = 30;               // metres
constexpr std::uint64_t kOneIn = 100;     // buildings without a row, and rows without a building

/// A building as its number and the seed have it.
struct Building {
  std::uint64_t number;
  std::uint64_t seed;

  double part(std::uint64_t what) const { return uniform_at(seed, 8 * number + what); }
  std::uint64_t storeys() const { return 1 + static_cast<std::uint64_t>(part(0) * 20); }
  double height() const { return 3.25 * static_cast<double>(storeys()) + 1.5; }
  std::string name() const {
    const std::uint64_t street = number / kStreet;
    return fmt::format("district {:02}/street {:02}/building {:07}", street / kDistrict,
                       street % kDistrict, number);
  }
};

/// Writes five walls and a roof as a box without a floor, z up.
void write_building(const Building& building, BufferedFile& out) {
  const double width = 8 + 16 * building.part(1), depth = 8 + 16 * building.part(2);
  const double x = kLot * static_cast<double>(building.number % 512);
  const double y = kLot * static_cast<double>(building.number / 512);
  const std::array<std::array<double, 2>, 4> corners{
      {{x, y}, {x + width, y}, {x + width, y + depth}, {x, y + depth}}};
  out.print("o {}\n", building.name());
  for (const double z : {0.0, building.height()}) {
    for (const auto& [east, north] : corners)
      out.print("v {:.3f} {:.3f} {:.2f}\n", east, north, z);
  }
  out.print("f -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\nf -4 -3 -2 -1\n");
}

void write_row(const Building& building, const std::string& name, BufferedFile& out) {
  constexpr std::array kOwners{"the city", "\"Smith, Jones & Co\"", "", "Åse Ødegård"};
  out.print("{},{:.2f},{},{}-{:02}-01,{},{}\n", name, building.height(), building.storeys(),
            1850 + static_cast<int>(building.part(3) * 170),
            1 + static_cast<int>(building.part(4) * 12), building.part(5) < 0.1 ? "true" : "false",
            kOwners[static_cast<std::size_t>(building.part(6) * kOwners.size())]);
}

}  // namespace

CitySizes write_city(storage::FileSystem& files, const storage::OutputRequest& mesh,
                     const CityOptions& options) {
  require_range("buildings", options.buildings, 1, std::uint64_t{1} << 24);
  std::filesystem::path table_path = mesh.path;
  table_path.replace_extension(".csv");
  storage::OutputFile city(files, mesh), table(files, {table_path, mesh.replace, {}});
  BufferedFile shapes(city.file()), rows(table.file());
  shapes.print("# meshgen city: {} buildings, seed {}\n", options.buildings, options.seed);
  rows.print("name,height,storeys,built,listed,owner\n");
  for (std::uint64_t i = 0; i < options.buildings; ++i) {
    const Building building{i, options.seed};
    write_building(building, shapes);
    if (i % kOneIn != kOneIn / 2)
      write_row(building, building.name(), rows);
    else
      write_row(building, fmt::format("torn down {}", i), rows);
  }
  shapes.flush();
  rows.flush();
  table.publish();
  city.publish();
  return {shapes.size(), rows.size()};
}

}  // namespace meshhier::bench
