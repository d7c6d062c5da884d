# SPDX-License-Identifier: LGPL-3.0-or-later
# Installs the program, the library with its headers, the pkg-config file and
# the CMake package. Components become packages (cmake/package.cmake).
include(CMakePackageConfigHelpers)
if(NOT TARGET vanguard_program)
  return()
endif()

install(TARGETS vanguard_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  COMPONENT program)
install(TARGETS vanguard EXPORT vanguard-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  COMPONENT library NAMELINK_COMPONENT dev)
install(FILES src/api/vanguard.h src/core/mesher/mesher.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vanguard COMPONENT dev)
if(VG_CAD)
  install(TARGETS vanguard-cad LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    COMPONENT cad)
endif()

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/vanguard)
install(EXPORT vanguard-targets NAMESPACE vanguard:: DESTINATION ${package}
  COMPONENT dev)
configure_package_config_file(cmake/vanguard-config.cmake.in
  ${CMAKE_BINARY_DIR}/vanguard-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/vanguard-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/vanguard-config.cmake
  ${CMAKE_BINARY_DIR}/vanguard-config-version.cmake DESTINATION ${package}
  COMPONENT dev)

# Relative to the file itself, so that the installation can be moved.
file(RELATIVE_PATH includedir
  ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_INCLUDEDIR})
set(VG_PC_INCLUDEDIR "\${pcfiledir}/${includedir}")
# Programs find the library where it is, except in the folders of the system,
# where the linker looks in any case.
set(VG_PC_RPATH " -Wl,-rpath,\${libdir}")
if(CMAKE_INSTALL_FULL_LIBDIR MATCHES "^/(usr/)?lib")
  set(VG_PC_RPATH "")
endif()
configure_file(cmake/vanguard.pc.in ${CMAKE_BINARY_DIR}/vanguard.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/vanguard.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/man/man1
  DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/bash-completion
    ${CMAKE_BINARY_DIR}/share/zsh ${CMAKE_BINARY_DIR}/share/fish
  DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)
install(PROGRAMS share/slurm/vanguard.sbatch
  DESTINATION ${CMAKE_INSTALL_DATADIR}/vanguard COMPONENT program)
install(PROGRAMS share/drivers/vanguard_cases.py
  share/drivers/vanguard_solvers.py
  DESTINATION ${CMAKE_INSTALL_DATADIR}/vanguard/drivers COMPONENT python3)
# The drivers are modules, and programs on the PATH under the names of programs.
file(RELATIVE_PATH drivers ${CMAKE_INSTALL_FULL_BINDIR}
  ${CMAKE_INSTALL_FULL_DATADIR}/vanguard/drivers)
foreach(driver cases solvers)
  set(link ${CMAKE_BINARY_DIR}/drivers/vanguard-${driver})
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/drivers)
  file(CREATE_LINK ${drivers}/vanguard_${driver}.py ${link} SYMBOLIC)
  install(FILES ${link} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT python3)
endforeach()
# Scripts that run a flow solver in a cycle of vanguard adapt.
install(DIRECTORY share/adapt DESTINATION ${CMAKE_INSTALL_DATADIR}/vanguard
  COMPONENT program USE_SOURCE_PERMISSIONS)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/vanguard)
file(CREATE_LINK ${CMAKE_SOURCE_DIR}/share/adapt
  ${CMAKE_BINARY_DIR}/share/vanguard/adapt SYMBOLIC)
install(DIRECTORY share/schema DESTINATION ${CMAKE_INSTALL_DATADIR}/vanguard
  COMPONENT program)
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff
  CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR}
  COMPONENT doc)
install(DIRECTORY LICENSES DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
# The documents to which the README links, with the examples that they use.
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc
  FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg")
install(FILES tests/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/tests
  COMPONENT doc)
install(DIRECTORY findings DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(DIRECTORY verification DESTINATION ${CMAKE_INSTALL_DOCDIR}
  COMPONENT doc FILES_MATCHING PATTERN "*.md")
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc
  PATTERN "*.py" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
    GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# Debian's Python finds modules in this folder; other systems need PYTHONPATH.
set(python ${CMAKE_INSTALL_PREFIX}/lib/python3/dist-packages)
file(RELATIVE_PATH VG_LIBRARY_FROM_PYTHON ${python}
  ${CMAKE_INSTALL_FULL_LIBDIR}/libvanguard.so.1)
configure_file(python/vanguard.py.in ${CMAKE_BINARY_DIR}/vanguard.py @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/vanguard.py
  DESTINATION lib/python3/dist-packages COMPONENT python3)

include(cmake/package.cmake)
