# SPDX-License-Identifier: LGPL-3.0-or-later
# The signs of predicates and the bytes of output must not depend on how a
# compiler fuses or reorders floating-point operations: contraction and
# fast-math are never allowed.
add_library(vg_flags INTERFACE)
target_compile_options(vg_flags INTERFACE
  -Wall -Wextra -Wshadow -Wpointer-arith
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
  -ffp-contract=off -fno-fast-math
  $<$<BOOL:${VG_WERROR}>:-Werror>)
target_compile_definitions(vg_flags INTERFACE $<$<BOOL:${VG_CHECKS}>:VG_CHECKS>
  $<$<BOOL:${VG_PORTABLE}>:VG_PORTABLE>)
target_include_directories(vg_flags INTERFACE ${PROJECT_SOURCE_DIR}/src)
set(CMAKE_C_FLAGS_RELEASE "-O3 -g -DNDEBUG")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g -DNDEBUG")

# Run-time type checks of clang's sanitizers need its C++ runtime.
set(VG_NO_CXX_RUNTIME
  "$<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=function,vptr>")

# Line coverage (verification/coverage.sh). The counters are not atomic, because
# that would slow threads down. So the number of executions of a line is
# inexact, but it is known reliably whether a line was executed.
if(VG_COVERAGE)
  target_compile_options(vg_flags INTERFACE --coverage)
  add_link_options(--coverage LINKER:--wrap=_exit)
endif()

# vg_module(FOLDER SEEN...): makes a module of the sources in a folder of src,
# which may include headers of the modules SEEN. See src/CMakeLists.txt.
function(vg_module module)
  string(REPLACE "/" "_" target "vg_${module}")
  file(GLOB sources CONFIGURE_DEPENDS ${module}/*.c ${module}/*.cpp)
  add_library(${target} OBJECT ${sources})
  target_link_libraries(${target} PUBLIC vg_flags)
  foreach(seen ${ARGN})
    string(REPLACE "/" "_" below "vg_${seen}")
    if(NOT TARGET ${below})
      message(FATAL_ERROR "src/CMakeLists.txt: ${module} uses ${seen}, which is "
        "not above it in the list")
    endif()
    target_link_libraries(${target} PUBLIC ${below})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY VG_MODULES ${module})
endfunction()
