# The types of the messages for Java, as one jar. lcm-spy finds the type of a message by its fingerprint
# among the classes of its class path; with this jar it shows what a message of ours says.
#
# Needs lcm-gen, liblcm-java's lcm.jar and a JDK, of version 17 for `jar --date`.
set(HEADPIN_JAVA AUTO CACHE STRING "A jar of the message types: ON, OFF, or AUTO: where lcm.jar and a JDK are")
set_property(CACHE HEADPIN_JAVA PROPERTY STRINGS AUTO ON OFF)
if(NOT HEADPIN_JAVA)
  return()
endif()
find_package(Java 17 QUIET COMPONENTS Development Runtime)
find_file(HEADPIN_LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java DOC "The jar of liblcm-java")
mark_as_advanced(HEADPIN_LCM_JAR)
if(NOT Java_FOUND OR NOT HEADPIN_LCM_JAR)
  if(NOT HEADPIN_JAVA STREQUAL AUTO)
    message(FATAL_ERROR "HEADPIN_JAVA is ${HEADPIN_JAVA}: expected a JDK of version 17 or later and lcm.jar, "
                        "found Java '${Java_VERSION}' and '${HEADPIN_LCM_JAR}'")
  endif()
  return()
endif()

# `java -jar` starts lcm-spy, and finds lcm.jar, with the library for charts beside it, where they are here.
set(java ${CMAKE_CURRENT_BINARY_DIR}/java)
set(jar ${CMAKE_CURRENT_BINARY_DIR}/headpin-types.jar)
cmake_path(REPLACE_FILENAME HEADPIN_LCM_JAR jchart2d.jar OUTPUT_VARIABLE charts)
file(CONFIGURE OUTPUT java.manifest CONTENT "Main-Class: lcm.spy.Spy\nClass-Path: ${HEADPIN_LCM_JAR} ${charts}\n")

# The same bytes whenever it is made: one date, and the classes in the order of their names.
list(TRANSFORM lcm_types REPLACE ".*/(.*)\\.lcm" "headpin/\\1.java" OUTPUT_VARIABLE java_sources)
list(TRANSFORM java_sources REPLACE "java$" "class" OUTPUT_VARIABLE java_classes)
add_custom_command(OUTPUT ${jar}
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${java}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${java}
  COMMAND ${LCM_GEN} --java --jpath ${java} ${lcm_types}
  COMMAND ${CMAKE_COMMAND} -E chdir ${java} ${Java_JAVAC_EXECUTABLE} --release 11 -cp ${HEADPIN_LCM_JAR} ${java_sources}
  COMMAND ${CMAKE_COMMAND} -E chdir ${java} ${Java_JAR_EXECUTABLE} --create --file ${jar}
          --manifest ${CMAKE_CURRENT_BINARY_DIR}/java.manifest --date 2000-01-01T00:00:00Z ${java_classes}
  DEPENDS ${lcm_types} ${CMAKE_CURRENT_BINARY_DIR}/java.manifest COMMENT "headpin-types.jar" VERBATIM)
add_custom_target(headpin_types_jar ALL DEPENDS ${jar})
set_target_properties(headpin_types_jar PROPERTIES JAR ${jar})
# Debian's policy for Java: the version in the name, and a link without it.
set(versioned headpin-types-${PROJECT_VERSION}.jar)
file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/installed)
file(CREATE_LINK ${versioned} ${CMAKE_CURRENT_BINARY_DIR}/installed/headpin-types.jar SYMBOLIC)
install(FILES ${jar} RENAME ${versioned} DESTINATION ${CMAKE_INSTALL_DATADIR}/java COMPONENT program)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/installed/headpin-types.jar
        DESTINATION ${CMAKE_INSTALL_DATADIR}/java COMPONENT program)
