# SPDX-License-Identifier: LGPL-3.0-or-later
# Titles and names in other alphabets are kept, in tables that stay aligned.
# Bytes that are not UTF-8 become '?', and no name is cut inside a character.
vanguard demo box --cells 2000 --out p
cp p/box.lb8.ugrid wing.lb8.ugrid
long=$(printf 'x'; printf 'ü%.0s' $(seq 60))
latin=$(printf 'Fl\374gel')
{
  echo 6
  echo "1 4000 Flügel außen"
  echo "2 4000 机翼"
  echo "3 5000 $latin"
  echo "4 5000 $long"
  echo "5 5000 rechts"
  echo "6 5000 links"
} >wing.mapbc
printf 'Flügelprüfung «α = 2°»\n' >wing.deck
vanguard check wing.lb8.ugrid
exits 0
says out "Flügel außen"
says out "Fl?gel"
vanguard mesh -q -p wing --first 0.01 --layer-count 2 --timeline --out o
exits 0
says out "Flügelprüfung «α = 2°»"
says out "    1 Flügel außen           "
says out "    2 机翼                   "
says o/wing.report.json '"title": "Flügelprüfung «α = 2°»"'
says o/wing.report.json '"name": "Flügel außen"'
says o/wing.report.json '"name": "Fl?gel"'
says o/wing.report.json "\"name\": \"${long:0:79}\""
says o/wing.timeline.json '"title": "Flügelprüfung «α = 2°»"'
vanguard plan -q --replay o/wing.timeline.json --ranks 1,2 --plot f.svg
exits 0
says f.svg "Flügelprüfung «α = 2°»"
