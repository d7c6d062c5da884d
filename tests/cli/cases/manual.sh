# SPDX-License-Identifier: LGPL-3.0-or-later
# Man pages and completions agree with the program.
share=$(dirname "$program")/../share
for command in mesh surface check partition convert plan sweep serve deck demo; do
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
says "$share/man/man1/vanguard.1" 'vanguard\-sweep(1)'

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
for command in mesh surface check partition convert plan sweep serve deck demo; do
  vanguard $command --help
  sed -n 's/^ \{2,6\}\(-[^ ], \)*--\([a-z0-9-]*\).*/--\2/p' out | sort -u >options
  complete_words vanguard $command --
  tr -d = <out | sort -u | diff options - || fail "completions of $command"
done
complete_words vanguard mesh wing
is out <<'END'

END
