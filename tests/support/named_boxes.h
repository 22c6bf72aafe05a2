// A town of boxes, an object each, whose names lie in another order than the boxes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace meshhier::tests {

/// The name of a box; numbers that follow each other have names far apart.
inline std::string box_name(std::uint32_t number) {
  return "street " + std::to_string(number * 37 % 101) + "/box " + std::to_string(number);
}

/// Writes the mesh, an OBJ, and beside it a table, NAME.csv, with the heights and uses of all boxes
/// but the first. `use`: of each.
inline void write_named_boxes(std::filesystem::path file, std::uint32_t count,
                              const std::string& use = "flats") {
  std::ofstream mesh(file);
  std::ofstream table(file.replace_extension(".csv"));
  table << "name,height,use\n";
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t x = 3 * (i % 12), y = 3 * (i / 12), height = 1 + i % 7;
    mesh << "o " << box_name(i) << '\n';
    for (const std::uint32_t z : {0U, height}) {
      for (const auto& [east, north] : {std::pair{0, 0}, {2, 0}, {2, 2}, {0, 2}})
        mesh << "v " << x + static_cast<std::uint32_t>(east) << ' '
             << y + static_cast<std::uint32_t>(north) << ' ' << z << '\n';
    }
    mesh << "f -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\nf -4 -3 -2 -1\n";
    if (i > 0)
      table << box_name(i) << ',' << height << ',' << use << '\n';
  }
}

}  // namespace meshhier::tests
