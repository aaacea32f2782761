# What simulates a recorded trial again, by itself: no display, no network, no libraries but headers.
# For machines that Debian has a compiler for and no libraries: other processors under qemu,
# WebAssembly. Included by projects of their own; makes the target `headpin_replay`.
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH HEADPIN_ROOT)

# The headers of this machine's packages, and no other of its headers: those are for its own libc.
set(headers ${CMAKE_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(name IN ITEMS Eigen/Core fmt/format.h lcm/lcm_coretypes.h nlohmann/json.hpp toml++/toml.h)
  cmake_path(GET name PARENT_PATH folder)
  find_path(${folder}_HEADERS ${name} PATHS /usr/include /usr/local/include PATH_SUFFIXES eigen3
            NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH REQUIRED)
  file(CREATE_LINK ${${folder}_HEADERS}/${folder} ${headers}/${folder} SYMBOLIC)
endforeach()
find_program(LCM_GEN lcm-gen REQUIRED)

# One header per message, made by lcm-gen when its .lcm changes.
file(GLOB types CONFIGURE_DEPENDS ${HEADPIN_ROOT}/devices/lcm/types/*.lcm)
foreach(type IN LISTS types)
  cmake_path(GET type STEM stem)
  set(header ${CMAKE_BINARY_DIR}/types/headpin/${stem}.hpp)
  add_custom_command(OUTPUT ${header}
    COMMAND ${LCM_GEN} -x --cpp-std c++11 --cpp-hpath ${CMAKE_BINARY_DIR}/types ${type}
    DEPENDS ${type} VERBATIM)
  list(APPEND messages ${header})
endforeach()

file(STRINGS ${HEADPIN_ROOT}/CMakeLists.txt project REGEX "^project\\(headpin VERSION")
string(REGEX REPLACE ".*VERSION ([0-9.]+).*" "\\1" version "${project}")
add_custom_target(version
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${HEADPIN_ROOT} -DVERSION=${version}
          -DOUTPUT=${CMAKE_BINARY_DIR}/version.cpp -P ${HEADPIN_ROOT}/devices/base/version.cmake
  BYPRODUCTS ${CMAKE_BINARY_DIR}/version.cpp VERBATIM)

file(GLOB engine CONFIGURE_DEPENDS ${HEADPIN_ROOT}/engine/*.cpp ${HEADPIN_ROOT}/base/math.cpp)
set(parts
  base/input_file base/sha256 base/temporary
  devices/base/clock_offset devices/base/clocks devices/base/genlock devices/base/resample devices/base/sequence_count
  devices/base/sources devices/log/event_log devices/log/layout devices/log/sample_messages
  render/data/hmd render/eyes
  scene/record/details scene/record/doubled scene/record/file scene/record/first_difference scene/record/messages scene/record/misdated
  scene/record/state_change scene/record/throw_fields
  scene/record/trial_messages scene/play/ball_path scene/play/game scene/play/game_hash scene/play/hand scene/play/lane_wear scene/play/outcome scene/play/parabola scene/play/player
  scene/play/presence scene/play/referee scene/play/release scene/play/run scene/play/score
  scene/play/session scene/play/track_flare scene/play/tracking scene/play/walk scene/scenario/files scene/scenario/keys
  scene/scenario/nearest scene/scenario/rules scene/scenario/scenario scene/scenario/text
  scene/scenario/toml_reading scene/scenario/toml_text scene/scenario/units scene/stage/bodies scene/stage/chosen_checks scene/stage/oil_table scene/stage/outline scene/stage/read_scenario scene/stage/room
  scene/stage/scenario_checks scene/stage/seen_mesh scene/stage/stage scene/watch/recorded
  scene/watch/totals scene/watch/verifier)
list(TRANSFORM parts PREPEND ${HEADPIN_ROOT}/)
list(TRANSFORM parts APPEND .cpp)
list(APPEND parts ${CMAKE_CURRENT_LIST_DIR}/no_mesh_files.cpp)
set(CMAKE_CXX_EXTENSIONS OFF)
add_library(headpin_step STATIC ${engine})
target_compile_features(headpin_step PUBLIC cxx_std_20)
target_include_directories(headpin_step PUBLIC ${HEADPIN_ROOT})
target_include_directories(headpin_step SYSTEM PUBLIC ${headers})
# As in base/CMakeLists.txt: these carry the promise of equal bits.
target_compile_options(headpin_step PUBLIC -ffp-contract=off -fno-tree-vectorize -fno-tree-slp-vectorize)
target_compile_definitions(headpin_step PUBLIC EIGEN_DONT_VECTORIZE)
target_precompile_headers(headpin_step PRIVATE ${HEADPIN_ROOT}/base/math.h)

add_library(headpin_replay STATIC ${parts} ${messages} ${CMAKE_BINARY_DIR}/version.cpp)
add_dependencies(headpin_replay version)
# In one piece, beside the engine's pieces: most of its time goes to headers of libraries.
set_target_properties(headpin_replay PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0 OPTIMIZE_DEPENDENCIES ON)
set_source_files_properties(${CMAKE_BINARY_DIR}/version.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
target_link_libraries(headpin_replay PUBLIC headpin_step)
target_include_directories(headpin_replay SYSTEM PUBLIC ${CMAKE_BINARY_DIR}/types)
target_compile_definitions(headpin_replay
  PUBLIC FMT_HEADER_ONLY
  PRIVATE HEADPIN_DATA_FROM_PROGRAM="share/headpin")
if(EMSCRIPTEN)
  # Its library has no algorithms over ranges yet.
  target_compile_options(headpin_step PUBLIC -fwasm-exceptions -include ${HEADPIN_ROOT}/cmake/older_library.h)
  target_link_options(headpin_step PUBLIC -fwasm-exceptions)
  target_compile_options(headpin_replay PUBLIC -O2)  # -Os is a sixth smaller and four times slower
  # Another node than Debian's does not look for acorn where Debian has it.
  set_property(GLOBAL PROPERTY RULE_LAUNCH_LINK "${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs")
endif()
