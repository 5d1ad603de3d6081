// The library compiles the bodies of this header here.
#include <pliant/math/nearest_name-inl.h>
