# SPDX-License-Identifier: LGPL-3.0-or-later
# The helper programs (src/base/helper/helper.h): libraries whose licences must not
# apply to program and library. Each is optional and has the licence of its
# library.
set(VG_HELPER_FOLDER ${CMAKE_INSTALL_LIBEXECDIR}/vanguard)

find_path(VG_TETGEN_INCLUDE tetgen.h)
find_library(VG_TETGEN_LIBRARY NAMES tet tetgen)
find_path(VG_CGAL_INCLUDE CGAL/alpha_wrap_3.h)
find_library(VG_GMP gmp)
find_library(VG_MPFR mpfr)
mark_as_advanced(VG_TETGEN_INCLUDE VG_TETGEN_LIBRARY VG_CGAL_INCLUDE VG_GMP
  VG_MPFR)
vg_part(VG_TETGEN "vanguard-tetgen: TetGen in boundary recovery, --mesher tetgen"
  "libtet1.5-dev" VG_TETGEN_INCLUDE VG_TETGEN_LIBRARY)
vg_part(VG_WRAP "vanguard-wrap: --wrap for dirty surfaces, with CGAL"
  "libcgal-dev" VG_CGAL_INCLUDE VG_GMP VG_MPFR)

# vg_helper(NAME FOLDER SOURCES...): an executable of a folder of helpers and of
# some sources of the program.
function(vg_helper name folder)
  set(digest ${CMAKE_BINARY_DIR}/generated/${name}_digest.c)
  file(GLOB own CONFIGURE_DEPENDS helpers/${folder}/*.c* helpers/${folder}/*.h
    helpers/common/*.[ch])
  add_custom_command(OUTPUT ${digest} VERBATIM
    COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR}/helpers
      -DFOLDERS=${folder},common -DOUT=${digest}
      -P ${PROJECT_SOURCE_DIR}/cmake/source_digest.cmake
    DEPENDS ${own} cmake/source_digest.cmake)
  add_executable(${name} ${own} ${digest} src/base/child_bytes.c ${ARGN})
  target_link_libraries(${name} PRIVATE vg_flags)
  target_include_directories(${name} PRIVATE helpers)
  set_target_properties(${name} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  if(VG_COVERAGE)
    target_sources(${name} PRIVATE cmake/coverage.c)
  endif()
  install(TARGETS ${name} RUNTIME DESTINATION ${VG_HELPER_FOLDER}
    COMPONENT helpers)
  set_property(GLOBAL APPEND PROPERTY VG_HELPERS ${name})
endfunction()

if(VG_TETGEN)
  set(VG_TETGEN_VERSION 1.5 CACHE STRING
    "Version of TetGen, for reports: tetgen.h has no constant")
  mark_as_advanced(VG_TETGEN_VERSION)
  vg_helper(vanguard-tetgen tetgen src/base/memory.c
    src/core/mesher/child_sizes.c)
  target_include_directories(vanguard-tetgen SYSTEM PRIVATE
    ${VG_TETGEN_INCLUDE})
  target_compile_definitions(vanguard-tetgen PRIVATE
    VG_TETGEN_VERSION="${VG_TETGEN_VERSION}")
  target_link_libraries(vanguard-tetgen PRIVATE ${VG_TETGEN_LIBRARY} m
    ${CMAKE_DL_LIBS})
  # Run-time type checks need clang's C++ runtime in TetGen, too.
  target_compile_options(vanguard-tetgen PRIVATE ${VG_NO_CXX_RUNTIME})
  if(VG_TETGEN_LIBRARY MATCHES "\\.a$")   # our predicates count calls
    target_compile_definitions(vanguard-tetgen PRIVATE VG_TETGEN_STATIC)
    target_link_options(vanguard-tetgen PRIVATE
      LINKER:--wrap=_Z8orient3dPdS_S_S_ LINKER:--wrap=_Z8inspherePdS_S_S_S_)
  endif()
endif()

if(VG_WRAP)
  vg_helper(vanguard-wrap wrap)
  target_include_directories(vanguard-wrap SYSTEM PRIVATE ${VG_CGAL_INCLUDE})
  # Interval arithmetic changes the rounding mode. NDEBUG, since failed checks
  # would print.
  set(options -frounding-math ${VG_NO_CXX_RUNTIME})
  # With sanitizers, the templates of CGAL take minutes to compile and ten times
  # as long to run.
  if(CMAKE_CXX_FLAGS MATCHES -fsanitize)
    list(APPEND options -O2 -fno-sanitize=all)
  endif()
  set_source_files_properties(helpers/wrap/wrap.cpp helpers/wrap/unite.cpp
    PROPERTIES
    COMPILE_DEFINITIONS NDEBUG COMPILE_OPTIONS "${options}")
  # A false alarm of GCC in CGAL's search for self-intersections.
  set_property(SOURCE helpers/wrap/unite.cpp APPEND PROPERTY COMPILE_OPTIONS
    -Wno-maybe-uninitialized -Wno-unknown-warning-option)
  target_link_libraries(vanguard-wrap PRIVATE ${VG_GMP} ${VG_MPFR})
endif()
