#!/bin/sh
# SPDX-License-Identifier: LGPL-3.0-or-later
# Generates man pages and bash completions from the --help output of the program:
# manual.sh PROGRAM VERSION FOLDER
set -eu
program=$1 version=$2 folder=$3
export LC_ALL=C
# One line per option, with the help text from a fixed column on.
export ARGP_HELP_FMT=rmargin=30000,opt-doc-col=60
mkdir -p "$folder/man/man1" "$folder/bash-completion/completions"

# For each command, its name and summary: "check check a surface or ...".
commands() {
  "$program" --help | sed -n 's/^  \([a-z]*\)  *\([^ ].*\)/\1 \2/p'
}

# page NAME SUMMARY: converts --help output on standard input to a man page.
page() {
  awk -v name="$1" -v summary="$2" -v version="$version" '
    function plain(s) {
      gsub(/\\/, "\\e", s)
      gsub(/-/, "\\-", s)
      if (s ~ /^[.'"'"']/) s = "\\&" s
      return s
    }
    BEGIN {
      title = toupper(name)
      printf ".TH %s 1 \"\" \"Vanguard %s\" \"Vanguard\"\n", title, version
      print ".SH NAME\n" plain(name) " \\- " plain(summary)
    }
    /^Usage: / && !usage {
      usage = 1
      sub(/^Usage: /, "")
      print ".SH SYNOPSIS\n.B " plain($0) "\n.SH DESCRIPTION"
      next
    }
    /^ +-/ {
      if (!options++) print ".SH OPTIONS"
      what = substr($0, 1, 59)
      text = substr($0, 60)
      sub(/^ +/, "", what)
      sub(/ +$/, "", what)
      sub(/^ +/, "", text)
      print ".TP\n.B " plain(what) "\n" plain(text)
      next
    }
    /^ [^ ]/ && options {
      sub(/^ +/, "")
      sub(/:$/, "")
      print ".SS " plain($0)
      next
    }
    /^$/ { print ".PP"; next }
    /^Mandatory or optional arguments|^or optional arguments/ { next }
    options && !notes++ { print ".SH NOTES" }
    { print plain($0) }
    END {
      if (name != "vanguard") print ".SH SEE ALSO\n.BR vanguard (1)"
    }'
}

overview() {
  "$program" --help
  echo
  commands | while read -r name summary; do
    echo "vanguard-$name(1): $summary"
  done
}

overview | page vanguard "volume mesh generator for aerodynamics" \
  >"$folder/man/man1/vanguard.1"
commands | while read -r name summary; do
  "$program" "$name" --help | page "vanguard-$name" "$summary" \
    >"$folder/man/man1/vanguard-$name.1"
done

# Long options of a command, with = if they take a value.
options() {
  "$program" "$1" --help |
    sed -n 's/^ \{1,\}\(-[^ ]*, \)*--\([a-z0-9-]*\)\(\[\{0,1\}=\{0,1\}\).*/--\2\3/p' |
    tr -d '[' | tr '\n' ' '
}

{
  echo "# Completion of vanguard's commands and options; generated from its help."
  echo "_vanguard() {"
  echo '  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} options'
  echo "  COMPREPLY=()"
  echo '  if [ "$COMP_CWORD" = 1 ]; then'
  printf '    COMPREPLY=($(compgen -W "%s--help --version" -- "$word"))\n' \
    "$(commands | sed 's/ .*//' | tr '\n' ' ')"
  echo "    return"
  echo "  fi"
  echo '  case $command in'
  commands | while read -r name summary; do
    printf '  %s) options="%s" ;;\n' "$name" "$(options "$name")"
  done
  echo '  *) return ;;'
  echo "  esac"
  echo '  [[ $word != -* ]] ||'
  echo '    COMPREPLY=($(compgen -W "$options" -- "$word"))'
  echo '  [[ ${#COMPREPLY[@]} != 1 || $COMPREPLY != *= ]] || compopt -o nospace'
  echo "}"
  echo "complete -o default -F _vanguard vanguard"
} >"$folder/bash-completion/completions/vanguard"
