# What most files include is read once for all: the standard library, and JSON, which takes longer than all of it.

# meshhier_common_headers(LIBRARY...)
#
# Gives them to libraries that include JSON anyhow: others would take longer, and programs are compiled in another way (-fPIE). Does so only where files are compiled together: elsewhere
# each file has to name all that it needs. Sets `common_headers` to the library that has them, or to nothing.
function(meshhier_common_headers)
  if(NOT CMAKE_UNITY_BUILD)
    return()
  endif()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/common_headers.cpp CONTENT "")
  add_library(meshhier_common_headers STATIC ${PROJECT_BINARY_DIR}/common_headers.cpp)
  target_link_libraries(meshhier_common_headers PUBLIC meshhier_options nlohmann_json::nlohmann_json)
  target_precompile_headers(meshhier_common_headers PRIVATE
    <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <mutex> <nlohmann/json.hpp> <optional> <span> <string> <thread> <variant>
    <vector>)
  foreach(library IN LISTS ARGN)
    target_precompile_headers(${library} REUSE_FROM meshhier_common_headers)
  endforeach()
  set(common_headers meshhier_common_headers PARENT_SCOPE)
endfunction()
