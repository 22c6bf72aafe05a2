# Makes the documents of the installed tree what Debian wants of a package; CPack runs this before it packs.
set(share "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr/share")
set(documents "${share}/doc/meshhier")

# Without its name and time in the stream: equal input gives equal bytes.
function(compress file)
  execute_process(COMMAND gzip -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

if(CPACK_DEBIAN_PACKAGE_NAME STREQUAL "meshhier-osgb")  # it takes the other package, whose documents are its own
  file(MAKE_DIRECTORY "${share}/doc")
  file(CREATE_LINK meshhier "${share}/doc/meshhier-osgb" SYMBOLIC)
  return()
endif()

string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, if that is set
file(WRITE "${documents}/changelog.Debian"
"meshhier (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * See changelog.gz for what is new.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}
")
compress("${documents}/changelog.Debian")
file(RENAME "${documents}/CHANGELOG.md" "${documents}/changelog")
compress("${documents}/changelog")
compress("${share}/man/man1/meshhier.1")
file(REMOVE "${documents}/LICENSE")  # /usr/share/common-licenses has it
file(COPY "${CMAKE_CURRENT_LIST_DIR}/copyright" DESTINATION "${documents}"
     FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
file(COPY "${CMAKE_CURRENT_LIST_DIR}/systemd/meshhier.default" DESTINATION "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/etc/default"
     FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
file(RENAME "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/etc/default/meshhier.default" "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/etc/default/meshhier")
# There is no report in Debian's tracker that this package closes: it is not made for Debian's own archive.
file(WRITE "${share}/lintian/overrides/meshhier" "meshhier: initial-upload-closes-no-bugs *\n")
