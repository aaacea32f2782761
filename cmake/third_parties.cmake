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

# third_party(NAME VERSION LICENCE HOLDERS PLACE...): PLACE: program, library, page, page's engine.
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

set(gcc "GPL-3.0-or-later WITH GCC-exception-3.1")
set(llvm "Apache-2.0 WITH LLVM-exception")
third_party(eigen ${Eigen3_VERSION} MPL-2.0 "2006-2021 the Eigen authors"
            program library "the page's engine")
third_party(libstdc++ ${CMAKE_CXX_COMPILER_VERSION} "${gcc}" "Free Software Foundation, Inc."
            program library)
third_party(cli11 "${CLI11_VERSION}" BSD-3-Clause "2017-2022 University of Cincinnati" program)
third_party(fmt "${fmt_VERSION}" MIT "2012-2022 Victor Zverovich" program "the page's engine")
third_party(nlohmann-json "${nlohmann_json_VERSION}" MIT "2013-2022 Niels Lohmann"
            program "the page's engine")
third_party(tomlplusplus "${TOMLPLUSPLUS_VERSION}" MIT "2019-2022 Mark Gillard"
            program "the page's engine")
third_party(lcm "${LCM_VERSION}" LGPL-2.1-or-later "2007-2016 the LCM developers"
            program "the page's engine")
third_party(three ${version_of_three} MIT "2010-2024 three.js authors" page)
third_party(uplot ${version_of_uplot} MIT "2022 Leon Sorokin" page)
third_party(emscripten ${version_of_emscripten} MIT "2010-2022 the Emscripten authors"
            "the page's engine")
third_party(musl NOASSERTION MIT "2005-2020 Rich Felker and others" "the page's engine")
third_party(dlmalloc NOASSERTION CC0-1.0 "Doug Lea, who gave it to all" "the page's engine")
third_party(libc++ NOASSERTION "${llvm}" "2009-2021 the LLVM contributors" "the page's engine")
third_party(libc++abi NOASSERTION "${llvm}" "2009-2021 the LLVM contributors" "the page's engine")
third_party(compiler-rt NOASSERTION "${llvm}" "2009-2021 the LLVM contributors" "the page's engine")

string(TIMESTAMP HEADPIN_SPDX_CREATED "%Y-%m-%dT%H:%M:%SZ" UTC)  # of SOURCE_DATE_EPOCH where set
file(READ LICENSE HEADPIN_LICENCE)
string(REGEX REPLACE "^[^\n]*\n\n[^\n]*\n\n" "" HEADPIN_LICENCE "${HEADPIN_LICENCE}")
string(STRIP "${HEADPIN_LICENCE}" HEADPIN_LICENCE)
string(REGEX REPLACE "\n\n" "\n.\n" HEADPIN_LICENCE "${HEADPIN_LICENCE}")
string(REGEX REPLACE "\n" "\n " HEADPIN_LICENCE "${HEADPIN_LICENCE}")
configure_file(cmake/copyright.in packages/copyright @ONLY)
configure_file(cmake/headpin.spdx.json.in packages/headpin.spdx.json @ONLY)
