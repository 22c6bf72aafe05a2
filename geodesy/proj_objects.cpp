#include "geodesy/proj_objects.h"

#include "base/error.h"
#include "base/plain_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::geodesy::proj {
namespace {

/// The WKT of a compound CRS has some 5,000 bytes.
constexpr std::size_t kLongestCrs = std::size_t{1} << 16;

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Returns whether a text has a part, in any case; `part` is in lower case.
bool contains(std::string_view text, std::string_view part) {
  return std::search(text.begin(), text.end(), part.begin(), part.end(),
                     [](char a, char b) { return lower(a) == b; }) != text.end();
}

/// Returns whether a word is like "+geoidgrids=/tmp/x.gtx".
bool is_path_parameter(std::string_view word) {
  const std::size_t sign = word.find('=');
  return sign != std::string_view::npos &&
         word.find_first_of("/\\~", sign) != std::string_view::npos;
}

/// Returns whether PROJ would open a file that the text chooses. Grids by their plain names are
/// those of PROJ's own folders.
bool names_files(std::string_view text) {
  if (contains(text, "parameterfile") || contains(text, "init="))
    return true;
  constexpr std::string_view kBetweenWords = " \t\r\n\"";
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of(kBetweenWords, begin), text.size());
    if (is_path_parameter(text.substr(begin, end - begin)))
      return true;
    begin = end + 1;
  }
  return false;
}

void check_text(const std::string& crs) {
  if (crs.size() > kLongestCrs)
    refuse(fmt::format("expected a CRS of at most {} bytes, found {}", kLongestCrs, crs.size()));
  if (crs.starts_with('{') || crs.find('\0') != std::string::npos)
    refuse("expected an EPSG code, WKT or a PROJ string, found " + in_quotes(crs));
  if (names_files(crs)) {
    refuse(in_quotes(crs) +
           " names files; use an EPSG code, or grids by their plain names from PROJ's folders");
  }
  if (crs.starts_with("ENU:")) {
    refuse(in_quotes(crs) +
           " is a local frame, no map: give its \"longitude\" and \"latitude\" instead");
  }
}

/// A PROJ string is a step of a computation unless it says that it is a CRS.
std::string as_crs(const std::string& text) {
  const bool is_step = text.find("+proj=") != std::string::npos &&
                       text.find('[') == std::string::npos &&
                       text.find("+type=") == std::string::npos;
  return is_step ? text + " +type=crs" : text;
}

}  // namespace

void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, what);
}

std::string in_quotes(std::string_view text) {
  return '"' + plain_text(text, kLongestQuote) + '"';
}

Context make_context() {
  Context context(library().context_create());
  library().context_set_enable_network(context.get(), 0);
  library().log_level(context.get(), PJ_LOG_NONE);
  const char* database = library().context_get_database_path(context.get());
  if (database == nullptr || *database == '\0') {
    throw Error(ErrorCode::io,
                "PROJ's database proj.db is not there: install the package proj-data, or set "
                "PROJ_DATA to the folder that has it");
  }
  return context;
}

Object make_crs(PJ_CONTEXT* context, const std::string& text) {
  check_text(text);
  Object crs(library().create(context, as_crs(text).c_str()));
  if (!crs || library().is_crs(crs.get()) == 0) {
    refuse("PROJ knows no CRS " + in_quotes(text) +
           "; expected an EPSG code (\"EPSG:32633\"), WKT or a PROJ string");
  }
  return crs;
}

Object horizontal_part(PJ_CONTEXT* context, const PJ* crs) {
  Object part(library().clone(context, crs));
  for (;;) {
    const PJ_TYPE type = library().get_type(part.get());
    if (type == PJ_TYPE_COMPOUND_CRS)
      part.reset(library().crs_get_sub_crs(context, part.get(), 0));
    else if (type == PJ_TYPE_BOUND_CRS)
      part.reset(library().get_source_crs(context, part.get()));
    else
      return part;
  }
}

Object vertical_part(PJ_CONTEXT* context, const PJ* crs) {
  Object whole(library().clone(context, crs));
  while (library().get_type(whole.get()) == PJ_TYPE_BOUND_CRS)
    whole.reset(library().get_source_crs(context, whole.get()));
  if (library().get_type(whole.get()) != PJ_TYPE_COMPOUND_CRS)
    return nullptr;
  return Object(library().crs_get_sub_crs(context, whole.get(), 1));
}

}  // namespace meshhier::geodesy::proj
