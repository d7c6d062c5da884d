# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# A heat exchanger, of the example: a hot fluid of 1 m/s in a pipe, and a cold one of
# 0.25 m/s around it, in the opposite direction; both laminar. Needs the functions of
# fins.bash.

exchanger() {
  "$vanguard" demo exchanger --cells 60000 --out demo >/dev/null || bad "the demo"
  "$vanguard" mesh -q -p demo/exchanger --cells mixed --write foam --out mesh \
    >/dev/null || bad "vanguard mesh"
  cd mesh/exchanger.openfoam || return
  sound
  run 60 splitMeshRegions -cellZones -overwrite || return
  for region in hot pipe cold; do sound -region $region; done
  flow_through hot hot_in hot_out 1 || return
  flow_through cold cold_in cold_out -0.25 || return
  fluid hot hot_in 350 5
  fluid cold cold_in 300 5
  solid pipe 325
  { heat_at heat_of_hot hot hot_to_pipe
    heat_at heat_of_cold cold cold_to_pipe
    outflow_at outflow_of_hot hot hot_out
    outflow_at outflow_of_cold cold cold_out
  } | all_regions "hot cold" pipe 25 0.05
  run 600 chtMultiRegionFoam || return
  # What the fluids lose and gain between inflow and outflow, with 100 J/(kg K), and what
  # passes
  # the pipe. Some heat is conducted through the inflow, against the flow.
  for region in hot cold; do
    last_values postProcessing/$region/{heat,outflow}_of_$region/*/*.dat \
      postProcessing/$region/outflow_of_${region}_mass/*/*.dat
  done >values
  awk 'function near(x, to, by) { return x > (1 - by) * to && x < (1 + by) * to }
       NR == 1 { out = -$1; lost = $3 * 100 * (350 - $2) }
       NR == 2 { gained = $3 * 100 * ($2 - 300)
         print "  heat out of the hot fluid, into the cold one: " out, $1
         print "  lost and gained by the fluids: " lost, gained
         exit !(near($1, out, .001) && near(lost, out, .03) &&
                near(gained, out, .03) && out > 50) }' values ||
    bad "the heat is not conserved"
}
