// Compiles the functions of solid/solid_mass.h once for the library.
#include <pliant/local/solid/solid_mass-inl.h>
