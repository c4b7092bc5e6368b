# `cmake --install`: the program with its manual pages, the libraries with their headers, and what finds them: a CMake package and a
# pkg-config file.
include(CMakePackageConfigHelpers)

# Folders of headers; the libraries in them, each before those that it may use.
set(postlens_header_folders core lens pictures records reproject focus motionblur scene tracer planner compare sweep chart)
set(postlens_installed_libraries chart sweep compare planner tracer scene motionblur focus reproject records pictures
    linked_pictures fits traced prescription wave lommel lens core)

set(targets postlens_options fftw3 fftw3f libdeflate_library)
foreach(name IN LISTS postlens_installed_libraries)
  set_target_properties(postlens_${name} PROPERTIES EXPORT_NAME ${name})
  list(APPEND targets postlens_${name})
endforeach()
set_target_properties(postlens_options PROPERTIES EXPORT_NAME options)
# Headers say #include "focus/focus.h"; <postlens/focus/focus.h> works as well.
target_include_directories(postlens_options INTERFACE
  "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/postlens>" "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")

install(TARGETS postlens RUNTIME COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/apps/completion/postlens"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program)
find_program(POSTLENS_HELP2MAN help2man)
if(POSTLENS_HELP2MAN AND NOT CMAKE_CROSSCOMPILING AND NOT POSTLENS_SANITIZE AND NOT POSTLENS_FUZZ)
  add_custom_command(OUTPUT "${PROJECT_BINARY_DIR}/man/postlens.1"
    COMMAND "${PROJECT_SOURCE_DIR}/scripts/man_pages.sh" "$<TARGET_FILE:postlens>" "${PROJECT_BINARY_DIR}/man"
    DEPENDS postlens "${PROJECT_SOURCE_DIR}/scripts/man_pages.sh" VERBATIM)
  add_custom_target(man ALL DEPENDS "${PROJECT_BINARY_DIR}/man/postlens.1")
  install(DIRECTORY "${PROJECT_BINARY_DIR}/man/" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program)
endif()
install(TARGETS ${targets} EXPORT postlensTargets ARCHIVE COMPONENT library)
foreach(folder IN LISTS postlens_header_folders)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/postlens" COMPONENT library
    FILES_MATCHING PATTERN "*.h")
endforeach()

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/postlens")
install(EXPORT postlensTargets NAMESPACE postlens:: DESTINATION "${package_folder}" COMPONENT library)
configure_package_config_file(cmake/postlensConfig.cmake.in "${PROJECT_BINARY_DIR}/postlensConfig.cmake"
  INSTALL_DESTINATION "${package_folder}")
# Before 1.0 a minor version may change anything.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/postlensConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/postlensConfig.cmake" "${PROJECT_BINARY_DIR}/postlensConfigVersion.cmake"
  DESTINATION "${package_folder}" COMPONENT library)

list(TRANSFORM postlens_installed_libraries PREPEND "-lpostlens_" OUTPUT_VARIABLE postlens_pc_libraries)
list(JOIN postlens_pc_libraries " " postlens_pc_libraries)
file(RELATIVE_PATH postlens_pc_up "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
configure_file(cmake/postlens.pc.in "${PROJECT_BINARY_DIR}/postlens.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/postlens.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT library)
