// What GDAL writes into tags of its own: the number for no height, scale, offset and unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

struct GdalTags {
  std::optional<double> absent;  ///< the sample that stands for no height; perhaps NaN
  double scale = 1, offset = 0;  ///< a height is sample * scale + offset
  std::optional<double> metres;  ///< of the unit of heights, if it is told and known
  std::string unknown_unit;
};

/// Reads the first band's. What is no number, or no XML, counts as not there.
GdalTags read_gdal_tags(std::string_view metadata, std::string_view nodata);

}  // namespace meshhier::mesh_io
