// The library compiles the bodies of this header here.
#include <pliant/math/time_function-inl.h>
