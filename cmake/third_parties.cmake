# What of others is in the program, the page and its engine: for the copyright file of the packages
# and for the list of parts (SPDX 2.3). Libraries that are linked when it runs are Debian's own packages.
find_package(CLI11 QUIET)
find_package(fmt QUIET)
find_package(nlohmann_json QUIET)
file(READ ${PROJECT_SOURCE_DIR}/apps/report/package-lock.json lock)
foreach(name three uplot)
  string(JSON version_of_${name} GET ${lock} packages node_modules/${name} version)
endforeach()
execute_process(COMMAND em++ -dumpversion OUTPUT_VARIABLE version_of_emscripten
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE no_emscripten)
if(no_emscripten)
  set(version_of_emscripten NOASSERTION)
endif()

set(HEADPIN_COPYRIGHT_FILES "")
set(HEADPIN_SPDX_PACKAGES "")
set(HEADPIN_SPDX_RELATIONS "")

# third_party(NAME VERSION LICENCE HOLDERS PLACE...): PLACE: program, library, Python package, page, page's engine.
function(third_party name version licence holders)
  if(NOT version)
    set(version NOASSERTION)
  endif()
  list(JOIN ARGN ", " places)
  string(APPEND HEADPIN_COPYRIGHT_FILES
    "\nFiles: parts of ${name} ${version} in: ${places}\nCopyright: ${holders}\nLicense: ${licence}\n")
  string(REPLACE "\"" "\\\"" holders "${holders}")
  string(MAKE_C_IDENTIFIER ${name} id)
  string(REPLACE _ - id ${id})
  string(APPEND HEADPIN_SPDX_PACKAGES ",
    {\"SPDXID\": \"SPDXRef-${id}\", \"name\": \"${name}\", \"versionInfo\": \"${version}\",
     \"licenseConcluded\": \"${licence}\", \"licenseDeclared\": \"${licence}\",
     \"copyrightText\": \"Copyright (c) ${holders}\", \"downloadLocation\": \"NOASSERTION\",
     \"filesAnalyzed\": false, \"comment\": \"in: ${places}\"}")
  string(APPEND HEADPIN_SPDX_RELATIONS ",
    {\"spdxElementId\": \"SPDXRef-headpin\", \"relationshipType\": \"CONTAINS\",
     \"relatedSpdxElement\": \"SPDXRef-${id}\"}")
  set(HEADPIN_COPYRIGHT_FILES "${HEADPIN_COPYRIGHT_FILES}" PARENT_SCOPE)
  set(HEADPIN_SPDX_PACKAGES "${HEADPIN_SPDX_PACKAGES}" PARENT_SCOPE)
  set(HEADPIN_SPDX_RELATIONS "${HEADPIN_SPDX_RELATIONS}" PARENT_SCOPE)
endfunction()

set(version_of_eigen "${Eigen3_VERSION}")
set(version_of_libstdc++ "${CMAKE_CXX_COMPILER_VERSION}")
set(version_of_cli11 "${CLI11_VERSION}")
set(version_of_fmt "${fmt_VERSION}")
set(version_of_pybind11 "${HEADPIN_PYBIND11_VERSION}")
set(version_of_nlohmann-json "${nlohmann_json_VERSION}")
set(version_of_tomlplusplus "${TOMLPLUSPLUS_VERSION}")
set(version_of_lcm "${LCM_VERSION}")
set(version_of_foxglove-schemas "2.1.0")

# The list itself, which the page's notices are written from too (apps/report/build.mjs).
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/third_parties.json)
file(READ ${CMAKE_CURRENT_LIST_DIR}/third_parties.json parts)
string(JSON count LENGTH ${parts})
math(EXPR last "${count} - 1")
foreach(i RANGE ${last})
  foreach(key name licence holders)
    string(JSON ${key} GET ${parts} ${i} ${key})
  endforeach()
  set(places "")
  string(JSON count LENGTH ${parts} ${i} in)
  math(EXPR last_place "${count} - 1")
  foreach(k RANGE ${last_place})
    string(JSON place GET ${parts} ${i} in ${k})
    list(APPEND places "${place}")
  endforeach()
  third_party(${name} "${version_of_${name}}" "${licence}" "${holders}" ${places})
endforeach()

string(TIMESTAMP HEADPIN_SPDX_CREATED "%Y-%m-%dT%H:%M:%SZ" UTC)  # of SOURCE_DATE_EPOCH where set
file(READ LICENSE HEADPIN_LICENCE)
string(REGEX REPLACE "^[^\n]*\n\n[^\n]*\n\n" "" HEADPIN_LICENCE "${HEADPIN_LICENCE}")
string(STRIP "${HEADPIN_LICENCE}" HEADPIN_LICENCE)
string(REGEX REPLACE "\n\n" "\n.\n" HEADPIN_LICENCE "${HEADPIN_LICENCE}")
string(REGEX REPLACE "\n" "\n " HEADPIN_LICENCE "${HEADPIN_LICENCE}")
configure_file(cmake/copyright.in packages/copyright @ONLY)
configure_file(cmake/headpin.spdx.json.in packages/headpin.spdx.json @ONLY)
