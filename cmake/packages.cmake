# `./dev package`: Debian packages of the program and of the engine's development files.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME headpin)
set(CPACK_PACKAGE_VENDOR "headpin developers")
set(CPACK_PACKAGE_CONTACT "headpin developers <developers@headpin.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program engine runtime)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
# Files and folders of a package are readable by all, whatever the builder's umask.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ
    GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME headpin)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libosmesa6 | libegl1")  # loaded at run time
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "ffmpeg, librsvg2-2")  # librsvg2-2: loaded at run time
# liblcm-java to default-jre: for headpin-types.jar.
# r-base-core and r-cran-brglm2: for `experiment analyse`.
string(JOIN ", " CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS
       liblcm-bin libheadpin-dev python3-headpin liblcm-java libjchart2d-java default-jre r-base-core r-cran-brglm2)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
"Re-creates and goes beyond the system of Uno & Slater (1997): samples of
trackers and buttons go in; a hand, a ball and skittles are simulated from
them, to the bit, under the collision response that is asked for; what each
eye saw comes out. Has an emulator of, and a driver for, the Polhemus Fastrak.")

set(CPACK_DEBIAN_ENGINE_PACKAGE_NAME libheadpin-dev)
set(CPACK_DEBIAN_ENGINE_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_ENGINE_PACKAGE_DEPENDS
    "libeigen3-dev (>= 3.4), ${HEADPIN_RUNTIME_PACKAGE} (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_ENGINE_DESCRIPTION
"The collision engine alone, its development files. It tells of two convex
shapes whether they are apart, with a plane that proves it, or where, which way
and how deep they meet; has the impulses of Uno & Slater (1997) and Coulomb's;
steps bodies that stand, roll, fall and repeat to the bit.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME ${HEADPIN_RUNTIME_PACKAGE})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
# Who is built against it needs this very version; ldconfig learns of it. CPack 3.25 has its own words
# for neither in a package of components.
set(control ${CMAKE_CURRENT_BINARY_DIR}/packages/control)
file(WRITE ${control}/shlibs "libheadpin-engine ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} "
     "${HEADPIN_RUNTIME_PACKAGE} (= ${PROJECT_VERSION})\n")
file(WRITE ${control}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${control}/shlibs ${control}/triggers)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
# CPack writes a postinst that calls ldconfig as well, and cannot be told not to.
file(WRITE ${control}/${HEADPIN_RUNTIME_PACKAGE} "${HEADPIN_RUNTIME_PACKAGE}: maintscript-calls-ldconfig *\n")
install(FILES ${control}/${HEADPIN_RUNTIME_PACKAGE}
        DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT runtime)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
"The collision engine of headpin as a shared library: convex shapes, their
contacts, the impulses of Uno & Slater (1997) and Coulomb's, steps that repeat
to the bit. Its symbols may change with each 0.x.")

set(packages headpin libheadpin-dev ${HEADPIN_RUNTIME_PACKAGE})
if(HEADPIN_PYTHON)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  list(APPEND packages python3-headpin)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-headpin)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS  # headpin: its scenarios and meshes
      "headpin (= ${PROJECT_VERSION}), python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas")
  # What Python compiles belongs to the package, as dh_python3 writes it: what was left of it after the
  # removal could be imported as an empty module.
  set(scripts ${control}/python3-headpin)
  file(WRITE ${scripts}/postinst "#!/bin/sh\nset -e\nif command -v py3compile >/dev/null 2>&1; then\n"
       "  py3compile -p python3-headpin\nfi\n")
  file(WRITE ${scripts}/prerm "#!/bin/sh\nset -e\nif command -v py3clean >/dev/null 2>&1; then\n"
       "  py3clean -p python3-headpin\nfi\n")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${scripts}/postinst ${scripts}/prerm)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
"headpin as a module of Python: trials as arrays of numpy, replays under other
conditions, what each eye saw with depth and cameras, sessions made step by
step, and the collision engine.")
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/packages/copyright
                ${CMAKE_CURRENT_BINARY_DIR}/packages/python3-headpin/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-headpin COMPONENT python)
endif()

# Each package says what changed, in Debian's form.
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH where that is set
foreach(package IN LISTS packages)
  set(changelog ${CMAKE_CURRENT_BINARY_DIR}/packages/${package}/changelog)
  file(WRITE ${changelog} "${package} (${PROJECT_VERSION}) unstable; urgency=medium\n\n"
       "  * What changed is told in CHANGELOG.md of the sources.\n\n"
       " -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
  execute_process(COMMAND gzip -9nf ${changelog} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/packages/headpin/changelog.gz
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/headpin COMPONENT program)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/packages/libheadpin-dev/changelog.gz
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libheadpin-dev COMPONENT engine)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/packages/${HEADPIN_RUNTIME_PACKAGE}/changelog.gz
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${HEADPIN_RUNTIME_PACKAGE} COMPONENT runtime)
include(CPack)
