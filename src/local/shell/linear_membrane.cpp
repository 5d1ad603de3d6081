// Compiles the functions of shell/linear_membrane.h once for the library.
#include <pliant/local/shell/linear_membrane-inl.h>
