# Folders whose files are compiled as one unit: headers are read, and templates compiled, once for all of them.

# meshhier_compile_together(FIRST LIBRARY...)
#
# The static library FIRST compiles the sources of the others, too. They keep their names and what they link, FIRST among it. To be
# called when all has been said of these libraries. Does so only where files are compiled together.
function(meshhier_compile_together first)
  if(NOT CMAKE_UNITY_BUILD)
    return()
  endif()
  foreach(library IN LISTS ARGN)
    get_target_property(directory ${library} SOURCE_DIR)
    get_target_property(sources ${library} SOURCES)
    list(TRANSFORM sources PREPEND ${directory}/ REGEX "^[^/]")
    target_sources(${first} PRIVATE ${sources})
    foreach(property COMPILE_DEFINITIONS COMPILE_OPTIONS INCLUDE_DIRECTORIES)
      get_target_property(value ${library} ${property})
      if(value)
        set_property(TARGET ${first} APPEND PROPERTY ${property} ${value})
      endif()
    endforeach()
    get_target_property(links ${library} LINK_LIBRARIES)
    list(REMOVE_ITEM links ${first})
    target_link_libraries(${first} PRIVATE ${links})
    set_target_properties(${library} PROPERTIES SOURCES ${PROJECT_BINARY_DIR}/common_headers.cpp DISABLE_PRECOMPILE_HEADERS ON)
    target_link_libraries(${library} PUBLIC ${first})
    set_target_properties(${library} PROPERTIES MESHHIER_JOINED_INTO ${first})
  endforeach()
endfunction()
