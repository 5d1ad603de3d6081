// The library compiles the bodies of this header here.
#include <pliant/solve/mover_system-inl.h>
