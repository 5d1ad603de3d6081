// Compiles the functions of shell/membrane.h once for the library.
#include <pliant/local/shell/membrane-inl.h>
