# SPDX-License-Identifier: LGPL-3.0-or-later
# Open CASCADE, for CAD files: optional. The code that uses it is a separate
# library, which only child processes load when they read CAD files
# (io/cad/cad.h), so that no other process loads Open CASCADE's seventy
# libraries.
find_path(VG_OCCT_INCLUDE STEPCAFControl_Reader.hxx PATH_SUFFIXES opencascade)
set(occt)
foreach(part XDESTEP XDEIGES STEP IGES XSBase XCAF LCAF CDF Mesh BO ShHealing TopAlgo
    GeomAlgo GeomBase BRep G3d G2d Math ernel)
  find_library(VG_OCCT_${part} TK${part})
  mark_as_advanced(VG_OCCT_${part})
  list(APPEND occt ${VG_OCCT_${part}})
endforeach()
set(occt_found ON)
if(occt MATCHES NOTFOUND)
  set(occt_found OFF)
endif()
vg_part(VG_CAD "STEP, IGES and BREP files, with Open CASCADE"
  "libocct-data-exchange-dev, libocct-ocaf-dev" VG_OCCT_INCLUDE occt_found)
set_target_properties(vg_io_occt PROPERTIES EXCLUDE_FROM_ALL ON)
if(VG_CAD)
  set(VG_CAD_LIBRARY libvanguard-cad.so.0)
  # The version, and the beginning of it in the names of Debian's packages.
  file(STRINGS ${VG_OCCT_INCLUDE}/Standard_Version.hxx occt_version
    REGEX "define +OCC_VERSION_COMPLETE")
  string(REGEX REPLACE ".*\"(.*)\".*" "\\1" occt_version "${occt_version}")
  string(REGEX REPLACE "^([0-9]+\\.[0-9]+).*" "\\1" occt_package
    "${occt_version}")
  target_compile_definitions(vg_io_cad PRIVATE
    VG_CAD_LIBRARY="${VG_CAD_LIBRARY}" VG_OCCT_VERSION="${occt_version}"
    VG_OCCT_PACKAGE="${occt_package}")
  target_compile_options(vg_io_occt PRIVATE ${VG_NO_CXX_RUNTIME})
  target_include_directories(vg_io_occt SYSTEM PRIVATE ${VG_OCCT_INCLUDE})
endif()
target_link_libraries(vg_io_cad PUBLIC ${CMAKE_DL_LIBS})

# The library, built in addition to libvanguard.
function(vg_cad_library)
  add_library(vanguard-cad MODULE $<TARGET_OBJECTS:vg_io_occt>)
  target_link_libraries(vanguard-cad PRIVATE ${occt} Threads::Threads)
  target_link_options(vanguard-cad PRIVATE LINKER:-soname,${VG_CAD_LIBRARY})
  if(VG_COVERAGE)
    # It has its own copy of gcov, which writes its own counts.
    target_sources(vanguard-cad PRIVATE ${PROJECT_SOURCE_DIR}/cmake/coverage.c)
    target_link_options(vanguard-cad PRIVATE LINKER:-Bsymbolic)
  endif()
  set_target_properties(vanguard-cad PROPERTIES PREFIX lib SUFFIX .so.0
    LINKER_LANGUAGE CXX LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
  add_dependencies(vanguard vanguard-cad)
endfunction()
