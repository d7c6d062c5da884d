# CGAL, for shrink wraps around dirty surfaces: optional. It is header-only and
# needs GMP and MPFR.
find_path(VG_CGAL_INCLUDE CGAL/alpha_wrap_3.h)
find_library(VG_GMP gmp)
find_library(VG_MPFR mpfr)
mark_as_advanced(VG_CGAL_INCLUDE VG_GMP VG_MPFR)
if(VG_CGAL_INCLUDE AND VG_GMP AND VG_MPFR)
  set(VG_CGAL_FOUND ON)
else()
  set(VG_CGAL_FOUND OFF)
endif()
option(VG_WRAP "Wrap dirty surfaces with CGAL" ${VG_CGAL_FOUND})
if(VG_WRAP AND NOT VG_CGAL_FOUND)
  message(FATAL_ERROR "VG_WRAP: CGAL was not found; install libcgal-dev, or set "
    "VG_WRAP to OFF")
elseif(VG_WRAP)
  # Interval arithmetic changes the rounding mode. NDEBUG, since failed checks
  # would print.
  set_source_files_properties(core/wrap/wrap_cgal.cpp PROPERTIES
    COMPILE_DEFINITIONS "VG_CGAL;NDEBUG"
    COMPILE_OPTIONS "-frounding-math;${VG_NO_CXX_RUNTIME}")
  target_include_directories(vg_core_wrap SYSTEM PRIVATE ${VG_CGAL_INCLUDE})
  set(VG_WRAP_LIBRARIES ${VG_GMP} ${VG_MPFR})
  target_link_libraries(vg_core_wrap PUBLIC ${VG_WRAP_LIBRARIES})
else()
  message(STATUS "Shrink wrap: disabled, since CGAL was not found or "
    "VG_WRAP is OFF")
endif()
