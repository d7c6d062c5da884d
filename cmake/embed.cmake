# SPDX-License-Identifier: LGPL-3.0-or-later
# Writes OUT, a C file with the bytes of FILES (separated by ;) as arrays
# vg_asset_NAME, and their sizes. HEADER declares them. In NAME, all characters
# other than letters and digits become _.
set(text "#include \"${HEADER}\"\n")
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  string(REGEX REPLACE "[^a-z0-9]" "_" name ${name})
  file(READ ${file} bytes HEX)
  string(LENGTH "${bytes}" size)
  math(EXPR size "${size} / 2")
  string(REGEX REPLACE "(................................)" "\\1\n" bytes
    "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND text "\nconst unsigned char vg_asset_${name}[] = {\n${bytes}"
    "};\nconst size_t vg_asset_${name}_size = ${size};\n")
endforeach()
file(WRITE ${OUT} "${text}")
