# Installs what the program prints. Given: `program`, with an emulator before it if need be, and `made`, a directory for it.
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(zsh_folder vendor-completions)  # where Debian's zsh looks for those of packages
else()
  set(zsh_folder site-functions)
endif()

function(install_printed folder name)
  execute_process(COMMAND ${program} ${ARGN} OUTPUT_FILE "${made}/${name}" COMMAND_ERROR_IS_FATAL ANY)
  file(INSTALL DESTINATION "${CMAKE_INSTALL_PREFIX}/share/${folder}" TYPE FILE FILES "${made}/${name}")
endfunction()

file(MAKE_DIRECTORY "${made}")
install_printed(man/man1 meshhier.1 manual)
install_printed(bash-completion/completions meshhier completion bash)
install_printed(zsh/${zsh_folder} _meshhier completion zsh)
install_printed(fish/vendor_completions.d meshhier.fish completion fish)
