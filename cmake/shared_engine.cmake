# The engine's objects, and what they take of base, as a shared library, whose symbols are those in headpin:: alone.
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(map ${CMAKE_CURRENT_BINARY_DIR}/headpin-engine.map)
configure_file(${PROJECT_SOURCE_DIR}/cmake/headpin-engine.map.in ${map} @ONLY)
add_library(headpin_engine_shared SHARED $<TARGET_OBJECTS:headpin_engine>)
add_library(headpin::engine_shared ALIAS headpin_engine_shared)
set_target_properties(headpin_engine_shared PROPERTIES LINKER_LANGUAGE CXX
  OUTPUT_NAME headpin-engine VERSION ${PROJECT_VERSION} SOVERSION ${soversion}
  EXPORT_NAME engine_shared LINK_DEPENDS ${map})
target_link_options(headpin_engine_shared PRIVATE -Wl,--version-script=${map} -Wl,--no-undefined)
target_link_libraries(headpin_engine_shared PRIVATE headpin_base INTERFACE Eigen3::Eigen)
target_compile_features(headpin_engine_shared INTERFACE cxx_std_20)
target_compile_definitions(headpin_engine_shared INTERFACE EIGEN_DONT_VECTORIZE)
target_compile_options(headpin_engine_shared INTERFACE ${HEADPIN_BITS})
target_include_directories(headpin_engine_shared INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/headpin>)
install(TARGETS headpin_engine_shared EXPORT headpin-engine_shared
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT engine)
install(EXPORT headpin-engine_shared NAMESPACE headpin:: DESTINATION ${HEADPIN_CMAKE_DIR}
        COMPONENT engine)
