#include "geodesy/map_code.h"

#include "base/plain_text.h"
#include "geodesy/proj_objects.h"

#include <charconv>
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
  if (code.horizontal == 0) {
    const char* const wkt =
        library().as_wkt(context.get(), horizontal.get(), PJ_WKT1_ESRI, nullptr);
    code.wkt = wkt == nullptr ? "" : wkt;
  }
  return code;
}

}  // namespace meshhier::geodesy
