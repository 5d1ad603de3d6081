// Compiles the functions of shell/pressure.h once for the library.
#include <pliant/local/shell/pressure-inl.h>
