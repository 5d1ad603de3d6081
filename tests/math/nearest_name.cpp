// Suggestions of the name that a user probably meant.
#include <pliant/math/nearest_name.h>

#include "catch.h"

namespace nearest_name_test {

using pliant::did_you_mean;
using pliant::edit_distance;
using pliant::nearest_name;

TEST_CASE("edit distance counts insertions, deletions, replacements and swaps") {
  CHECK(edit_distance("", "") == 0);
  CHECK(edit_distance("mass", "mass") == 0);
  CHECK(edit_distance("Mass", "mASS") == 0);
  CHECK(edit_distance("masss", "mass") == 1);
  CHECK(edit_distance("mas", "mass") == 1);
  CHECK(edit_distance("nass", "mass") == 1);
  CHECK(edit_distance("msas", "mass") == 1);
  CHECK(edit_distance("", "mass") == 4);
  CHECK(edit_distance("mass", "") == 4);
  CHECK(edit_distance("eliptical", "elliptical") == 1);
  CHECK(edit_distance("kitten", "sitting") == 3);
}

TEST_CASE("the nearest name is within two edits (one for short words), and the first of equally near names") {
  CHECK(nearest_name("masss", {"density", "mass", "max"}) == "mass");
  CHECK(nearest_name("Sphere", {"sphere"}) == "sphere");
  CHECK(nearest_name("superelipsiod", {"superellipsoid", "ellipsoid"}) == "superellipsoid");
  CHECK(nearest_name("velocity", {"mass", "density"}).empty());
  CHECK(nearest_name("tz", {"tx", "ty"}) == "tx");
  CHECK(nearest_name("ab", {"xy"}).empty());
  CHECK(nearest_name("", {"x"}) == "x");
  CHECK(nearest_name("x", {}).empty());
  CHECK(did_you_mean("masss", {"mass"}) == "; did you mean \"mass\"?");
  CHECK(did_you_mean("velocity", {"mass"}).empty());
}

}  // namespace nearest_name_test
