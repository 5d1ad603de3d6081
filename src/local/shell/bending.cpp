// Compiles the functions of shell/bending.h once for the library.
#include <pliant/local/shell/bending-inl.h>
