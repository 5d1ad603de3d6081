// Compiles the functions of mover_system.h once for the library.
#include <pliant/solve/mover_system-inl.h>
