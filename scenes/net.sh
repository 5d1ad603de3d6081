#!/bin/bash
# Prints a scene: a net of N x M knots, connected by ellipsoids on ball joints and hung by its corners, falls from a
# dome.
#   bash scenes/net.sh 12 8 | pliant run - -o out/net
if [[ $# != 2 || ! $1 =~ ^[1-9][0-9]{0,2}$ || ! $2 =~ ^[1-9][0-9]{0,2}$ || $1 -lt 3 || $2 -lt 3 ]]; then
  echo "usage: bash net.sh KNOTS KNOTS    (along and across, 3 to 999 each)" >&2
  exit 2
fi
LC_ALL=C awk -v n="$1" -v m="$2" '
# Computes the positions of the knots of an arc of equal chords, m: along[k], 0 in the middle of the arc, and up[k], 0 at its
# ends. From an end to the middle, the direction of the arc changes by `turn` (rad).
function arc(knots, along, up,    k, a) {
  along[0] = up[0] = 0
  for (k = 1; k < knots; ++k) {
    a = turn * (1 - (2 * k - 1) / (knots - 1))
    along[k] = along[k - 1] + spacing * cos(a)
    up[k] = up[k - 1] + spacing * sin(a)
  }
  a = along[knots - 1] / 2
  for (k = 0; k < knots; ++k) along[k] -= a
}
function add(text) { rows[++count] = text }
function show(title,    k) {
  printf "  \"%s\": [\n", title
  for (k = 1; k <= count; ++k) printf "    %s%s\n", rows[k], k < count ? "," : ""
  print "  ],"
  count = 0
}
# Adds a link from knot (i, j) to knot (i + di, j + dj); its z axis points from the first to the second knot.
function link(i, j, di, dj,    dx, dy, dz, angle) {
  dx = (x[i + di] - x[i]) / spacing; dy = (y[j + dj] - y[j]) / spacing
  dz = (zx[i + di] - zx[i] + zy[j + dj] - zy[j]) / spacing
  angle = atan2(sqrt(dx * dx + dy * dy), dz)
  add(sprintf("{\"name\": \"%s\", \"shape\": \"ellipsoid\", \"parameters\": {\"a1\": 0.03, \"a2\": 0.03, \"a3\": %.15g}, " \
              "\"position\": [%.15g, %.15g, %.15g], \"orientation\": {\"axis\": [%.15g, %.15g, 0], \"angle\": %.15g}, " \
              "\"drag\": 0.4, \"color\": \"%s\", \"resolution\": 4}", link_name(i, j, di), spacing / 2 - r,
              (x[i] + x[i + di]) / 2, (y[j] + y[j + dj]) / 2, (zx[i] + zx[i + di] + zy[j] + zy[j + dj]) / 2,
              -dy, dx, angle, di ? "#4a7ab5" : "#d9c08a"))
}
function link_name(i, j, di) { return sprintf("%s%d-%d", di ? "along" : "across", i, j) }
# Adds the joint between an end of a link and a knot, at the surface of the knot in the direction d.
function tie(i, j, name, d_x, d_y, d_z, u) {
  add(sprintf("{\"type\": \"ball\", \"from\": {\"part\": \"knot%d-%d\", \"at\": {\"direction\": [%.15g, %.15g, %.15g]}}, " \
              "\"to\": {\"part\": \"%s\", \"at\": {\"u\": %.16g, \"v\": 0}}}", i, j, d_x, d_y, d_z, name, u))
}
function ties(i, j, di, dj,    dx, dy, dz) {
  dx = x[i + di] - x[i]; dy = y[j + dj] - y[j]; dz = zx[i + di] - zx[i] + zy[j + dj] - zy[j]
  tie(i, j, link_name(i, j, di), dx, dy, dz, -half_pi)
  tie(i + di, j + dj, link_name(i, j, di), -dx, -dy, -dz, half_pi)
}
BEGIN {
  spacing = 0.3; r = 0.035; turn = 1.1; half_pi = atan2(1, 0)
  arc(n, x, zx); arc(m, y, zy)
  printf "{\n  \"$schema\": \"pliant-scene.schema.json\",\n  \"description\": \"A net of %d x %d knots, hung by its corners, falls from a dome into a bag.\",\n", n, m
  print "  \"time\": {\"end\": 3, \"step\": 0.0005, \"integrator\": \"rk4\"},"
  for (i = 0; i < n; ++i) for (j = 0; j < m; ++j)
    add(sprintf("{\"name\": \"knot%d-%d\", \"shape\": \"sphere\", \"parameters\": {\"r\": %g}, " \
                "\"position\": [%.15g, %.15g, %.15g], \"drag\": 0.4, \"color\": \"#c0504d\", \"resolution\": 4}",
                i, j, r, x[i], y[j], zx[i] + zy[j]))
  for (i = 0; i < n; ++i) for (j = 0; j < m; ++j) {
    if (i + 1 < n) link(i, j, 1, 0)
    if (j + 1 < m) link(i, j, 0, 1)
  }
  show("parts")
  for (i = 0; i < n; i += n - 1) for (j = 0; j < m; j += m - 1)
    add(sprintf("{\"type\": \"ball\", \"from\": {\"world\": [%.15g, %.15g, %.15g]}, " \
                "\"to\": {\"part\": \"knot%d-%d\", \"at\": {\"u\": 0, \"v\": 0, \"w\": 0}}}",
                x[i], y[j], zx[i] + zy[j], i, j))
  for (i = 0; i < n; ++i) for (j = 0; j < m; ++j) {
    if (i + 1 < n) ties(i, j, 1, 0)
    if (j + 1 < m) ties(i, j, 0, 1)
  }
  show("joints")
  size = (n > m ? n : m) * spacing
  printf "  \"camera\": {\"eye\": [%g, %g, %g], \"target\": [0, 0, 0]}\n}\n", 0.9 * size, -1.9 * size, 0.8 * size
}'
