# SPDX-License-Identifier: LGPL-3.0-or-later
# Optional parts of a build. Each is an option that is ON if what it needs was
# found. A part that is switched ON although something is missing stops the
# configuration.

# vg_part(OPTION TEXT PACKAGES NEEDED...): NEEDED are variables of find_path,
# find_library or find_package. PACKAGES are those of Debian.
function(vg_part option text packages)
  set(found ON)
  foreach(needed ${ARGN})
    if(NOT ${needed})
      set(found OFF)
    endif()
  endforeach()
  option(${option} "${text}" ${found})
  if(${option} AND NOT found)
    message(FATAL_ERROR "${option} is ON, but the libraries of this part were "
      "not found: install ${packages}, or set ${option} to OFF (${text})")
  endif()
  set(why "")
  if(NOT ${option})
    if(found)
      set(why "  (${option}=OFF)")
    else()
      set(why "  (not found: ${packages})")
    endif()
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY VG_PARTS
    "--   ${option}: ${${option}}  ${text}${why}\n")
endfunction()

# Prints the table of parts.
function(vg_print_parts)
  get_property(parts GLOBAL PROPERTY VG_PARTS)
  message(STATUS "Parts of this build (switch one off with -DOPTION=OFF):")
  string(REGEX REPLACE "(^|\n)-- " "\\1--" parts "${parts}")
  string(REGEX REPLACE "\n$" "" parts "${parts}")
  string(REPLACE "\n" ";" lines "${parts}")
  foreach(line ${lines})
    string(REGEX REPLACE "^-- *" "  " line "${line}")
    message(STATUS "${line}")
  endforeach()
  message(STATUS "")
endfunction()

# vg_variant(OPTION SOURCE STUB): compiles SOURCE if the option is ON, otherwise
# its stub.
macro(vg_variant option source stub)
  if(${option})
    set_source_files_properties(${stub} PROPERTIES HEADER_FILE_ONLY ON)
  else()
    set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
  endif()
endmacro()
