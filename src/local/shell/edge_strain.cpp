// Compiles the functions of shell/edge_strain.h once for the library.
#include <pliant/local/shell/edge_strain-inl.h>
