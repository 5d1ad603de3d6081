// Compiles the functions of shell/surface_strain.h once for the library.
#include <pliant/local/shell/surface_strain-inl.h>
