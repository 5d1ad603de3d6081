// Compiles the functions of shell/loaded_membrane.h once for the library.
#include <pliant/local/shell/loaded_membrane-inl.h>
