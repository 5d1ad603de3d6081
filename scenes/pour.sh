#!/bin/bash
# Prints a scene: N ellipsoids are poured into a bowl, whose size depends on N. The scene must be stored in the folder
# of this script, which contains the mesh bowl.obj.
#   bash scenes/pour.sh 1000 > scenes/pour.json && pliant run scenes/pour.json -o out/pour
if [[ $# != 1 || ! $1 =~ ^[1-9][0-9]{0,5}$ ]]; then
  echo "usage: bash pour.sh ELLIPSOIDS    (1 to 999999)" >&2
  exit 2
fi
LC_ALL=C awk -v count="$1" '
function draw() { seed = (seed * 16807) % 2147483647; return seed / 2147483647 }
BEGIN {
  seed = 20
  scale = (count / 30) ^ (1 / 3); spacing = 0.19; radius = 0.3 * scale; layer = 0; n = 0
  printf "{\n  \"description\": \"%d ellipsoids are poured into a bowl, a triangle mesh from a file.\",\n", count
  printf "  \"time\": {\"end\": 3, \"step\": 0.002, \"integrator\": \"rk4\"},\n  \"parts\": [\n"
  across = int(radius / spacing)
  while (n < count) {
    for (i = -across; i <= across; ++i)
      for (j = -across; j <= across; ++j) {
        if ((i * i + j * j) * spacing * spacing > radius * radius || n == count) continue
        size = 0.07 + 0.02 * draw()
        printf "%s    {\"name\": \"pebble %d\", \"shape\": \"ellipsoid\", \"parameters\": {\"a1\": %.3f, \"a2\": %.3f, \"a3\": %.3f}, " \
               "\"position\": [%.4f, %.4f, %.4f], \"orientation\": {\"axis\": [%.4f, %.4f, %.4f], \"angle\": %.4f}, \"resolution\": 4}",
               n ? ",\n" : "", ++n, size, 0.83 * size, 0.65 * size, spacing * i + 0.005 * draw(), spacing * j + 0.005 * draw(),
               0.65 * scale + spacing * layer, draw() - 0.5, draw() - 0.5, draw() - 0.5, 3 * draw()
      }
    ++layer
  }
  printf "\n  ],\n  \"contact\": {\"friction\": 0.4, \"planes\": [{\"name\": \"floor\"}], " \
         "\"obstacles\": [{\"name\": \"bowl\", \"mesh\": \"bowl.obj\", \"scale\": %.6g}]},\n", scale
  printf "  \"camera\": {\"eye\": [%.4g, %.4g, %.4g], \"target\": [0, 0, %.4g]},\n  \"ground\": {\"height\": 0}\n}\n",
         1.35 * scale, -1.7 * scale, 2.3 * scale, 0.42 * scale
}'
