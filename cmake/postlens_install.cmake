# `cmake --install`: the program with its manual pages, the library with its headers, and what finds them: a CMake package and a
# pkg-config file.
include(CMakePackageConfigHelpers)

# The public library and the static libraries that it is made of, each before those that it may use.
set(postlens_installed_libraries api apps chart sweep compare planner tracer scene motionblur focus reproject records pictures
    linked_pictures fits traced prescription wave lommel lens core)

set(targets postlens_options fftw3f libdeflate_library cpp_httplib)
foreach(name IN LISTS postlens_installed_libraries)
  # Only the public headers are installed, so libraries that consist of headers are needed no more.
  get_target_property(links postlens_${name} INTERFACE_LINK_LIBRARIES)
  list(TRANSFORM links REPLACE "(CLI11::CLI11|glm::glm|nlohmann_json::nlohmann_json)" "$<BUILD_INTERFACE:\\1>")
  set_target_properties(postlens_${name} PROPERTIES INTERFACE_LINK_LIBRARIES "${links}")
  if(NOT name STREQUAL api)
    set_target_properties(postlens_${name} PROPERTIES EXPORT_NAME ${name})
  endif()
  list(APPEND targets postlens_${name})
endforeach()
set_target_properties(postlens_options PROPERTIES EXPORT_NAME options)
target_include_directories(postlens_options INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")

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
install(DIRECTORY "${PROJECT_SOURCE_DIR}/postlens" "${PROJECT_BINARY_DIR}/include/postlens"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT library
  FILES_MATCHING PATTERN "*.h" PATTERN "internals.h" EXCLUDE)

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/postlens")
install(EXPORT postlensTargets NAMESPACE postlens:: DESTINATION "${package_folder}" COMPONENT library)
configure_package_config_file(cmake/postlensConfig.cmake.in "${PROJECT_BINARY_DIR}/postlensConfig.cmake"
  INSTALL_DESTINATION "${package_folder}")
# Before 1.0 a minor version may change anything.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/postlensConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/postlensConfig.cmake" "${PROJECT_BINARY_DIR}/postlensConfigVersion.cmake"
  DESTINATION "${package_folder}" COMPONENT library)

list(TRANSFORM postlens_installed_libraries PREPEND "-lpostlens_" OUTPUT_VARIABLE postlens_pc_libraries)
list(TRANSFORM postlens_pc_libraries REPLACE "^-lpostlens_api$" "-lpostlens")
list(JOIN postlens_pc_libraries " " postlens_pc_libraries)
file(RELATIVE_PATH postlens_pc_up "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
configure_file(cmake/postlens.pc.in "${PROJECT_BINARY_DIR}/postlens.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/postlens.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT library)
