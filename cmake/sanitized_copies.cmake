# Second forms of libraries, compiled with sanitizers, in the same build: what tests read bytes from outside with. Test programs
# themselves are compiled once and linked with either.

# meshhier_sanitized_copies(LIBRARY...)
#
# Makes LIBRARY_sanitized of each static library: of the same sources, with the same definitions, linked with the sanitized forms of
# those of its libraries that are named too. meshhier_options must be among the libraries that they link, directly or not.
# Their code has assertions. Optimisation that is asked for a single source is left out, and so are the checks of sizes of objects,
# sums of pointers, arguments that may not be null and types behind virtual calls: they take a quarter of the compiler's time.
# The preset `asan` has them.
function(meshhier_sanitized_copies)
  foreach(library IN LISTS ARGN)
    get_target_property(joined ${library} MESHHIER_JOINED_INTO)
    if(joined)
      message(FATAL_ERROR "${library} is compiled in ${joined} (cmake/joined_units.cmake): a copy of it would be empty")
    endif()
    get_target_property(directory ${library} SOURCE_DIR)
    get_target_property(sources ${library} SOURCES)
    list(TRANSFORM sources PREPEND ${directory}/ REGEX "^[^/]")
    add_library(${library}_sanitized STATIC EXCLUDE_FROM_ALL ${sources})
    target_link_libraries(${library}_sanitized PUBLIC meshhier_sanitizers)
    set_target_properties(${library}_sanitized PROPERTIES COMPILE_WARNING_AS_ERROR OFF)
    target_compile_options(${library}_sanitized PRIVATE
      -Og -g1 -UNDEBUG -D_GLIBCXX_ASSERTIONS
      -fno-sanitize=object-size,vptr,pointer-overflow,nonnull-attribute,returns-nonnull-attribute)
    foreach(property COMPILE_DEFINITIONS INCLUDE_DIRECTORIES SYSTEM UNITY_BUILD INTERFACE_INCLUDE_DIRECTORIES PRECOMPILE_HEADERS)
      get_target_property(value ${library} ${property})
      if(NOT value STREQUAL "value-NOTFOUND")
        set_target_properties(${library}_sanitized PROPERTIES ${property} "${value}")
      endif()
    endforeach()
    foreach(property SKIP_UNITY_BUILD_INCLUSION COMPILE_DEFINITIONS)
      foreach(source IN LISTS sources)
        get_source_file_property(value ${source} TARGET_DIRECTORY ${library} ${property})
        if(value)
          set_source_files_properties(${source} PROPERTIES ${property} "${value}")
        endif()
      endforeach()
    endforeach()
    get_target_property(headers ${library} PRECOMPILE_HEADERS_REUSE_FROM)
    if(headers)
      target_precompile_headers(${library}_sanitized REUSE_FROM ${headers}_sanitized)
    endif()
    get_target_property(links ${library} LINK_LIBRARIES)
    foreach(link IN LISTS links)
      if(link IN_LIST ARGN)
        target_link_libraries(${library}_sanitized PUBLIC ${link}_sanitized)
      else()
        target_link_libraries(${library}_sanitized PUBLIC ${link})
      endif()
    endforeach()
  endforeach()
endfunction()
