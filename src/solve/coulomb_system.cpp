// The library compiles the bodies of this header here.
#include <pliant/solve/coulomb_system-inl.h>
