#include "geodesy/map_code.h"

#include "base/plain_text.h"
#include "geodesy/proj_objects.h"

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace meshhier::geodesy {
namespace {

using proj::library;

/// Returns the code that the object has of itself; 0 if EPSG gave it none, or one that GeoTIFF
/// cannot hold.
std::uint16_t own_code(const PJ* part) {
  const char* authority = library().get_id_auth_name(part, 0);
  const char* text = library().get_id_code(part, 0);
  if (authority == nullptr || text == nullptr || std::strcmp(authority, "EPSG") != 0)
    return 0;
  constexpr std::uint16_t kUserDefined = 32767;
  std::uint16_t code = 0;
  const char* const end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, code);
  return error == std::errc{} && stop == end && code < kUserDefined ? code : 0;
}

/// Returns the code of the object in PROJ's database that is the same but perhaps for its name.
std::uint16_t found_code(PJ_CONTEXT* context, const PJ* part) {
  constexpr int kSameButForName = 70;  // percent, as PROJ's documentation has it
  int* confidence = nullptr;
  PJ_OBJ_LIST* const list = library().identify(context, part, "EPSG", nullptr, &confidence);
  std::uint16_t code = 0;
  if (list != nullptr && library().list_get_count(list) > 0 && confidence != nullptr &&
      confidence[0] >= kSameButForName)
    code = own_code(proj::Object(library().list_get(context, list, 0)).get());
  library().int_list_destroy(confidence);
  library().list_destroy(list);
  return code;
}

std::uint16_t code_of(PJ_CONTEXT* context, const PJ* part) {
  const std::uint16_t own = own_code(part);
  return own != 0 ? own : found_code(context, part);
}

/// Returns a parameter in degrees, in the map's unit, or as it is.
MapMethod::Parameter parameter_of(PJ_CONTEXT* context, const PJ* operation, int index,
                                  double unit_metres) {
  constexpr double kDegree = 0.017453292519943295;  // radians, PROJ's unit of angles
  const char *code = nullptr, *category = nullptr;
  double value = 0, factor = 1;
  library().coordoperation_get_param(context, operation, index, nullptr, nullptr, &code, &value,
                                     nullptr, &factor, nullptr, nullptr, nullptr, &category);
  const std::string_view kind = category == nullptr ? "" : category;
  const double scale = kind == "angular"  ? factor / kDegree
                       : kind == "linear" ? factor / unit_metres
                                          : 1;
  return {code == nullptr ? 0 : std::atoi(code), scale == 1 ? value : value * scale};
}

MapMethod method_of(PJ_CONTEXT* context, const PJ* crs) {
  MapMethod method;
  const proj::Object operation(library().crs_get_coordoperation(context, crs));
  const proj::Object geodetic(library().crs_get_geodetic_crs(context, crs));
  const proj::Object axes(library().crs_get_coordinate_system(context, crs));
  if (!operation || !geodetic || !axes)
    return method;
  library().cs_get_axis_info(context, axes.get(), 0, nullptr, nullptr, nullptr, &method.unit_metres,
                             nullptr, nullptr, nullptr);
  const char* code = nullptr;
  library().coordoperation_get_method_info(context, operation.get(), nullptr, nullptr, &code);
  method.method = code == nullptr ? 0 : std::atoi(code);
  const int count = library().coordoperation_get_param_count(context, operation.get());
  for (int i = 0; i < count; ++i)
    method.parameters.push_back(parameter_of(context, operation.get(), i, method.unit_metres));
  method.geodetic = code_of(context, geodetic.get());
  if (const proj::Object ellipsoid{library().get_ellipsoid(context, geodetic.get())}) {
    library().ellipsoid_get_parameters(context, ellipsoid.get(), &method.equator, nullptr, nullptr,
                                       &method.inverse_flattening);
  }
  return method;
}

}  // namespace

MapCode map_code(const std::string& crs) {
  const proj::Context context = proj::make_context();
  const proj::Object whole = proj::make_crs(context.get(), crs);
  const proj::Object horizontal = proj::horizontal_part(context.get(), whole.get());
  const proj::Object vertical = proj::vertical_part(context.get(), whole.get());
  MapCode code{.name = plain_text(library().get_name(whole.get()), proj::kLongestQuote)};
  code.horizontal = code_of(context.get(), horizontal.get());
  if (vertical)
    code.vertical = code_of(context.get(), vertical.get());
  if (code.horizontal == 0)
    code.method = method_of(context.get(), horizontal.get());
  return code;
}

}  // namespace meshhier::geodesy
