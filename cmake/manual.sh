#!/bin/sh
# SPDX-License-Identifier: LGPL-3.0-or-later
# Generates man pages and completions for bash, zsh and fish from the output of
# --help and --option-table of the program: manual.sh PROGRAM VERSION FOLDER
set -eu
program=$1 version=$2 folder=$3
export LC_ALL=C
# One line per option, with the help text from a fixed column on.
export ARGP_HELP_FMT=rmargin=30000,opt-doc-col=60
mkdir -p "$folder/man/man1" "$folder/bash-completion/completions" \
  "$folder/zsh/site-functions" "$folder/fish/vendor_completions.d"

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
    /^ [A-Z].*:$/ {
      if (!options++) print ".SH OPTIONS"
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
      print ".SH SEE ALSO\n.BR vanguard (1)"
    }'
}

# Examples of the overview: lines of standard input, COMMAND|MEANING.
examples() {
  while IFS='|' read -r command meaning; do
    printf '.TP\n.B %s\n%s\n' "$(echo "$command" | sed 's/-/\\-/g')" "$meaning"
  done
}

# The page of the program itself.
overview() {
  cat <<END
.TH VANGUARD 1 "" "Vanguard $version" "Vanguard"
.SH NAME
vanguard \- parallel mesh generator for aerodynamics
.SH SYNOPSIS
.B vanguard
.I COMMAND
.RI [ OPTION ...]
.br
.B vanguard help
.I COMMAND
.br
.B vanguard \-\-version
.RB [ \-\-verbose ]
.SH DESCRIPTION
Vanguard generates volume meshes from closed surfaces and CAD files: viscous
layers on the walls, tetrahedra elsewhere. A project is a surface with optional
files of the same stem: settings in
.IR PROJECT .deck
and boundary conditions in
.IR PROJECT .mapbc.
Results are written next to the input or into the folder
.BR \-\-out .
Inputs are never overwritten.
.SH COMMANDS
END
  commands | while read -r name summary; do
    printf '.TP\n.BR vanguard\\-%s (1)\n%s\n' "$name" "$summary"
  done
  echo ".SH EXAMPLES"
  examples <<'END'
vanguard demo wing-half --out work|write an example project
vanguard check -p work/wing-half|examine its surface and what would be done with it
vanguard plan -p work/wing-half|forecast cells, memory and time
vanguard mesh -p work/wing-half|generate its mesh
vanguard mesh wing.step --y-plus 1 --reynolds 5e6 --reference-length 0.64|mesh a CAD file with viscous layers
mpirun -n 4 vanguard mesh -p wing --out mesh|generate the same mesh on four ranks
vanguard deck wing.step -o wing.deck|write all settings with their defaults, and the patches
END
  cat <<'END'
.SH EXIT STATUS
.TP
.B 0
success
.TP
.B 1
failure
.TP
.B 2
wrong usage
.TP
.B 4
finished, but a limit on the layers is not met or runs of a sweep differ
.SH ENVIRONMENT
.TP
.B VANGUARD_HELPERS
folder of the helper programs vanguard\-tetgen and vanguard\-wrap
.SH SEE ALSO
END
  commands | sed 's/ .*//; s/.*/.BR vanguard\\-& (1),/; $s/,$//'
}

overview >"$folder/man/man1/vanguard.1"
commands | while read -r name summary; do
  "$program" "$name" --help | page "vanguard-$name" "$summary" \
    >"$folder/man/man1/vanguard-$name.1"
done

# --- completions: options, words, file names ---------------------------------

demos=$("$program" demo --list | sed 's/ .*//' | tr '\n' ' ')

# One line per option of a command: long name, letter, kind of value (none, words,
# list, file, folder, other), words, and the beginning of its help.
table() {
  "$program" "$1" --option-table | awk -F'\t' -v OFS='\t' '
    seen[$1 "/" $2]++ { next }
    {
      kind = !length($3) ? "none" : length($4) ? "words" \
        : $3 ~ /^(FILE|PROJECT|STEM)$/ ? "file" \
        : $3 ~ /^(DIR|FOLDER)$/ ? "folder" : "other"
      if (kind == "words" && $3 == "LIST") kind = "list"
      text = $5
      sub(/[.;:\[(].*/, "", text)
      gsub(/["'"'"'`$\\]/, "", text)
      sub(/ +$/, "", text)
      print $1, $2, kind, $4, text
    }'
}

bash_completion() {
  cat <<'END'
# Completion of vanguard's commands, options and values; generated.
_vanguard() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} before=
  local option= options= values= list= plain=
  COMPREPLY=()
  if [ "$COMP_CWORD" = 1 ]; then
END
  printf '    COMPREPLY=($(compgen -W "%shelp --help --version" -- "$word"))\n' \
    "$(commands | sed 's/ .*//' | tr '\n' ' ')"
  cat <<'END'
    return
  fi
  # "--option=value" is three words.
  option=${COMP_WORDS[COMP_CWORD - 1]}
  if [ "$word" = = ]; then
    word=
  elif [ "$option" = = ]; then
    option=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  case $command in
END
  commands | while read -r name summary; do
    printf '  %s)\n    options="%s"\n    case $option in\n' "$name" \
      "$(table "$name" | awk -F'\t' 'length($1) {
        printf "--%s%s ", $1, $3 == "none" ? "" : "=" }')--help --usage"
    table "$name" | awk -F'\t' '
      $3 == "none" || $3 == "file" || $3 == "folder" { next }
      {
        name = length($1) ? "--" $1 : ""
        if (length($2)) name = name (length(name) ? "|" : "") "-" $2
        if ($3 == "other") printf "    %s) plain=1 ;;\n", name
        else printf "    %s) values=\"%s\"%s ;;\n", name, $4,
                    $3 == "list" ? " list=1" : ""
      }'
    echo '    esac'
    [ "$name" != demo ] ||
      printf '    [[ $option == -* ]] || values="%s"\n' "$demos"
    echo '    ;;'
  done
  printf '  help) values="%s" ;;\n' "$(commands | sed 's/ .*//' | tr '\n' ' ')"
  cat <<'END'
  *) return ;;
  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
    [[ ${#COMPREPLY[@]} != 1 || $COMPREPLY != *= ]] || compopt -o nospace
  elif [ -n "$values" ]; then
    if [[ -n $list && $word == *,* ]]; then
      before=${word%,*},
    fi
    COMPREPLY=($(compgen -P "$before" -W "$values" -- "${word##*,}"))
  elif [ -n "$plain" ]; then
    compopt +o default
  fi
}
complete -o default -F _vanguard vanguard
END
}

zsh_completion() {
  cat <<'END'
#compdef vanguard
# Completion of vanguard's commands, options and values; generated.
_vanguard() {
  local command=$words[2]
  local -a commands
  commands=(
END
  commands | while read -r name summary; do
    printf "    '%s:%s'\n" "$name" "$summary"
  done
  cat <<'END'
  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  shift words
  (( CURRENT-- ))
  case $command in
END
  commands | while read -r name summary; do
    printf '  %s)\n    _arguments -s \\\n' "$name"
    table "$name" | awk -F'\t' '
      {
        value = $3 == "none" ? "" : $3 == "words" ? ":value:(" $4 ")" \
          : $3 == "list" ? ":value:_values -s , value " $4 \
          : $3 == "file" ? ":file:_files" : $3 == "folder" ? ":folder:_files -/" \
          : ":value: "
        sign = $3 == "none" ? "" : "="
        if (length($1))
          printf "      \047--%s%s[%s]%s\047 \\\n", $1, sign, $5, value
        if (length($2))
          printf "      \047-%s%s[%s]%s\047 \\\n", $2,
                 $3 == "none" ? "" : "+", $5, value
      }'
    if [ "$name" = demo ]; then
      printf "      '1:name:(%s)'\n    ;;\n" "$demos"
    else
      printf "      '*:file:_files'\n    ;;\n"
    fi
  done
  cat <<'END'
  esac
}
_vanguard "$@"
END
}

fish_completion() {
  echo "# Completion of vanguard's commands, options and values; generated."
  echo "complete -c vanguard -f"
  commands | while read -r name summary; do
    printf "complete -c vanguard -n __fish_use_subcommand -a %s -d '%s'\n" \
      "$name" "$summary"
    for_command="complete -c vanguard -n '__fish_seen_subcommand_from $name'"
    if [ "$name" = demo ]; then
      printf "%s -a '%s'\n" "$for_command" "$demos"
    else
      echo "$for_command -F"
    fi
    table "$name" | awk -F'\t' -v begin="$for_command" '
      {
        value = $3 == "none" ? "" : $3 == "words" || $3 == "list" \
          ? " -x -a \047" $4 "\047" : $3 == "other" ? " -x" : " -r -F"
        printf "%s%s%s%s -d \047%s\047\n", begin,
               length($1) ? " -l " $1 : "", length($2) ? " -s " $2 : "", value, $5
      }'
  done
}

bash_completion >"$folder/bash-completion/completions/vanguard"
zsh_completion >"$folder/zsh/site-functions/_vanguard"
fish_completion >"$folder/fish/vendor_completions.d/vanguard.fish"
