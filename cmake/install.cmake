# What `cmake --install` puts where, besides the libraries. Five components:
#   program    headpin, its manual, completion, scenarios, message types
#   runtime    the collision engine as a shared library
#   engine     what it takes to build with the collision engine; needs Eigen alone
#   libraries  the same for devices, render and scene
#   python     the Python package, where HEADPIN_PYTHON is ON
set(HEADPIN_RUNTIME_PACKAGE libheadpin-engine${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
include(CMakePackageConfigHelpers)
configure_package_config_file(cmake/headpin-config.cmake.in headpin-config.cmake
                              INSTALL_DESTINATION ${HEADPIN_CMAKE_DIR})
write_basic_package_version_file(headpin-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/headpin-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/headpin-config-version.cmake
        DESTINATION ${HEADPIN_CMAKE_DIR} COMPONENT engine)
include(cmake/third_parties.cmake)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/packages/copyright
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libheadpin-dev COMPONENT engine)
if(NOT HEADPIN_PROGRAM)
  return()
endif()

install(FILES cmake/FindLCM.cmake DESTINATION ${HEADPIN_CMAKE_DIR} COMPONENT libraries)
install(DIRECTORY assets/scenarios assets/designs assets/questionnaires assets/meshes assets/trials assets/throws
        DESTINATION ${CMAKE_INSTALL_DATADIR}/headpin COMPONENT program
        PATTERN "*.cpp" EXCLUDE)
# What `headpin report` fills in, where `./dev page` has built it.
install(FILES ${PROJECT_SOURCE_DIR}/build/report/page.html ${PROJECT_SOURCE_DIR}/build/report/play.html
  ${PROJECT_SOURCE_DIR}/build/report/watch.html
        DESTINATION ${CMAKE_INSTALL_DATADIR}/headpin COMPONENT program OPTIONAL)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/packages/copyright
              ${CMAKE_CURRENT_BINARY_DIR}/packages/headpin.spdx.json
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/headpin COMPONENT program)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/packages/copyright
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${HEADPIN_RUNTIME_PACKAGE} COMPONENT runtime)
# The pages of the documentation with their pictures; `headpin help topics` says where they are.
set(HEADPIN_DOC_DIR ${CMAKE_INSTALL_DATADIR}/doc/headpin)
file(GLOB_RECURSE pages RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS docs/*.md)
list(APPEND pages README.md CHANGELOG.md CONTRIBUTING.md)
set(installed_pages "")
foreach(page IN LISTS pages)
  set(written ${CMAKE_CURRENT_BINARY_DIR}/pages/${page})
  add_custom_command(OUTPUT ${written}
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DPAGE=${page} -DOUTPUT=${written}
            -P ${PROJECT_SOURCE_DIR}/cmake/installed_page.cmake
    DEPENDS ${page} cmake/installed_page.cmake COMMENT "${page} as it is installed" VERBATIM)
  list(APPEND installed_pages ${written})
  cmake_path(GET page PARENT_PATH folder)
  install(FILES ${written} DESTINATION ${HEADPIN_DOC_DIR}/${folder} COMPONENT program)
endforeach()
add_custom_target(headpin_pages ALL DEPENDS ${installed_pages})
install(FILES CITATION.cff DESTINATION ${HEADPIN_DOC_DIR} COMPONENT program)
install(DIRECTORY docs DESTINATION ${HEADPIN_DOC_DIR} COMPONENT program FILES_MATCHING PATTERN "*.svg"
        PATTERN "*.ipynb" PATTERN "gymnasium_bowling.py")
install(DIRECTORY assets/pictures DESTINATION ${HEADPIN_DOC_DIR}/assets COMPONENT program)

# Manual and completion, as the program writes them after it was linked (apps/CMakeLists.txt).
set(HEADPIN_ZSH_DIR ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING
    "Where zsh looks for completion")
install(DIRECTORY ${PROJECT_BINARY_DIR}/manual/man1
        DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/manual/headpin.bash RENAME headpin
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/manual/_headpin
        DESTINATION ${HEADPIN_ZSH_DIR} COMPONENT program)

include(cmake/packages.cmake)
