// The functions of PROJ, from its library.
//
// It is loaded when the first of them is needed, and no program is linked with it: with the
// libraries that it needs in turn every run would take 7 MiB more.
#pragma once

#include "storage/io/shared_library.h"

#include <proj.h>

/// The functions that are used, without the `proj_` before them.
#define MESHHIER_PROJ_FUNCTIONS(FUNCTION)              \
  FUNCTION(clone)                                      \
  FUNCTION(context_create)                             \
  FUNCTION(context_destroy)                            \
  FUNCTION(context_get_database_path)                  \
  FUNCTION(context_set_enable_network)                 \
  FUNCTION(coord)                                      \
  FUNCTION(coordoperation_get_method_info)             \
  FUNCTION(coordoperation_get_param)                   \
  FUNCTION(coordoperation_get_param_count)             \
  FUNCTION(coordoperation_has_ballpark_transformation) \
  FUNCTION(create)                                     \
  FUNCTION(create_crs_to_crs)                          \
  FUNCTION(create_crs_to_crs_from_pj)                  \
  FUNCTION(crs_get_coordinate_system)                  \
  FUNCTION(crs_get_coordoperation)                     \
  FUNCTION(crs_get_geodetic_crs)                       \
  FUNCTION(crs_get_sub_crs)                            \
  FUNCTION(cs_get_axis_count)                          \
  FUNCTION(cs_get_axis_info)                           \
  FUNCTION(cs_get_type)                                \
  FUNCTION(destroy)                                    \
  FUNCTION(ellipsoid_get_parameters)                   \
  FUNCTION(errno_reset)                                \
  FUNCTION(get_area_of_use)                            \
  FUNCTION(get_ellipsoid)                              \
  FUNCTION(get_id_auth_name)                           \
  FUNCTION(get_id_code)                                \
  FUNCTION(get_name)                                   \
  FUNCTION(get_source_crs)                             \
  FUNCTION(get_type)                                   \
  FUNCTION(identify)                                   \
  FUNCTION(int_list_destroy)                           \
  FUNCTION(is_crs)                                     \
  FUNCTION(list_destroy)                               \
  FUNCTION(list_get)                                   \
  FUNCTION(list_get_count)                             \
  FUNCTION(log_level)                                  \
  FUNCTION(normalize_for_visualization)                \
  FUNCTION(pj_info)                                    \
  FUNCTION(trans)                                      \
  FUNCTION(trans_get_last_used_operation)

namespace meshhier::geodesy::proj {

/// Has each function by its name without `proj_`, with PROJ's own type.
struct Library {
  storage::SharedLibrary file;
#define MESHHIER_MEMBER(name) \
  decltype(&::proj_##name) name = file.function<decltype(name)>("proj_" #name);
  MESHHIER_PROJ_FUNCTIONS(MESHHIER_MEMBER)
#undef MESHHIER_MEMBER
#undef MESHHIER_PROJ_FUNCTIONS
};

/// Returns the library, loaded by the first call; it stays until the program ends. Thread-safe.
/// Throws Error(io) if it is not there or has not all functions.
const Library& library();

}  // namespace meshhier::geodesy::proj
