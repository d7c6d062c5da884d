# SPDX-License-Identifier: LGPL-3.0-or-later
# Debian packages, by `cpack` in a build of the preset `package`. One package
# for each licence and each set of dependencies.
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  return()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")   # each package has its own
set(CPACK_PACKAGE_VENDOR "The Vanguard developers")
set(CPACK_PACKAGE_CONTACT
  "The Vanguard developers <vanguard@packages.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE
  OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  ${CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS})
set(CPACK_COMPONENTS_ALL)
set(version "${PROJECT_VERSION}-1")

# vg_package(COMPONENT NAME SECTION LICENCE TEXT): LICENCE is the file in
# cmake/debian with the copyright.
function(vg_package component name section copyright text)
  string(TOUPPER ${component} upper)
  foreach(list CPACK_COMPONENTS_ALL)
    set(${list} ${${list}} ${component} PARENT_SCOPE)
  endforeach()
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${text}" PARENT_SCOPE)
  set(folder ${CMAKE_BINARY_DIR}/debian/${name})
  configure_file(cmake/debian/copyright.${copyright} ${folder}/copyright
    COPYONLY)
  configure_file(cmake/debian/changelog.in ${folder}/changelog.Debian @ONLY)
  execute_process(COMMAND gzip -9nf ${folder}/changelog.Debian)
  install(FILES ${folder}/copyright ${folder}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endfunction()

vg_package(program vanguard science lgpl
  "parallel unstructured mesh generator for aerodynamics
Vanguard turns a closed surface and a sizing field into a volume mesh:
viscous layers on the walls, tetrahedra elsewhere, on threads and MPI
ranks. The mesh does not depend on their number.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS
  "vanguard-helpers (= ${version}), libvanguard-cad0 (= ${version}), mpi-default-bin, libmicrohttpd12")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "vanguard-doc")
vg_package(library libvanguard1 libs lgpl
  "parallel unstructured mesh generator, shared library
Vanguard turns a closed surface and a sizing field into a volume mesh.
This package contains the library, for programs in C, C++ and Python.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS
  "vanguard-helpers (= ${version}), libvanguard-cad0 (= ${version})")
vg_package(dev libvanguard-dev libdevel lgpl
  "parallel unstructured mesh generator, development files
Vanguard turns a closed surface and a sizing field into a volume mesh.
This package contains headers and files for pkg-config and CMake.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libvanguard1 (= ${version})")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
vg_package(python3 python3-vanguard python lgpl
  "parallel unstructured mesh generator, Python module
Vanguard turns a closed surface and a sizing field into a volume mesh.
This package contains the Python module, which returns NumPy arrays.")
set(CPACK_DEBIAN_PYTHON3_PACKAGE_DEPENDS
  "libvanguard1 (= ${version}), python3, python3-numpy")
set(CPACK_DEBIAN_PYTHON3_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON3_PACKAGE_ARCHITECTURE all)
vg_package(doc vanguard-doc doc lgpl
  "parallel unstructured mesh generator, documentation
Vanguard turns a closed surface and a sizing field into a volume mesh.
This package contains the user guide, the reference and examples.")
set(CPACK_DEBIAN_DOC_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
get_property(helpers GLOBAL PROPERTY VG_HELPERS)
if(helpers)
  vg_package(helpers vanguard-helpers science helpers
    "parallel unstructured mesh generator, helper programs
Vanguard turns a closed surface and a sizing field into a volume mesh.
This package contains the programs with TetGen and CGAL that it starts for
boundary recovery and for wraps of dirty surfaces.")
endif()
if(VG_CAD)
  vg_package(cad libvanguard-cad0 libs lgpl
    "parallel unstructured mesh generator, CAD reader
Vanguard turns a closed surface and a sizing field into a volume mesh.
This package contains the part that reads STEP, IGES and BREP files with
Open CASCADE, which Vanguard loads when it needs it.")
endif()

# The dynamic linker learns about new libraries.
file(WRITE ${CMAKE_BINARY_DIR}/debian/triggers
  "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA
  ${CMAKE_BINARY_DIR}/debian/triggers)
set(CPACK_DEBIAN_CAD_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/debian/triggers)
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian/finish.cmake)
install(CODE "execute_process(COMMAND sh -c \"gzip -9nf \\\"\$DESTDIR\\\"/usr/share/man/man1/*.1\")"
  COMPONENT program)
include(CPack)
