# SPDX-License-Identifier: LGPL-3.0-or-later
# Options under the names that they have in other mesh generators: the message
# gives the name here. Every message ends before anything is read.

# refused COMMAND OPTION MESSAGE: the option is refused, with this message.
refused() {
  local command=$1 message=$3
  # shellcheck disable=SC2086
  vanguard $command $2 x
  exits 2
  is err <<END
vanguard $command: $message
END
}
while read -r option hint; do
  refused mesh "$option" "unknown option '$option'; did you mean $hint?"
done <<'END'
--first-height '--first'
--growth-rate '--ratio' or '--growth'
--num-layers '--layer-count'
--max-size '--hmax' or '--surface-size'
--format '--write'
--nSurfaceLayers '--layer-count'
--frist-height '--first'
--output '--out'
--total-thickness '--layer-total'
END
refused surface --max-size \
  "unknown option '--max-size'; did you mean '--hmax' or '--surface-size'?"
refused plan --np "unknown option '--np'; did you mean '--ranks' or '--threads'?"
refused partition --np "unknown option '--np'; did you mean '--parts'?"

# An abbreviation of an option that is another program's word for other options
# is not completed. Abbreviations without another meaning are.
for command in mesh surface check plan; do
  refused $command "--size 2" "option '--size' is ambiguous: it abbreviates \
'--sizes', but other mesh generators use the word for '--surface-size' or \
'--hmax'; write the option in full"
done
vanguard mesh --grow 0.5 x
exits 2
says err "growth is 0.5; it must be above 1"
vanguard mesh --size=2 x
exits 2
says err "option '--size' is ambiguous"

# Ranks are given to the launcher.
ranks="the launcher of MPI sets the number of ranks, as in 'mpirun -n 2 \
vanguard mesh -p PROJECT', and '--threads 2' the number of threads of each rank"
for option in -n -np --np --ranks; do
  refused mesh "$option 2" "unknown option '$option'; $ranks"
done
refused surface "-n 2" "unknown option '-n'; 'vanguard surface' runs in one \
process, and '--threads 2' sets the number of its threads"
refused check -n "unknown option '-n'; 'vanguard check' runs in one process, \
and '--threads N' sets the number of its threads"

# Values, commands and members of a JSON deck.
vanguard mesh --repair true x
exits 2
says err "repair cannot be 'true'; did you mean 'yes'? (one of no, yes)"
vanguard validate x
exits 2
says err "unknown command 'validate'; did you mean 'check'?"
octahedron >body.obj
echo '{ "grwoth": 1.2 }' >body.json
vanguard check -q body.obj --deck body.json
exits 1
says err "body.json: grwoth: unknown name; did you mean 'settings.growth'?"
