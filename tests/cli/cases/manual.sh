# SPDX-License-Identifier: LGPL-3.0-or-later
# Man pages and completions agree with the program.
share=$(dirname "$program")/../share
for command in mesh surface check partition convert metric plan sweep serve deck demo; do
  page=$share/man/man1/vanguard-$command.1
  exists "$page"
  vanguard $command --help
  exits 0
  grep -oE '(^|[ ,])--[a-z0-9][a-z0-9-]*' out | tr -d ' ,' | sort -u >options
  sed 's/\\-/-/g' "$page" >page
  [ -s options ] || fail "no options of $command"
  while read -r option; do
    says page "$option"
  done <options
done
page=$share/man/man1/vanguard.1
for command in mesh surface check partition convert metric plan sweep serve deck demo; do
  says "$page" ".BR vanguard\\-$command (1)$([ $command = demo ] || echo ,)"
done
for section in COMMANDS EXAMPLES ENVIRONMENT "SEE ALSO"; do
  says "$page" ".SH $section"
done

if command -v groff >/dev/null; then
  groff -man -Tutf8 -ww "$share"/man/man1/*.1 >pages 2>warnings
  [ ! -s warnings ] || fail "groff warns: $(head -3 warnings)"
fi

# complete WORDS...: bash's completions of the last word.
complete_words() {
  bash -c '
    compopt() { :; }
    . "$1"; shift
    COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
    _vanguard
    printf "%s\n" "${COMPREPLY[@]}"' - \
    "$share/bash-completion/completions/vanguard" "$@" >out 2>err
}
complete_words vanguard m
is out <<'END'
mesh
metric
END
complete_words vanguard mesh --farfield-l
is out <<'END'
--farfield-lengths=
END
complete_words vanguard check --js
is out <<'END'
--json
END
complete_words vanguard sweep --fam
is out <<'END'
--family=
END
complete_words vanguard sweep --scale
is out <<'END'

END
# Every long option of every command is completed, and nothing else.
for command in mesh surface check partition convert metric plan sweep serve deck demo; do
  vanguard $command --help
  sed -n 's/^ \{2,6\}\(-[^ ], \)*--\([a-z0-9-]*\).*/--\2/p' out | sort -u >options
  complete_words vanguard $command --
  tr -d = <out | sort -u | diff options - || fail "completions of $command"
done
complete_words vanguard mesh wing
is out <<'END'

END

# Values: words, lists of words, names of demos; files are left to the shell.
expect() {
  local expected=$1
  shift
  complete_words "$@"
  [ "$(tr '\n' ' ' <out)" = "$expected " ] || fail "$*: $(tr '\n' ' ' <out)"
}
expect "tets mixed hex" vanguard mesh --cells = ""
expect "mixed" vanguard mesh --cells = m
expect "tets mixed hex" vanguard check --cells ""
expect "no yes" vanguard surface --repair =
expect "vtu,su2" vanguard mesh --write vtu,su
expect "wing-half" vanguard demo wing-h
expect "mesh metric" vanguard help m
expect "" vanguard mesh --mapbc = w
expect "" vanguard mesh --growth = ""

if command -v fish >/dev/null; then
  fish_words() {
    HOME=$PWD fish --no-config -c 'source $argv[1]; complete -C $argv[2]' \
      "$share/fish/vendor_completions.d/vanguard.fish" "$1" | cut -f1 |
      sort >out 2>err
  }
  touch wing.step
  fish_words "vanguard mes"
  is out <<<mesh
  fish_words "vanguard mesh --cells "
  is out <<<$'mixed\ntets'
  fish_words "vanguard mesh --mapbc wing"
  is out <<<wing.step
  fish_words "vanguard mesh --farfield-le"
  is out <<<--farfield-lengths
  fish_words "vanguard demo wing-half"
  says out wing-half
fi

# zsh's own functions need a terminal: here they print their arguments.
if command -v zsh >/dev/null; then
  zsh_words() {
    zsh -f -c '
      _arguments() { print -rl -- "$@"; }
      _describe() { print -rl -- "${(@P)2}"; }
      file=$1; shift
      words=("$@"); CURRENT=$#
      . "$file"' - "$share/zsh/site-functions/_vanguard" "$@" >out 2>err
    [ ! -s err ] || fail "zsh: $(cat err)"
  }
  zsh_words vanguard ""
  says out "check:check a surface or a volume mesh"
  zsh_words vanguard mesh ""
  says out ":value:(tets mixed)"
  says out "--deck=[Run deck]:file:_files"
  says out "--out=[Folder for the results]:folder:_files -/"
  says out "--json[Write the report as JSON to standard output]"
  zsh_words vanguard demo ""
  says out "wing-half"
fi
