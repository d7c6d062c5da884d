# SPDX-License-Identifier: LGPL-3.0-or-later
# Progress goes to stderr: plain lines to a file, a live line to a terminal.
vanguard demo box --cells 2000 --out made/on/the/way
exits 0
vanguard mesh -p made/on/the/way/box --out plain
exits 0
says err "fill  "
lacks err $'\r'
lacks out "fill  "

script -qec "$program mesh -p made/on/the/way/box --out live" /dev/null \
  >terminal </dev/null
says terminal $'\r\033[K'
says terminal "validity: valid"
