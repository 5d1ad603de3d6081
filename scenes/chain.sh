#!/bin/bash
# Prints a scene: a chain of N ellipsoids on ball joints, hung at one end and released at an angle.
#   bash scenes/chain.sh 1000 | pliant run - -o out/chain
if [[ $# != 1 || ! $1 =~ ^[1-9][0-9]{0,5}$ ]]; then
  echo "usage: bash chain.sh LINKS    (1 to 999999)" >&2
  exit 2
fi
LC_ALL=C awk -v links="$1" 'BEGIN {
  length_ = 0.4; lean = 0.5; half_pi = atan2(1, 0)
  x = -length_ * sin(lean); z = -length_ * cos(lean); middle = links / 2
  printf "{\n  \"description\": \"A chain of %d ellipsoids, hung at one end, swings from an angle of half a radian.\",\n", links
  print "  \"time\": {\"end\": 3, \"step\": 0.001, \"integrator\": \"rk4\"},"
  print "  \"parts\": ["
  for (i = 0; i < links; ++i)
    printf "    {\"name\": \"link%d\", \"shape\": \"ellipsoid\", \"parameters\": {\"a1\": 0.07, \"a2\": 0.07, \"a3\": %g}, " \
           "\"position\": [%.15g, 0, %.15g], \"orientation\": {\"axis\": [0, 1, 0], \"angle\": %.15g}, " \
           "\"color\": \"%s\", \"resolution\": 6}%s\n", i, length_ / 2, x * (i + 0.5), z * (i + 0.5), lean,
           i % 2 ? "#d8782f" : "#4a7ab5", i + 1 < links ? "," : ""
  print "  ],\n  \"joints\": ["
  for (i = 0; i < links; ++i) {
    from = i == 0 ? "{\"world\": [0, 0, 0]}" \
                  : sprintf("{\"part\": \"link%d\", \"at\": {\"u\": %.16g, \"v\": 0}}", i - 1, -half_pi)
    printf "    {\"type\": \"ball\", \"name\": \"joint%d\", \"from\": %s, " \
           "\"to\": {\"part\": \"link%d\", \"at\": {\"u\": %.16g, \"v\": 0}}}%s\n", i, from, i, half_pi,
           i + 1 < links ? "," : ""
  }
  printf "  ],\n  \"camera\": {\"eye\": [0, %g, %g], \"target\": [0, 0, %g]}\n}\n", 4 * z * middle - 1, z * middle, z * middle
}'
